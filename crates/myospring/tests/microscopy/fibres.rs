//! Fibre directions from pictures: stripes at known angles, places without any, and what they drive.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common::Sample;
use crate::common::{self, pixels_of};

use std::f64::consts::TAU;

use myospring::cell::CellModel;
use myospring::cell::pacing::Protocol;
use myospring::cell::toy::ToyModel;
use myospring::integrate::quasi_static::Tolerance;
use myospring::mesh::mask::Mask;
use myospring::mesh::{Mesh, lattice, quality};
use myospring::microscopy::fibres::{FibreError, FibreField, FibreSettings, Stain, fibres};
use myospring::microscopy::picture::Selection;
use myospring::microscopy::plane::Plane;
use myospring::microscopy::read::read_picture;
use myospring::simulation::Simulation;

/// Distance of z-discs, um.
const SARCOMERE: f64 = 1.8;

/// A square picture of an elliptic cell, drawn at any pixel size.
#[derive(Clone, Copy)]
pub(crate) struct Scene {
    pub(crate) side_um: f64,
    pub(crate) pixel: f64,
    /// Half axes of the cell, um, the first along `axis_deg`.
    pub(crate) half: [f64; 2],
    pub(crate) axis_deg: f64,
}

impl Scene {
    const fn new(pixel: f64) -> Self {
        Self { side_um: 44.0, pixel, half: [20.0, 12.0], axis_deg: 30.0 }
    }

    fn pixels(&self) -> usize {
        (self.side_um / self.pixel) as usize
    }

    /// Place of a pixel's centre from the middle of the picture, um, y upward.
    fn place(&self, at: usize) -> [f64; 2] {
        let n = self.pixels();
        let from_middle = |i: usize| (i as f64 + 0.5 - 0.5 * n as f64) * self.pixel;
        [from_middle(at % n), -from_middle(at / n)]
    }

    /// Below 1 within the cell.
    fn radius(&self, [x, y]: [f64; 2]) -> f64 {
        let (sin, cos) = self.axis_deg.to_radians().sin_cos();
        ((cos * x + sin * y) / self.half[0]).hypot((cos * y - sin * x) / self.half[1])
    }

    fn inside(&self) -> Vec<bool> {
        let n = self.pixels();
        (0..n * n).map(|at| self.radius(self.place(at)) < 1.0).collect()
    }

    pub(crate) fn plane(&self, grey: impl FnMut([f64; 2]) -> f64) -> Plane {
        let n = self.pixels();
        let values = (0..n * n).map(|at| self.place(at)).map(grey).map(|value| value as f32);
        Plane::new(n, n, values.collect()).unwrap()
    }

    fn axis(&self) -> [f64; 2] {
        let (sin, cos) = self.axis_deg.to_radians().sin_cos();
        [cos, sin]
    }

    pub(crate) fn field(&self, plane: &Plane, stain: Stain) -> FibreField {
        let settings = FibreSettings::of(stain);
        fibres(plane, &self.inside(), pixels_of(self.pixel), self.axis(), &settings).unwrap()
    }

    /// The point of the picture `x`, `y` um from its middle, as fields and meshes count.
    pub(crate) fn point(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let middle = 0.5 * self.pixel * self.pixels() as f64;
        [middle + x, middle + y]
    }

    fn mesh(&self, spacing: f64) -> Mesh {
        let n = self.pixels();
        let mask = Mask::new(n, n, pixels_of(self.pixel), self.inside()).unwrap();
        lattice::from_mask(&mask, Some(spacing)).unwrap().0
    }
}

/// Narrow bright stripes across a direction, 0 to 1.
fn stripes([x, y]: [f64; 2], fibre_deg: f64) -> f64 {
    let (sin, cos) = fibre_deg.to_radians().sin_cos();
    // As narrow as the optics leave a z-disc, and coarse pixels can show.
    (2.0 * ((TAU * (cos * x + sin * y) / SARCOMERE).cos() - 1.0)).exp()
}

/// Noise of mean 0 and standard deviation 1, always the same (a sum of uniform numbers).
pub(crate) fn noise(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    move || {
        let mut uniform = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..4).map(|_| uniform() - 0.5).sum::<f64>() * 3.0_f64.sqrt()
    }
}

/// Angle between two lines, degrees, 0 to 90.
pub(crate) fn apart(a_deg: f64, b_deg: f64) -> f64 {
    let turn = (a_deg - b_deg).rem_euclid(180.0);
    turn.min(180.0 - turn)
}

/// The largest angle between a field and a direction within a mesh, degrees.
fn worst(field: &FibreField, mesh: &Mesh, expected: impl Fn([f64; 2]) -> f64) -> f64 {
    let centre = |nodes: [u32; 3]| {
        let corners = nodes.map(|node| mesh.point(node as usize));
        [0, 1].map(|axis: usize| corners.iter().map(|corner| corner[axis]).sum::<f64>() / 3.0)
    };
    let angles =
        mesh.simplices.iter().zip(field.on_mesh(mesh)).map(|(triangle, [x, y])| {
            apart(y.atan2(x).to_degrees(), expected(centre(triangle.nodes)))
        });
    angles.fold(0.0, f64::max)
}

#[test]
#[ignore = "slow"]
fn stripes_at_any_angle_give_the_fibre_across_them_within_a_degree_everywhere() {
    let mut sample = Sample::one_in(7);
    for pixel in [0.08, 0.2, 0.27, 0.4] {
        let scene = Scene::new(pixel);
        let mesh = scene.mesh(1.5);
        for angle in (0..180).step_by(5).map(f64::from) {
            if sample.leaves_out() {
                continue;
            }
            let plane = scene.plane(|at| 100.0 + 900.0 * stripes(at, angle));
            let field = scene.field(&plane, Stain::ZDisc);
            let error = worst(&field, &mesh, |_| angle);
            assert!(error < 1.0, "{pixel} um, {angle} deg: {error} deg");
            let summary = field.summary();
            assert_eq!(summary.share_from_picture, 1.0);
            // Parallel fibres are fully ordered; 1e-3 stands for less than a degree and a half of spread.
            assert!(summary.alignment > 0.999 && summary.mean_order > 0.8, "{summary:?}");
            assert!(apart(summary.mean_angle_deg, angle - scene.axis_deg) < 0.3, "{summary:?}");
        }
    }
}

#[test]
fn noise_and_uneven_light_leave_the_mean_within_a_degree_and_every_place_within_five() {
    let mut sample = Sample::one_in(7);
    for (pixel, stain) in [(0.2, Stain::ZDisc), (0.27, Stain::ZDisc), (0.27, Stain::Filament)] {
        let scene = Scene::new(pixel);
        let mesh = scene.mesh(1.5);
        for angle in (0..180).step_by(5).map(f64::from) {
            if sample.leaves_out() {
                continue;
            }
            let mut noise = noise(angle as u64 + 1);
            // Filaments run along the stripes, so the stripes must lie the other way.
            let drawn = if stain == Stain::ZDisc { angle } else { angle + 90.0 };
            let plane = scene.plane(|[x, y]| {
                // Light that falls to a fifth across the cell, and noise as strong as the stripes
                // are there.
                let light = 0.6 + 0.4 * ((x + 0.5 * y) / 12.0).sin();
                light * (300.0 + 700.0 * stripes([x, y], drawn)) + 45.0 * noise()
            });
            let field = scene.field(&plane, stain);
            let summary = field.summary();
            let mean = apart(summary.mean_angle_deg, angle - scene.axis_deg);
            assert!(mean < 1.0, "{pixel} um, {stain:?}, {angle} deg: mean off by {mean} deg");
            // A neighbourhood of 3 um holds some fifty independent gradients, so noise of this strength
            // turns single places by some degrees.
            let error = worst(&field, &mesh, |_| angle);
            assert!(error < 5.0, "{pixel} um, {stain:?}, {angle} deg: {error} deg");
        }
    }
}

#[test]
fn the_same_stripes_are_across_for_z_discs_and_along_for_filaments() {
    let scene = Scene::new(0.2);
    let plane = scene.plane(|at| stripes(at, 20.0));
    let at = |stain| scene.field(&plane, stain).at(scene.point([1.0, 2.0])).angle_deg();
    assert!(apart(at(Stain::ZDisc), 20.0) < 0.2, "{}", at(Stain::ZDisc));
    assert!(apart(at(Stain::Filament), 110.0) < 0.2, "{}", at(Stain::Filament));
}

#[test]
fn fibres_that_turn_are_followed() {
    // Rings around a point outside the cell: the z-discs stand on them like spokes.
    let scene = Scene { side_um: 60.0, half: [24.0, 20.0], ..Scene::new(0.2) };
    let centre = [-20.0, -130.0];
    let plane = scene.plane(|[x, y]| {
        let angle = (y - centre[1]).atan2(x - centre[0]);
        // 1.8 um apart 130 um from the centre, 1.5 to 2.1 within the cell.
        (TAU * angle * 130.0 / SARCOMERE).cos()
    });
    let field = scene.field(&plane, Stain::ZDisc);
    let middle = scene.point([0.0, 0.0])[0];
    let error = worst(&field, &scene.mesh(1.5), |[x, y]| {
        (y - middle - centre[1]).atan2(x - middle - centre[0]).to_degrees() + 90.0
    });
    // The fibres turn by half a degree per um, and in the rim the mean is taken to one side only, some 3 um
    // away; inside it is far less.
    assert!(error < 4.0, "{error} deg");
    for point in [[0.0, 0.0], [-10.0, 5.0], [8.0, -6.0]] {
        let fibre = field.at(scene.point(point));
        let expected = (point[1] - centre[1]).atan2(point[0] - centre[0]).to_degrees() + 90.0;
        assert!(apart(fibre.angle_deg(), expected) < 1.0, "{point:?}: {fibre:?}");
    }
}

#[test]
fn pictures_without_stripes_give_the_long_axis() {
    let scene = Scene::new(0.27);
    let mut noise = noise(7);
    let pictures: [(&str, Plane, f64); 5] = [
        ("flat", scene.plane(|_| 40.0), 0.0),
        ("zero", scene.plane(|_| 0.0), 0.0),
        // Its contrast is its only structure, and no place has more of it than another.
        ("noise", scene.plane(|_| 100.0 + 20.0 * noise()), 0.02),
        ("light that falls off", scene.plane(|[x, y]| 500.0 + 6.0 * x + 3.0 * y), 0.0),
        // Rounded to whole numbers the slope becomes steps 2 um apart, like stripes of one grey level.
        ("a slope of whole numbers", scene.plane(|[x, _]| (50.0 + 0.5 * x).floor()), 0.02),
    ];
    for (name, plane, most) in pictures {
        let field = scene.field(&plane, Stain::ZDisc);
        let summary = field.summary();
        assert!(summary.share_from_picture <= most, "{name}: {summary:?}");
        assert!(summary.mean_order < 0.2, "{name}: {summary:?}");
        assert!(summary.mean_angle_deg.abs() < 3.0, "{name}: {summary:?}");
        let [x, y] = field.at(scene.point([0.0; 2])).direction;
        assert!(x * scene.axis()[0] + y * scene.axis()[1] > 0.99, "{name}: ({x}, {y})");
    }
}

#[test]
fn half_a_cell_without_stripes_turns_into_the_long_axis_without_a_jump() {
    let scene = Scene::new(0.2);
    let plane = scene.plane(|[x, y]| if x < 0.0 { 900.0 * stripes([x, y], 80.0) } else { 300.0 });
    let field = scene.field(&plane, Stain::ZDisc);
    let angle = |x: f64| field.at(scene.point([x, 0.0])).angle_deg();
    assert!(apart(angle(-9.0), 80.0) < 1.0, "{}", angle(-9.0));
    assert!(apart(angle(14.0), scene.axis_deg) < 1.0, "{}", angle(14.0));
    assert!(field.at(scene.point([-9.0, 0.0])).from_picture);
    assert!(!field.at(scene.point([14.0, 0.0])).from_picture);
    let steps = (-90..140).map(|k| 0.1 * f64::from(k));
    let jump = steps.map(|x| apart(angle(x), angle(x + 0.1))).fold(0.0, f64::max);
    // The turn of 50 degrees is spread over about the smoothing of 3 um.
    assert!(jump < 5.0, "{jump} deg within 0.1 um");
}

#[test]
fn the_outline_does_not_bend_the_field() {
    let scene = Scene { half: [20.0, 7.0], ..Scene::new(0.2) };
    let mesh = scene.mesh(1.0);
    for (stain, angle) in
        [(Stain::ZDisc, 30.0), (Stain::ZDisc, 75.0), (Stain::ZDisc, 120.0), (Stain::Filament, 60.0)]
    {
        let drawn = if stain == Stain::ZDisc { angle } else { angle + 90.0 };
        let plane = scene.plane(|at| {
            // Distance from the outline, to first order.
            let radius = |x: f64, y: f64| scene.radius([at[0] + x, at[1] + y]);
            let slope = (radius(0.01, 0.0) - radius(-0.01, 0.0))
                .hypot(radius(0.0, 0.01) - radius(0.0, -0.01))
                / 0.02;
            let depth = (1.0 - scene.radius(at)) / slope;
            // A membrane five times as bright as the stripes, on a dark background.
            let rim = 3000.0 * (-(depth / 0.4).powi(2)).exp();
            let cell = if depth > 0.0 { 400.0 + 600.0 * stripes(at, drawn) } else { 0.0 };
            cell + rim
        });
        let error = worst(&scene.field(&plane, stain), &mesh, |_| angle);
        assert!(error < 1.0, "{stain:?}, {angle} deg: {error} deg");
    }
}

#[test]
fn brightness_does_not_decide_between_two_directions() {
    // Stripes beside stripes of a third of the contrast: the border stays where it is.
    let scene = Scene::new(0.2);
    let both = |factor: f64| {
        let plane = scene.plane(|[x, y]| {
            if x < 0.0 { factor * stripes([x, y], 0.0) } else { stripes([x, y], 60.0) }
        });
        let field = scene.field(&plane, Stain::ZDisc);
        let turned = |x: f64| field.at(scene.point([x, 0.0])).angle_deg() > 30.0;
        (-40..40).map(|k| 0.1 * f64::from(k)).find(|&x| turned(x)).unwrap()
    };
    let (equal, bright) = (both(1.0), both(3.0));
    // About the scale over which contrast is evened out, 1.2 um. Nine times the energy would move it by
    // 3.8 um, to where a Gaussian of 3 um has a tenth on the other side.
    assert!(equal.abs() < 0.5 && bright.abs() < 1.6, "{equal} um, {bright} um");
}

#[test]
fn a_mesh_gets_one_unit_vector_for_each_triangle_none_against_the_long_axis() {
    let scene = Scene::new(0.27);
    let mesh = scene.mesh(1.0);
    let mut noise = noise(3);
    let plane = scene.plane(|at| stripes(at, 100.0) + 0.4 * noise());
    let field = scene.field(&plane, Stain::ZDisc);
    let vectors = field.on_mesh(&mesh);
    assert_eq!(vectors.len(), mesh.simplices.len());
    for [x, y] in vectors {
        assert!((x.hypot(y) - 1.0).abs() < 1e-12, "({x}, {y})");
        assert!(x * scene.axis()[0] + y * scene.axis()[1] >= 0.0, "({x}, {y})");
    }
    let points = field.on_grid(2.0);
    // One point for each 4 um^2 of the ellipse; on the outline some fall in and some out.
    let expected = TAU / 2.0 * scene.half[0] * scene.half[1] / 4.0;
    assert!((points.len() as f64 / expected - 1.0).abs() < 0.1, "{} {expected}", points.len());
    let middle = scene.point([0.0; 2])[0];
    assert!(points.iter().all(|([x, y], _)| scene.radius([x - middle, y - middle]) < 1.1));
}

#[test]
fn a_cell_contracts_along_the_stripes_normal_that_the_picture_shows() {
    // A round cell has no direction of its own.
    let scene = Scene { half: [18.0, 18.0], axis_deg: 0.0, ..Scene::new(0.27) };
    let mesh = scene.mesh(2.0);
    for angle in [20.0_f64, 65.0, 140.0] {
        let plane = scene.plane(|at| stripes(at, angle));
        let fibres = scene.field(&plane, Stain::ZDisc).on_mesh(&mesh);
        let toy = ToyModel::published();
        let simulation = Simulation {
            protocol: Protocol { start_ms: 0.0, ..Protocol::once(toy.default_stimulus()) },
            cell: std::sync::Arc::new(toy),
            duration: 50.0,
            fibres,
            ..Simulation::new(mesh.clone())
        };
        let outcome = simulation.run_quasi_static(Tolerance::default(), |_| true).unwrap();
        assert!(outcome.stop.is_none());
        let last = outcome.recording.frames.last().unwrap();
        let shrunk = Mesh { points: last.positions.clone(), ..mesh.clone() };
        let stretch = |deg: f64| {
            let (sin, cos) = deg.to_radians().sin_cos();
            quality::extent(&shrunk, [cos, sin]) / quality::extent(&mesh, [cos, sin])
        };
        let (along, across) = (stretch(angle), stretch(angle + 90.0));
        assert!(along < 0.95 && across > 1.0, "{angle} deg: {along} along, {across} across");
        // The direction of least stretch, from the second moments: a circle became an ellipse whose
        // long axis stands across the fibre.
        let [x, y] = quality::long_axis(&shrunk);
        // The outline of the mesh is made of squares, which costs a degree or two.
        assert!(apart(y.atan2(x).to_degrees(), angle + 90.0) < 2.0, "{angle} deg: ({x}, {y})");
    }
}

#[test]
fn what_cannot_be_used_is_an_error_that_says_how_to_mend_it() {
    let plane = Plane::new(4, 3, vec![1.0; 12]).unwrap();
    let plain = FibreSettings::of(Stain::ZDisc);
    let x = [1.0, 0.0];
    let run = |inside: &[bool], pixel, axis, settings: &FibreSettings| {
        fibres(&plane, inside, pixels_of(pixel), axis, settings).map(|_| ()).unwrap_err()
    };
    let all = [true; 12];
    assert!(matches!(run(&all[..11], 0.2, x, &plain), FibreError::MaskShape { found: 11, .. }));
    assert_eq!(run(&[false; 12], 0.2, x, &plain), FibreError::EmptyMask);
    let coarse = run(&all, 0.8, x, &plain).to_string();
    assert!(coarse.contains("0.8 um") && coarse.contains("at most 0.7 um"), "{coarse}");
    for axis in [[0.0; 2], [f64::NAN, 1.0], [f64::INFINITY, 0.0]] {
        assert!(matches!(run(&all, 0.2, axis, &plain), FibreError::LongAxis { .. }));
    }
    for (settings, message) in [
        (FibreSettings { smoothing_um: 0.0, ..plain }, "the smoothing is 0 um"),
        (FibreSettings { gradient_scale_um: f64::NAN, ..plain }, "between 0.05 and 100 um"),
        (FibreSettings { background_scale_um: 1e9, ..plain }, "the background scale"),
        (FibreSettings { rim_um: -1.0, ..plain }, "the rim is -1 um; it must be between 0 and"),
        (FibreSettings { least_coherency: 1.5, ..plain }, "the least coherency is 1.5; it must"),
    ] {
        let error = run(&all, 0.2, x, &settings).to_string();
        assert!(error.contains(message), "{error}");
    }
}

#[test]
fn odd_pictures_neither_panic_nor_give_anything_but_unit_vectors() {
    let wild = |n: usize| match n % 5 {
        0 => f32::NAN,
        1 => f32::INFINITY,
        2 => f32::MAX,
        3 => -f32::MAX,
        _ => 1e-38,
    };
    let unit = |field: &FibreField| {
        for point in [[0.0, 0.0], [1e9, -1e9], [f64::NAN, 1.0]] {
            let [x, y] = field.at(point).direction;
            assert!((x.hypot(y) - 1.0).abs() < 1e-12, "{point:?}: ({x}, {y})");
        }
        let summary = field.summary();
        assert!(summary.alignment.is_finite() && summary.mean_angle_deg.is_finite(), "{summary:?}");
        assert!(field.on_grid(0.0).len() <= 4000 && field.on_grid(f64::NAN).len() <= 4000);
    };
    for [width, height] in [[1, 1], [1, 40], [40, 1], [50, 70]] {
        let count = width * height;
        for settings in [
            FibreSettings::of(Stain::ZDisc),
            FibreSettings { rim_um: 0.0, ..FibreSettings::of(Stain::Filament) },
            FibreSettings { gradient_scale_um: 100.0, ..FibreSettings::of(Stain::ZDisc) },
            FibreSettings { smoothing_um: 100.0, ..FibreSettings::of(Stain::ZDisc) },
        ] {
            for values in [(0..count).map(wild).collect(), vec![f32::NAN; count], vec![7.0; count]]
            {
                let plane = Plane::new(width, height, values).unwrap();
                for pixel in [0.001, 0.3] {
                    let all = vec![true; count];
                    unit(&fibres(&plane, &all, pixels_of(pixel), [1.0, 0.0], &settings).unwrap());
                }
            }
        }
    }
}

#[test]
fn pixels_that_are_not_finite_are_left_out() {
    let scene = Scene::new(0.2);
    let mut count = 0;
    let plane = scene.plane(|at| {
        count += 1;
        if count % 97 == 0 { f64::NAN } else { 100.0 * stripes(at, 70.0) }
    });
    let fibre = scene.field(&plane, Stain::ZDisc).at(scene.point([0.0; 2]));
    // A missing pixel counts as the local mean: one in a hundred is a little noise.
    assert!(fibre.from_picture && apart(fibre.angle_deg(), 70.0) < 1.0, "{fibre:?}");
}

#[test]
fn the_myofibrils_of_a_real_cell_are_followed_where_a_person_sees_them() {
    let folder = "images";
    let files = ["sarcgraph_e5_fluorescence.png", "sarcgraph_e5_mask.png"];
    let [Some(picture), Some(mask)] =
        files.map(|file| common::shared_data(&format!("{folder}/{file}")))
    else {
        return;
    };
    let [plane, mask] = [picture, mask].map(|file| {
        let bytes = std::fs::read(file).unwrap();
        read_picture(&bytes, &Selection::default()).unwrap().plane
    });
    let height = plane.height();
    let inside: Vec<bool> = mask.values().iter().map(|&value| value > 0.0).collect();
    let pixel = 0.27;
    let settings = FibreSettings::of(Stain::ZDisc);
    let field = fibres(&plane, &inside, pixels_of(pixel), [0.6, 0.8], &settings).unwrap();
    // Column, row, and the fibre's angle across the stripes there, read off the picture with a
    // protractor: good to some 10 degrees.
    for (column, row, angle) in
        [(128.0, 270.0, 90.0), (235.0, 402.0, 0.0), (165.0, 370.0, 140.0), (398.0, 170.0, 95.0)]
    {
        let fibre = field.at([pixel * column, pixel * (height as f64 - row)]);
        assert!(fibre.from_picture, "{column}, {row}: {fibre:?}");
        let off = apart(fibre.angle_deg(), angle);
        assert!(off < 15.0, "{column}, {row}: {} deg", fibre.angle_deg());
    }
    // Stripes all along the outline, and rows of dots a sarcomere apart within; not the blurred place at the right.
    let summary = field.summary();
    assert!((0.6..0.95).contains(&summary.share_from_picture), "{summary:?}");
}
