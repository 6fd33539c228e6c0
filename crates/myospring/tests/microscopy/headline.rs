//! Which number of a film says how much its cell contracts.

use myospring::mesh::Mesh;
use myospring::mesh::lattice;
use myospring::microscopy::motion::{CellMotion, Measure, Reason, Stage};
use std::f64::consts::TAU;

use super::synthetic_cell::Random;

const FRAMES: usize = 41;
/// Length and width of the cell, um.
const CELL_UM: [f64; 2] = [80.0, 16.0];

/// How strong the beats are in a frame, 0 to 1; the first frame is at rest.
fn strength(frame: usize) -> f64 {
    (0.5 * TAU * frame as f64 / 20.0).sin().powi(2)
}

/// A motion by the displacement (um) of what rests at a point, measured from the middle of the cell, in a frame.
fn motion(displacement: impl Fn([f64; 2], usize) -> [f64; 2]) -> CellMotion {
    let mesh: Mesh = lattice::rectangle(40, 8, 2.0).unwrap();
    let displaced = |frame: usize| {
        let ways: Vec<[f64; 2]> = (0..mesh.len())
            .map(|node| {
                let [x, y] = mesh.point(node);
                displacement([x - 0.5 * CELL_UM[0], y - 0.5 * CELL_UM[1]], frame)
            })
            .collect();
        [0, 1].map(|axis: usize| ways.iter().map(|way| way[axis]).collect::<Vec<f64>>())
    };
    CellMotion {
        frames: (0..FRAMES).collect(),
        repeated: Vec::new(),
        interrupted: false,
        rest: 0,
        times_ms: (0..FRAMES).map(|frame| 20.0 * frame as f64).collect(),
        displacements_um: (0..FRAMES).map(displaced).collect(),
        interpolated: vec![vec![false; mesh.len()]; FRAMES],
        correlation: vec![Some(0.99); FRAMES],
        stage: Stage::CellMean { cells: 1 },
        stage_um: vec![[0.0; 2]; FRAMES],
        sarcomeres_um: vec![None; FRAMES],
        sarcomere_places: 0,
        sarcomere_parts: 0,
        sarcomeres_by_part_um: Vec::new(),
        error_um: Some(0.01),
        noise: 1.0,
        subset_um: 4.0,
        pixel_um: 0.2,
        // With room on all sides, once the mesh has its place in it.
        frame_um: [CELL_UM[0] + 20.0, CELL_UM[1] + 20.0],
        mesh: shifted(mesh, 10.0),
    }
}

fn shifted(mut mesh: Mesh, by: f64) -> Mesh {
    for axis in &mut mesh.points {
        for place in axis.iter_mut() {
            *place += by;
        }
    }
    mesh
}

/// What all films here do: 8 % along the cell, 3 % wider.
fn even([x, y]: [f64; 2], frame: usize) -> [f64; 2] {
    [-0.08 * strength(frame) * x, 0.03 * strength(frame) * y]
}

fn shortening_pct(motion: &CellMotion) -> Vec<f64> {
    let lengths = motion.lengths_um();
    lengths.iter().map(|length| 100.0 * (1.0 - length / lengths[0])).collect()
}

#[test]
fn a_frame_that_shows_nothing_of_the_cell_counts_for_no_contraction() {
    // What is interpolated of a black frame is anything.
    let wild =
        |[x, y]: [f64; 2], frame| if frame == 3 { [0.0, -0.5 * y] } else { even([x, y], frame) };
    let mut motion = motion(wild);
    assert_ne!(motion.headline().measure, Measure::Length);
    motion.interpolated[3].fill(true);
    assert!(!motion.frames_with_cell().contains(&3));
    assert_eq!(motion.headline().measure, Measure::Length);
    let said = motion.doubts().join("; ");
    assert!(said.contains("1 of them") && said.contains("do not count"), "{said}");
    motion.interpolated.iter_mut().for_each(|frame| frame.fill(true));
    assert_eq!(motion.frames_with_cell().len(), FRAMES);
}

#[test]
fn a_whole_cell_that_shortens_is_read_by_its_length() {
    let motion = motion(even);
    let headline = motion.headline();
    assert_eq!(headline.measure, Measure::Length);
    assert!(matches!(headline.reason, Reason::Follows { correlation } if correlation > 0.999));
    let most = shortening_pct(&motion).into_iter().fold(0.0, f64::max);
    assert!((most - 8.0).abs() < 1e-9, "{most}");
}

#[test]
fn length_and_width_do_not_depend_on_single_points() {
    // One point in forty is anywhere within 3 um, more than the cell shortens.
    let mut random = Random(3);
    let wild: Vec<Vec<[f64; 2]>> = (0..FRAMES)
        .map(|_| {
            (0..500)
                .map(|_| {
                    if random.next() < 0.025 {
                        [0, 1].map(|_| 6.0 * (random.next() - 0.5))
                    } else {
                        [0.0; 2]
                    }
                })
                .collect()
        })
        .collect();
    let smooth = motion(even);
    let mut wrong = smooth.clone();
    for (frame, moved) in wrong.displacements_um.iter_mut().enumerate().skip(1) {
        for (axis, values) in moved.iter_mut().enumerate() {
            values.iter_mut().zip(&wild[frame]).for_each(|(value, wild)| *value += wild[axis]);
        }
    }
    let off = |of: &dyn Fn(&CellMotion) -> Vec<f64>| {
        let pairs = of(&smooth).into_iter().zip(of(&wrong));
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    // An end has 27 points, a side 41: of a wild one a share. From extreme to extreme it was all of it, 3 um of 80 and
    // of 16, 3.8 and 19 %.
    let length = off(&shortening_pct);
    assert!(length < 0.6, "{length} percentage points");
    let width = off(&|motion: &CellMotion| {
        motion.extents().iter().map(|extent| 100.0 * extent.width / CELL_UM[1]).collect()
    });
    assert!(width < 3.0, "{width} percentage points");
    assert_eq!(wrong.headline().measure, Measure::Length, "{:?}", wrong.headline());
}

#[test]
fn a_cell_whose_length_says_nothing_is_read_by_its_stretch() {
    let half = 0.5 * CELL_UM[0];
    // Held at both ends: the middle draws what is beside it.
    let held = motion(|[x, y], frame| {
        [-4.0 * strength(frame) * (TAU * x / CELL_UM[0]).sin(), even([x, y], frame)[1]]
    });
    let across = motion(|[_, y], frame| [0.0, -0.08 * strength(frame) * y]);
    // The ends wander on their own, as those do that are wrongly found.
    let wandering = motion(|[x, y], frame| {
        let wander = if x.abs() > 0.85 * half { 4.0 * (0.9 * frame as f64).sin() } else { 0.0 };
        let [along, aside] = even([x, y], frame);
        [along + wander * x.signum(), aside]
    });
    let still = motion(|_, _| [0.0; 2]);
    let mut cut = motion(even);
    cut.frame_um[0] = 10.5 + CELL_UM[0];
    let mut lost = motion(even);
    for (node, &x) in lost.mesh.points[0].iter().enumerate() {
        if x < 15.0 {
            lost.interpolated.iter_mut().for_each(|interpolated| interpolated[node] = true);
        }
    }
    for (motion, wanted) in [
        (held, "something holds the ends"),
        (across, "at 90 degrees to its long axis"),
        (wandering, "do not move as the whole cell does"),
        (still, "hardly moves"),
        (cut, "the frame cuts an end"),
        (lost, "not found again"),
    ] {
        let headline = motion.headline();
        assert_eq!(headline.measure, Measure::Stretch, "{wanted}");
        assert!(headline.reason.to_string().contains(wanted), "{wanted}: {:?}", headline.reason);
    }
}
