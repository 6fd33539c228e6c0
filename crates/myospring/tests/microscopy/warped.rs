//! Real pictures of cells, warped by the program's own beat into films of known motion, and followed.

use myospring::mesh::lattice;
use myospring::mesh::mask::Mask;
use myospring::mesh::quality::long_axis;
use myospring::microscopy::fibres::{FibreSettings, Stain, fibres};
use myospring::microscopy::motion::{self, CellAtRest, CellMotion, Rest, TrackingSettings};
use myospring::microscopy::picture::Selection;
use myospring::microscopy::plane::Plane;
use myospring::microscopy::read::read_picture;

use super::common::{pixels_of, shared_data};
use super::warped_film::{Camera, FRAME_RATE, WarpedFilm};

/// Pixels of the real film's noise over the spread of its cell's grey values: 1.67 of 10.8 levels.
const CAMERA: Camera = Camera { noise: 0.155, vignette: 0.3, bleach: 0.2 };

/// A picture and its mask, or `None` with a word about the test that is skipped.
fn picture(name: &str, mask: &str, pixel_um: f64) -> Option<(Plane, Mask)> {
    let [Some(picture), Some(mask)] =
        [name, mask].map(|file| shared_data(&format!("images/{file}")))
    else {
        return None;
    };
    let [plane, mask] = [picture, mask].map(|file| {
        let bytes = std::fs::read(file).unwrap();
        read_picture(&bytes, &Selection::default()).unwrap().plane
    });
    let inside = mask.values().iter().map(|&value| value > 0.0).collect();
    let mask = Mask::new(mask.width(), mask.height(), pixels_of(pixel_um), inside).unwrap();
    Some((plane, mask))
}

/// Follows the cell on points that are not those of the mesh that beat.
fn follow(warped: &WarpedFilm, camera: Camera, stripes: bool) -> CellMotion {
    let film = warped.film(camera, 3);
    let mask = warped.mask();
    let (mesh, _) = lattice::from_mask(mask, None).unwrap();
    let inside = mask.inside();
    let rest = Rest::at(&film, 0).unwrap();
    let field = stripes.then(|| {
        let settings = FibreSettings::of(Stain::ZDisc);
        fibres(&film.frame(0).unwrap(), &inside, mask.pixel_size(), long_axis(&mesh), &settings)
            .unwrap()
    });
    let pixel_size = mask.pixel_size();
    let fibres = field.as_ref();
    let cell = CellAtRest { mesh: &mesh, inside: &inside, any_cell: &inside, pixel_size, fibres };
    motion::follow(&film, rest, &cell, TrackingSettings::at(FRAME_RATE), |_| true).unwrap()
}

/// How far off a motion is.
#[derive(Debug)]
struct Errors {
    /// Of all points in all frames, pixels.
    median_px: f64,
    most_px: f64,
    /// Of the shortening against the mean of the frames at rest, percentage points: the root of the mean square of all
    /// frames, and the largest.
    shortening: f64,
    largest: f64,
}

impl Errors {
    fn of(warped: &WarpedFilm, motion: &CellMotion) -> Self {
        let pixel = warped.mask().pixel_size().um();
        let mut truth = motion.clone();
        let mut errors = Vec::new();
        for frame in 0..motion.len() {
            let of_film = motion.frames[frame];
            for node in 0..motion.mesh.len() {
                let wanted = warped.displacement(motion.mesh.point(node), of_film);
                let off = [0, 1].map(|axis: usize| {
                    let found = motion.displacements_um[frame][axis][node];
                    truth.displacements_um[frame][axis][node] = wanted[axis];
                    found + motion.stage_um[frame][axis] - wanted[axis]
                });
                errors.push(off[0].hypot(off[1]) / pixel);
            }
        }
        errors.sort_by(f64::total_cmp);
        let at = |part: f64| errors[((errors.len() - 1) as f64 * part) as usize];
        let shortening = |motion: &CellMotion| {
            let lengths = motion.lengths_um();
            let rest = (0..lengths.len()).filter(|&frame| warped.rests(motion.frames[frame]));
            let resting =
                rest.clone().map(|frame| lengths[frame]).sum::<f64>() / rest.count() as f64;
            lengths.into_iter().map(|length| 100.0 * (1.0 - length / resting)).collect::<Vec<_>>()
        };
        let off: Vec<f64> =
            shortening(motion).iter().zip(shortening(&truth)).map(|(a, b)| (a - b).abs()).collect();
        let square = off.iter().map(|off| off * off).sum::<f64>() / off.len() as f64;
        Self {
            median_px: at(0.5),
            most_px: at(0.95),
            shortening: square.sqrt(),
            largest: off.into_iter().fold(0.0, f64::max),
        }
    }
}

#[test]
fn real_pictures_warped_by_our_own_beat_are_followed() {
    if crate::common::left_to_full() {
        return;
    }
    let pictures = [
        ("sarcgraph_e5_fluorescence.png", "sarcgraph_e5_mask.png", 0.27, true, CAMERA),
        ("sarcgraph_e2_rest.png", "sarcgraph_e2_mask.png", 0.18, true, Camera::default()),
        ("contrax_brightfield.tif", "contrax_brightfield_mask.png", 0.27, false, CAMERA),
    ];
    for (name, mask, pixel_um, stripes, camera) in pictures {
        let Some((plane, mask)) = picture(name, mask, pixel_um) else { continue };
        let warped = WarpedFilm::new(plane, mask, 3.0, 50.0);
        // What is asked of it: 0.05 px, 0.1 px with the noise of a real film, 0.1 points of shortening.
        let bound = if camera.noise > 0.0 { 0.1 } else { 0.05 };
        let errors = Errors::of(&warped, &follow(&warped, camera, stripes));
        eprintln!("{name}, noise {}: {errors:?}", camera.noise);
        assert!(errors.median_px <= bound, "{name}: {errors:?}");
        assert!(errors.shortening <= 0.1, "{name}: {errors:?}");
        // No stripe is mistaken for its neighbour, and no frame is far worse than the others.
        assert!(errors.most_px <= 0.5 && errors.largest <= 0.3, "{name}: {errors:?}");
    }
}
