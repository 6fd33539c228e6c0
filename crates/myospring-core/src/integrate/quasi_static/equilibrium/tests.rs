use super::*;
use crate::mechanics::active::ActiveLaw;
use crate::mechanics::material::{assemble, default_material};
use crate::mechanics::support::SupportKind;
use crate::mesh::lattice;

#[test]
fn newtons_method_converges_quadratically_from_rest_to_full_tension() {
    let mesh = lattice::rectangle(20, 4, 1.0).unwrap();
    let fibres = vec![[0.8, 0.6]; mesh.simplices.len()];
    for support in [SupportKind::MassCentre, SupportKind::ClampedEnd] {
        let (body, system) = assemble(
            &mesh,
            &default_material(),
            ActiveLaw::Fibre,
            &fibres,
            support,
            [1.0, 0.0],
            20.0,
        );
        let rest = Solver::continued(&system, &body, None, &Interruption::default())
            .find(
                &Knot {
                    tension: 50.0,
                    positions: body.positions.clone(),
                    slope: zeros(body.len()),
                },
                1e-9,
            )
            .unwrap();
        let sizes = rest.corrections;
        // Once near, each correction is of the order of the square of the one before, in um.
        let pairs: Vec<_> =
            sizes.windows(2).filter(|pair| pair[0] < 0.02 && pair[1] > 1e-12).collect();
        assert!(!pairs.is_empty(), "{sizes:?}");
        for pair in pairs {
            assert!(pair[1] < 10.0 * pair[0] * pair[0], "{support:?}: {sizes:?} um");
        }
    }
}
