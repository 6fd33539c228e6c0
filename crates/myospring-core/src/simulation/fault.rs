//! Faults of a moving mesh, and where they are.

use super::StopReason;
use crate::mechanics::{Vectors, sum};
use crate::mesh::simplex::{measure_at, measure_gradients};
use crate::mesh::{Mesh, Place};

/// Projected area of a mesh in given positions, um^2.
pub fn projected_area(mesh: &Mesh, positions: &[Vec<f64>; 2]) -> f64 {
    sum(mesh.simplices.len(), |at| {
        let simplex = &mesh.simplices[at];
        simplex.weight * measure_at(positions, simplex.nodes)
    })
}

/// Finds faults of a moving body. A full search is skipped while no node has moved far from the last shape that was searched.
pub(super) struct Watch<const D: usize> {
    /// The last positions that were searched, without a fault, and the distance from them, um along each axis, within which no fault is
    /// possible.
    intact: Option<(Vectors<D>, f64)>,
}

impl<const D: usize> Watch<D> {
    pub(super) fn new() -> Self {
        Self { intact: None }
    }

    /// As [`fault`].
    pub(super) fn fault<const N: usize>(
        &mut self,
        mesh: &Mesh<D, N>,
        positions: &Vectors<D>,
        time: f64,
        tension: f64,
    ) -> Option<StopReason> {
        if self.is_intact(positions) {
            return None;
        }
        let found = fault(mesh, positions, time, tension);
        self.intact = found.is_none().then(|| (positions.clone(), reach(mesh, positions)));
        found
    }

    /// Whether all nodes are so near to those positions that no fault is possible; false if a coordinate is not finite.
    fn is_intact(&self, positions: &Vectors<D>) -> bool {
        let Some((intact, reach)) = &self.intact else { return false };
        // All of an axis, so that several nodes are compared at once.
        let near = |(now, then): (&Vec<f64>, &Vec<f64>)| {
            let pairs = now.iter().zip(then);
            pairs.fold(true, |near, (now, then)| near & ((now - then).abs() < *reach))
        };
        positions.iter().zip(intact).all(near)
    }
}

/// How far nodes can move along each axis before a simplex is inverted or a spring loses its length, um. A simplex in which each corner moves
/// by less than the radius of its inscribed ball keeps a width above 0: at first it is at least twice that radius, and it changes by
/// at most twice the distance.
fn reach<const D: usize, const N: usize>(mesh: &Mesh<D, N>, positions: &Vectors<D>) -> f64 {
    /// Safety factor for rounding.
    const PART: f64 = 0.9;
    let of_simplices = mesh.simplices.iter().map(|simplex| {
        let corners = simplex.nodes.map(|node| positions.each_ref().map(|of| of[node as usize]));
        // The radius is the measure over its change with the distances of the sides.
        let change = |gradient: &[f64; D]| gradient.iter().map(|x| x * x).sum::<f64>().sqrt();
        let changes: f64 = measure_gradients(&corners).iter().map(change).sum();
        measure_at(positions, simplex.nodes) / changes
    });
    let of_springs = mesh.springs.iter().map(|spring| {
        let [a, b] = spring.nodes.map(|node| node as usize);
        0.5 * positions.iter().map(|of| (of[a] - of[b]).powi(2)).sum::<f64>().sqrt()
    });
    let least = of_simplices.chain(of_springs).fold(f64::INFINITY, f64::min);
    PART * least / (D as f64).sqrt()
}

/// The first fault of a body, if there is any.
pub(super) fn fault<const D: usize, const N: usize>(
    mesh: &Mesh<D, N>,
    positions: &Vectors<D>,
    time: f64,
    tension: f64,
) -> Option<StopReason> {
    let lost = |&node: &usize| positions.iter().any(|of| !of[node].is_finite());
    if let Some(node) = (0..positions[0].len()).find(lost) {
        return Some(StopReason::NotFinite { time, node, place: Place::of(&mesh.points, node) });
    }
    let zero = |nodes: [u32; 2]| {
        let [a, b] = nodes.map(|node| node as usize);
        positions.iter().all(|of| of[a] == of[b])
    };
    if let Some(spring) = mesh.springs.iter().position(|spring| zero(spring.nodes)) {
        let place = Place::of(positions, mesh.springs[spring].nodes[0] as usize);
        return Some(StopReason::ZeroLength { time, tension, spring, place });
    }
    let inverted = |nodes: [u32; N]| measure_at(positions, nodes) <= 0.0;
    let triangle = mesh.simplices.iter().position(|simplex| inverted(simplex.nodes))?;
    let place = Place::of(positions, mesh.simplices[triangle].nodes[0] as usize);
    Some(StopReason::Inverted { time, tension, triangle, place })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::profile::Profile;
    use crate::mesh::thick::{self, Form};
    use crate::mesh::{built_in, lattice};

    /// Uniform in [-1, 1].
    fn random(state: &mut u64) -> f64 {
        *state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// Nodes wander until there is a fault: it is found at once, and most shapes before are passed without a look at each triangle.
    fn wander<const D: usize, const N: usize>(mesh: &Mesh<D, N>, pace: f64, state: &mut u64) {
        let (mut watch, mut positions, mut passed) = (Watch::new(), mesh.points.clone(), 0);
        for step in 0..100_000 {
            let time = f64::from(step);
            passed += usize::from(watch.is_intact(&positions));
            let found = watch.fault(mesh, &positions, time, 1.0);
            assert_eq!(found, fault(mesh, &positions, time, 1.0));
            if found.is_some() {
                assert!(2 * passed > step as usize, "{passed} of {step}");
                return;
            }
            positions.iter_mut().flatten().for_each(|x| *x += pace * random(state));
        }
        panic!("no fault");
    }

    #[test]
    fn faults_are_found_when_they_come() {
        let mut state = 7;
        let flat = lattice::rectangle(6, 5, 2.0).unwrap();
        let form = Form { profile: Profile::Slab, thickness: 12.0 };
        let (_, thick, _) =
            thick::from_outline(&built_in::adult_ventricular(), form, Some(6.0)).unwrap();
        for pace in [0.003, 0.01, 0.03] {
            for _ in 0..10 {
                wander(&flat, pace, &mut state);
            }
            wander(&thick.mesh, 3.0 * pace, &mut state);
        }
    }

    #[test]
    fn what_is_no_number_is_found_beside_an_intact_shape() {
        let mesh = lattice::rectangle(3, 2, 2.0).unwrap();
        let mut watch = Watch::new();
        assert_eq!(watch.fault(&mesh, &mesh.points, 0.0, 1.0), None);
        let mut positions = mesh.points.clone();
        positions[1][4] = f64::NAN;
        let found = watch.fault(&mesh, &positions, 1.0, 1.0);
        assert!(matches!(found, Some(StopReason::NotFinite { node: 4, .. })), "{found:?}");
    }
}
