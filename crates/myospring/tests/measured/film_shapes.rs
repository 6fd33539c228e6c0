//! A simulated cell laid over the film of one whose motion is known.

use super::pulled_film::{FRAMES, Pulled, even, together};
use super::synthetic_film::FilmScene;
use myospring::analysis::shape::laid_upon;
use myospring::mechanics::support::SupportKind;
use myospring::mesh::Mesh;
use myospring::microscopy::motion::CellMotion;
use myospring::recording::Frame;
use myospring::tension_map::FrameShape;

/// When the simulated cell begins, ms of the film.
const START_MS: f64 = -20.0;

fn pulled() -> Pulled {
    let scene = FilmScene { cell_um: [60.0, 16.0], noise: 0.05, bits: 8, ..FilmScene::default() };
    Pulled {
        scene,
        tension: even,
        support: SupportKind::MassCentre,
        frames: &FRAMES,
        lag: together,
    }
}

/// The cell of the film with a part of its tension, at the times of its frames.
fn simulated(pulled: &Pulled, mesh: &Mesh, motion: &CellMotion, part: f64) -> Vec<Frame> {
    let frame = |(level, t_ms): (&f64, &f64)| {
        let moved = pulled.displacements(mesh, part * level);
        let positions = [0, 1].map(|axis: usize| {
            mesh.points[axis].iter().zip(&moved[axis]).map(|(rest, way)| rest + way).collect()
        });
        Frame::new(t_ms - START_MS, 0.0, positions)
    };
    FRAMES.iter().zip(&motion.times_ms).map(frame).collect()
}

/// Root mean square distance of two shapes after the best shift and rotation, um.
fn apart(mesh: &Mesh, one: &[Vec<f64>; 2], other: &[Vec<f64>; 2]) -> f64 {
    let placed = laid_upon(one, other, &mesh.areas);
    let square = |at: usize| (0..2).map(|a| (placed[a][at] - other[a][at]).powi(2)).sum::<f64>();
    let sum: f64 = mesh.areas.iter().enumerate().map(|(at, area)| area * square(at)).sum();
    (sum / mesh.areas.iter().sum::<f64>()).sqrt()
}

#[test]
fn distances_from_a_film_are_those_between_the_shapes_and_no_frame_of_it_has_none() {
    let pulled = pulled();
    let mesh = pulled.mesh(1.2);
    let mut motion = pulled.followed(&mesh);
    let truth = simulated(&pulled, &mesh, &motion, 1.0);
    let own = FrameShape::all(&motion, &truth, START_MS, 0.0);
    assert_eq!(own.len(), FRAMES.len());
    let half = simulated(&pulled, &mesh, &motion, 0.5);
    for (at, (own, half)) in
        own.iter().zip(FrameShape::all(&motion, &half, START_MS, 0.0)).enumerate()
    {
        assert_eq!((own.frame, own.at, own.t_ms), (at, at, motion.times_ms[at]));
        // What following a film with this noise leaves: a tenth of a pixel of 0.25 um.
        assert!(own.distance_um < 0.03, "{at}: {}", own.distance_um);
        let moved = apart(&mesh, &truth[at].positions, &mesh.points);
        assert!((own.movement_um - moved).abs() < 0.03, "{at}: {} {moved}", own.movement_um);
        let between = apart(&mesh, &truth[at].positions, &half.positions_um);
        assert!((half.distance_um - between).abs() < 0.03, "{at}: {} {between}", half.distance_um);
        // It lies where the film's cell is.
        let film = motion.positions(at);
        let off = |axis: usize| {
            let off = own.positions_um[axis].iter().zip(&film[axis]).map(|(a, b)| a - b);
            off.sum::<f64>() / mesh.len() as f64
        };
        assert!(off(0).abs() < 0.01 && off(1).abs() < 0.01, "{at}");
    }
    // A run that covers a part of the film: before it the cell rests. And one that covers none of it.
    let part = FrameShape::all(&motion, &truth[2..6], START_MS, motion.times_ms[1]);
    assert_eq!(part.iter().map(|shape| shape.frame).collect::<Vec<_>>(), [1, 2, 3, 4, 5]);
    assert!(part[0].distance_um < 0.03, "{}", part[0].distance_um);
    assert!(FrameShape::all(&motion, &truth, -1e6, 0.0).is_empty());
    assert!(FrameShape::all(&motion, &truth, START_MS, 1e6).is_empty());
    assert!(FrameShape::all(&motion, &[], START_MS, 0.0).is_empty());
    // Frames without a found point have no distance, and a film without rest counts from its reference.
    for at in [0, 1, 2, 8] {
        motion.interpolated[at].fill(true);
    }
    let without_rest = FrameShape::all(&motion, &truth, START_MS, 0.0);
    assert_eq!(without_rest.iter().map(|it| it.frame).collect::<Vec<_>>(), [3, 4, 5, 6, 7]);
    assert!(without_rest.iter().all(|it| it.distance_um < 0.03 && it.movement_um > 0.2));
    motion.interpolated.iter_mut().for_each(|frame| frame.fill(true));
    assert!(FrameShape::all(&motion, &truth, START_MS, 0.0).is_empty());
}
