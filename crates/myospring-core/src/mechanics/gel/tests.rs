use super::*;
use crate::mechanics::Body;
use crate::mechanics::vectors::add_scaled;
use crate::mesh::lattice;
use crate::mesh::outline::Outline;
use std::f64::consts::TAU;

fn gels() -> [Gel; 4] {
    let half = Gel::half_space(8.0);
    [
        half,
        Gel { poisson: 0.0, ..half },
        Gel { thickness: Some(10.0), poisson: 0.4, ..half },
        Gel { adhesion_stiffness: Some(2.0), adhesion: Adhesion::Ends, ..half },
    ]
}

fn ellipse(width: f64, height: f64, spacing: f64) -> Mesh {
    let corner = |k: usize| {
        let (sin, cos) = (TAU * k as f64 / 180.0).sin_cos();
        [0.5 * width * cos + 7.0, 0.5 * height * sin - 3.0]
    };
    let outline = Outline::new((0..180).map(corner).collect(), Vec::new()).unwrap();
    lattice::from_outline(&outline, Some(spacing)).unwrap().0
}

fn bed(gel: Gel, mesh: &Mesh) -> GelBed {
    GelBed::new(gel, mesh, [1.0, 0.0]).unwrap()
}

/// Irregular numbers between -1 and 1, a vector for each node that adheres.
fn irregular(count: usize) -> Vectors {
    [0.618_033_988_749_9, 0.754_877_666_246_7]
        .map(|part| (1..=count).map(|k| 2.0 * (part * (k * k) as f64).fract() - 1.0).collect())
}

#[test]
fn the_square_moves_as_its_closed_form_and_far_away_as_under_a_point_force() {
    for poisson in [0.0, 0.3, 0.49] {
        let gel = Gel { poisson, ..Gel::half_space(5.0) };
        let green = Green::new(gel, 2.0);
        // At the centre of a square of side s: 3.52549 s q (1 + nu)(1 - nu/2) / (pi E), here q s^2 = 1.
        let centre = 8.0 * (1.0 + 2f64.sqrt()).ln() / 2.0;
        assert!((centre - 3.52549).abs() < 1e-5);
        let wanted = centre * (1.0 + poisson) * (1.0 - 0.5 * poisson) / (PI * 5.0 * 2.0);
        let [xx, xy, yy] = green.at(0.0, 0.0);
        assert!((xx / wanted - 1.0).abs() < 1e-12 && (yy / wanted - 1.0).abs() < 1e-12);
        assert!(xy.abs() < 1e-15);
        let (x, y) = (120.0_f64, -80.0);
        let r = x.hypot(y);
        let scale = (1.0 + poisson) / (PI * 5.0 * r);
        let point = [
            scale * (1.0 - poisson + poisson * x * x / (r * r)),
            scale * poisson * x * y / (r * r),
            scale * (1.0 - poisson + poisson * y * y / (r * r)),
        ];
        for (found, wanted) in green.at(x, y).into_iter().zip(point) {
            // The next term is of the order of the square of the side over the distance.
            assert!((found - wanted).abs() < 1e-4 * point[0], "{found} {wanted}");
        }
    }
}

#[test]
fn a_disc_of_even_traction_moves_its_centre_as_its_closed_form() {
    // q a (1 + nu)(2 - nu) / E; on a lattice, squares of area near that of the disc.
    let errors = [1.0, 0.5, 0.25].map(|spacing| {
        let mesh = ellipse(20.0, 20.0, spacing);
        let bed = bed(Gel::half_space(5.0), &mesh);
        let forces = [mesh.areas.clone(), vec![0.0; mesh.len()]];
        let [moved, across] = bed.displaced(&forces);
        let middle = |node: &usize| (mesh.point(*node)[0] - 7.0).hypot(mesh.point(*node)[1] + 3.0);
        let node = (0..mesh.len()).min_by(|a, b| middle(a).total_cmp(&middle(b))).unwrap();
        let radius = (mesh.area() / PI).sqrt();
        let wanted = radius * 1.49 * 1.51 / 5.0;
        assert!(across[node].abs() < 1e-3 * wanted);
        (moved[node] / wanted - 1.0).abs()
    });
    assert!(errors[2] < 2e-3 && errors[2] < errors[0], "{errors:?}");
}

#[test]
fn the_convolution_is_the_sum_over_all_pairs_and_reciprocal() {
    let mesh = ellipse(30.0, 9.0, 1.5);
    for gel in gels() {
        let bed = bed(gel, &mesh);
        let green = Green::new(gel, 1.5);
        let forces = irregular(bed.nodes.len());
        let found = bed.displaced(&forces);
        for (place, &node) in bed.nodes.iter().enumerate() {
            let mut sum =
                [bed.slack[place] * forces[0][place], bed.slack[place] * forces[1][place]];
            for (other, &from) in bed.nodes.iter().enumerate() {
                let way =
                    [0, 1].map(|axis: usize| mesh.points[axis][node] - mesh.points[axis][from]);
                let [xx, xy, yy] = green.at(way[0], way[1]);
                sum[0] += xx * forces[0][other] + xy * forces[1][other];
                sum[1] += xy * forces[0][other] + yy * forces[1][other];
            }
            for axis in 0..2 {
                assert!((found[axis][place] - sum[axis]).abs() < 1e-12, "{gel:?}");
            }
        }
        // Betti: the work of some forces on the way of others is that of the others on theirs.
        let others = found.clone();
        let [a, b] = [product(&others, &found), product(&forces, &bed.displaced(&others))];
        assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
    }
}

#[test]
fn a_layer_is_a_bed_where_it_is_thin_and_a_half_space_where_it_is_thick() {
    let mesh = ellipse(60.0, 60.0, 1.0);
    let even = [mesh.areas.clone(), vec![0.0; mesh.len()]];
    let middle = |node: &usize| (mesh.point(*node)[0] - 7.0).hypot(mesh.point(*node)[1] + 3.0);
    let node = (0..mesh.len()).min_by(|a, b| middle(a).total_cmp(&middle(b))).unwrap();
    let half = Gel::half_space(6.0);
    for poisson in [0.0, 0.3, 0.49] {
        // u = q h / G far from the rim.
        let thin = Gel { thickness: Some(2.0), poisson, ..half };
        let [moved, _] = bed(thin, &mesh).displaced(&even);
        let wanted = 2.0 / thin.shear_modulus();
        assert!((moved[node] / wanted - 1.0).abs() < 2e-3, "{poisson}: {} {wanted}", moved[node]);
        let of = |thickness| {
            let gel = Gel { poisson, thickness, ..half };
            bed(gel, &mesh).displaced(&even)[0][node]
        };
        let [thick, endless] = [of(Some(3000.0)), of(None)];
        // What is missing below goes as the diameter over the thickness.
        assert!((thick / endless - 1.0).abs() < 1.5e-2 && thick < endless, "{thick} {endless}");
        let thicker = of(Some(6000.0));
        assert!(((endless - thick) / (endless - thicker) - 2.0).abs() < 0.05);
    }
}

#[test]
fn waves_on_a_layer_move_as_their_closed_forms() {
    // Traction along x of the wave number k, along the wave and across it, on a square of many waves.
    let mesh = lattice::rectangle(120, 120, 1.0).unwrap();
    for (poisson, thickness) in [(0.49, 4.0), (0.2, 4.0), (0.45, 12.0)] {
        let gel = Gel { poisson, thickness: Some(thickness), ..Gel::half_space(6.0) };
        let bed = bed(gel, &mesh);
        let number = TAU / 20.0;
        let [along, across, _] = wave::compliance(poisson, number * thickness);
        for (along, wanted) in [along, across].into_iter().enumerate() {
            // Crests at the middle of the square; nodes on its rim count whole squares, too.
            let wave: Vec<f64> =
                mesh.points[along].iter().map(|x| (number * (x - 60.0)).cos()).collect();
            let [moved, _] = bed.displaced(&[wave, vec![0.0; mesh.len()]]);
            let middle = 60 * 121 + 60;
            let found = moved[middle] * gel.shear_modulus() * number;
            // Forces are even over a square: less by (k a)^2 / 24 of the wave.
            assert!(
                (found / wanted - 1.0).abs() < 0.01,
                "{poisson} {thickness} {along}: {found} {wanted}"
            );
        }
    }
}

#[test]
fn forces_move_the_gel_as_far_as_they_were_asked_to_and_energy_is_their_potential() {
    let mesh = ellipse(40.0, 12.0, 1.0);
    for gel in gels() {
        let bed = bed(gel, &mesh);
        let mut body = Body::at_rest(&mesh, 1.0, 1.0);
        body.positions[0].iter_mut().for_each(|x| *x = 7.0 + 0.9 * (*x - 7.0));
        let moved = bed.displacements(&body.positions);
        let pulls = bed.forces(&moved);
        let back = bed.displaced(&pulls);
        let mut miss = back.clone();
        add_scaled(&mut miss, -1.0, &moved);
        assert!(product(&miss, &miss) < 1e-18 * product(&moved, &moved));
        // Minus the force is the slope of the energy.
        let mut forces = zeros(mesh.len());
        bed.add_forces(&body.configuration(0.0), &mut forces);
        let way = irregular(mesh.len());
        let energy = |by: f64| {
            let mut there = body.clone();
            add_scaled(&mut there.positions, by, &way);
            bed.energy(&there.configuration(0.0)).unwrap()
        };
        // The energy is quadratic, so that this is exact.
        let slope = 0.5 * (energy(1.0) - energy(-1.0));
        let size = (product(&forces, &forces) * product(&way, &way)).sqrt();
        let miss = slope + product(&forces, &way);
        assert!(miss.abs() < 1e-8 * size, "{gel:?}: {miss} of {size}");
    }
}

#[test]
fn the_springs_in_its_place_are_softer_than_the_gel() {
    // Largest eigenvalue of B C by the power method, from an irregular start.
    for (mesh, gel) in [
        (ellipse(110.0, 22.0, 1.2), Gel::half_space(10.0)),
        (ellipse(30.0, 30.0, 1.0), Gel { thickness: Some(3.0), ..Gel::half_space(10.0) }),
        (
            ellipse(60.0, 14.0, 1.0),
            Gel { thickness: Some(40.0), poisson: 0.3, ..Gel::half_space(1.0) },
        ),
        (ellipse(60.0, 14.0, 1.0), Gel { adhesion_stiffness: Some(0.5), ..Gel::half_space(30.0) }),
        (ellipse(60.0, 14.0, 1.0), Gel { adhesion: Adhesion::Rim, ..Gel::half_space(30.0) }),
    ] {
        let bed = bed(gel, &mesh);
        let mut vector = irregular(bed.nodes.len());
        let mut largest = 0.0;
        for _ in 0..200 {
            let next = bed.likeness(&bed.displaced(&vector));
            largest = (product(&next, &next) / product(&vector, &vector)).sqrt();
            let size = product(&next, &next).sqrt();
            vector = next.map(|axis| axis.into_iter().map(|x| x / size).collect());
        }
        assert!(largest < 1.0, "{largest}: {gel:?}");
    }
}

#[test]
fn a_cell_that_adheres_fully_where_its_ends_do_is_one_that_adheres_at_its_ends() {
    let mesh = ellipse(60.0, 20.0, 2.0);
    let whole = |adhesion| Gel { adhesion, adhesion_stiffness: Some(2.0), ..Gel::half_space(8.0) };
    for adhesion in [Adhesion::Everywhere, Adhesion::Ends, Adhesion::Rim] {
        let by_word = bed(whole(adhesion), &mesh);
        let mut list = vec![0.0; mesh.len()];
        for &node in by_word.nodes() {
            list[node] = 1.0;
        }
        let gel = whole(Adhesion::Everywhere);
        let by_list = GelBed::adhering(gel, &mesh, [1.0, 0.0], Some(&list)).unwrap();
        assert_eq!(by_list.nodes(), by_word.nodes());
        let moved = irregular(by_word.nodes().len());
        assert_eq!(by_list.forces(&moved), by_word.forces(&moved), "{adhesion:?}");
        assert_eq!(by_list.likeness(&moved), by_word.likeness(&moved), "{adhesion:?}");
    }
}

#[test]
fn a_weaker_adhesion_everywhere_is_a_softer_one_and_between_nodes_it_is_solved_as_well() {
    let mesh = ellipse(60.0, 20.0, 2.0);
    let gel = |stiffness| Gel { adhesion_stiffness: Some(stiffness), ..Gel::half_space(8.0) };
    let adhering =
        |gel, list: &[f64]| GelBed::adhering(gel, &mesh, [1.0, 0.0], Some(list)).unwrap();
    let moved = irregular(mesh.len());
    let quarter = adhering(gel(2.0), &vec![0.25; mesh.len()]).forces(&moved);
    let softer = bed(gel(0.5), &mesh).forces(&moved);
    let size = product(&softer, &softer).sqrt();
    for (a, b) in quarter.iter().flatten().zip(softer.iter().flatten()) {
        // Both are solved to 1e-10 of the displacements, whose forces are up to 100 times as large in proportion.
        assert!((a - b).abs() < 1e-8 * size, "{a} {b}");
    }
    // From a 255th, the faintest grey value of a byte, to 1.
    let faint = |node: usize| (1.0 + (node * node * 7 % 255) as f64) / 255.0;
    let list: Vec<f64> = (0..mesh.len()).map(faint).collect();
    for gel in [gel(2.0), gel(0.05), gel(500.0)] {
        let bed = adhering(gel, &list);
        let forces = bed.forces(&moved);
        let mut left = bed.displaced(&forces);
        add_scaled(&mut left, -1.0, &moved);
        let left = (product(&left, &left) / product(&moved, &moved)).sqrt();
        assert!(left < 1e-9, "{gel:?}: {left}");
    }
}

#[test]
fn pressure_on_a_layer_sinks_as_its_closed_forms_say() {
    use super::convolution::Convolution;
    use super::green::Green;
    // At the centre of a square of side s under an even pressure q: 3.52549 s q (1 - nu^2) / (pi E).
    for poisson in [0.0, 0.3, 0.49] {
        let gel = Gel { poisson, ..Gel::half_space(8.0) };
        let sunk = Green::new(gel, 3.0).normal_at(0.0, 0.0) * 9.0;
        let exact = 3.52549 * 3.0 * (1.0 - poisson * poisson) / (PI * 8.0);
        assert!((sunk / exact - 1.0).abs() < 1e-5, "nu = {poisson}: {sunk}, {exact}");
    }
    // Waves of pressure, whose middle is not reached by the rim.
    let shape = [121, 121];
    let places: Vec<[u32; 2]> = (0..121 * 121).map(|at| [at % 121, at / 121]).collect();
    for (poisson, thickness) in [(0.49, 4.0), (0.2, 4.0), (0.45, 12.0)] {
        let gel = Gel { poisson, thickness: Some(thickness), ..Gel::half_space(6.0) };
        let normal = Convolution::normal(&Green::new(gel, 1.0), 1.0, shape);
        let number = TAU / 20.0;
        let [.., wanted] = wave::compliance(poisson, number * thickness);
        let wave = places.iter().map(|[x, _]| (number * (f64::from(*x) - 60.0)).cos()).collect();
        let [moved, _] = normal.displacements(&places, &[wave, vec![0.0; 121 * 121]]);
        let exact = wanted / (gel.shear_modulus() * number);
        let found = moved[60 * 121 + 60];
        // As of tractions in the plane: each force is spread over a square.
        assert!((found / exact - 1.0).abs() < 0.03, "nu = {poisson}: {found}, {exact}");
    }
}

#[test]
fn a_layer_that_cannot_bulge_hardly_sinks() {
    // Long waves: h^2 k^2 h/(3 G) of an incompressible layer, h/M of another, M = 2 G (1 - nu)/(1 - 2 nu).
    let s = 1e-3;
    let [.., incompressible] = wave::compliance(0.5, s);
    assert!((incompressible / (s * s * s / 3.0) - 1.0).abs() < 1e-3, "{incompressible}");
    let nu = 0.3;
    let [.., other] = wave::compliance(nu, s);
    assert!((other / (s * (1.0 - 2.0 * nu) / (2.0 * (1.0 - nu))) - 1.0).abs() < 1e-3, "{other}");
}
