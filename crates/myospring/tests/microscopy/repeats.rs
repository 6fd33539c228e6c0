//! Frames that a film has twice: found by the film's own noise, whatever it shows.

use myospring::microscopy::film::Film;
use myospring::microscopy::picture::Selection;

use super::synthetic_cell::Random;

const SIZE: [usize; 2] = [48, 32];
const FRAMES: usize = 60;

/// How a cell moves.
#[derive(Debug, Clone, Copy)]
enum Motion {
    /// Beats of ten frames, and ten of rest.
    Rests,
    /// Never at rest.
    Always,
    /// One beat, and rest before and after it.
    Once,
    /// One beat, on a stage that drifts, with a stain that bleaches.
    Drifts,
}

impl Motion {
    /// Shift of the pattern in pixels, and its brightness.
    fn at(self, frame: usize) -> (f64, f64) {
        let t = frame as f64;
        let bell = |from: f64, length: f64| {
            let part = (t - from) / length;
            if (0.0..1.0).contains(&part) {
                (std::f64::consts::PI * part.sqrt()).sin().powi(2)
            } else {
                0.0
            }
        };
        match self {
            Self::Rests => (
                (0..3).map(|beat| bell(20.0 * f64::from(beat) + 4.0, 10.0)).sum::<f64>() * 4.0,
                1.0,
            ),
            Self::Always => (4.0 * (0.37 * t).sin() + 2.0 * (0.23 * t).cos(), 1.0),
            Self::Once => (4.0 * bell(20.0, 12.0), 1.0),
            Self::Drifts => (4.0 * bell(20.0, 12.0) + 0.05 * t, 1.0 - 0.002 * t),
        }
    }
}

/// Which frames are written again.
#[derive(Debug, Clone, Copy)]
enum Written {
    Once,
    /// Every seventh twice.
    SeventhTwice,
    /// All twice: a film at double rate.
    Twice,
    /// Three times.
    Thrice,
}

impl Written {
    fn times(self, frame: usize) -> usize {
        match self {
            Self::Once => 1,
            Self::SeventhTwice => 1 + usize::from(frame % 7 == 5),
            Self::Twice => 2,
            Self::Thrice => 3,
        }
    }
}

/// A film with noise (grey levels), and frames that repeat others but for a part of that noise: what a compression leaves.
/// With it which frame repeats which.
fn film(motion: Motion, written: Written, noise: f64, residue: f64) -> (Film, Vec<Option<usize>>) {
    let [width, height] = SIZE;
    let mut bytes = format!("YUV4MPEG2 W{width} H{height} F50:1 Cmono\n").into_bytes();
    let mut repeats = Vec::new();
    let mut random = Random(7);
    for frame in 0..FRAMES {
        let (shift, bright) = motion.at(frame);
        let grey = |at: usize| {
            let (x, y) = ((at % width) as f64 - shift, (at / width) as f64);
            let pattern = (0.7 * x).sin() * (0.4 * y + 0.1 * x).cos();
            bright * (120.0 + 60.0 * pattern)
        };
        let taken: Vec<f64> =
            (0..width * height).map(|at| grey(at) + noise * random.normal()).collect();
        for time in 0..written.times(frame) {
            repeats.push((time > 0).then(|| repeats.len() - time));
            bytes.extend(b"FRAME\n");
            let left = if time > 0 { residue * noise } else { 0.0 };
            bytes.extend(taken.iter().map(|value| (value + left * random.normal()).round() as u8));
        }
    }
    (Film::read(bytes, &Selection::default()).unwrap(), repeats)
}

#[test]
fn frames_that_were_written_again_are_found_over_noise_rest_and_compression() {
    for motion in [Motion::Rests, Motion::Always, Motion::Once, Motion::Drifts] {
        for written in [Written::Once, Written::SeventhTwice, Written::Twice, Written::Thrice] {
            for (noise, residue) in
                [(0.0, 0.0), (0.6, 0.0), (2.0, 0.0), (2.0, 0.1), (8.0, 0.0), (8.0, 0.15)]
            {
                let (film, wanted) = film(motion, written, noise, residue);
                let found = film.repeats().unwrap();
                let case =
                    format!("{motion:?}, written {written:?}, noise {noise}, {residue} left");
                if noise > 0.0 {
                    assert_eq!(found, wanted, "{case}");
                } else {
                    // Without noise a cell at rest has the same picture again; none of these is called a repeated one.
                    let wrong = found
                        .iter()
                        .zip(&wanted)
                        .filter(|(found, wanted)| found.is_some() && wanted.is_none());
                    assert_eq!(wrong.count(), 0, "{case}");
                }
            }
        }
    }
}

#[test]
fn a_cell_at_rest_in_a_film_without_noise_repeats_no_frame() {
    for motion in [Motion::Rests, Motion::Once] {
        let (film, _) = film(motion, Written::Once, 0.0, 0.0);
        assert!(film.repeats().unwrap().iter().all(Option::is_none), "{motion:?}");
    }
}

#[test]
fn the_published_film_with_twenty_repeated_frames_has_these() {
    let Some(film) = super::common::shared_data("films/sarcgraph_sample_2.avi") else { return };
    let film = Film::read(std::fs::read(film).unwrap(), &Selection::default()).unwrap();
    let repeats = film.repeats().unwrap();
    let found: Vec<usize> = (0..film.len()).filter(|&at| repeats[at].is_some()).collect();
    // Those whose pixels are the same to the last bit.
    let same: Vec<usize> = (1..film.len())
        .filter(|&at| film.frame(at).unwrap().values() == film.frame(at - 1).unwrap().values())
        .collect();
    assert_eq!((found.len(), &found), (20, &same));
}
