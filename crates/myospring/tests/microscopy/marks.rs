//! Burned-in marks: letters of several sizes and strokes, bars, in colour, after lossy compression; and stripes that are
//! none.

use crate::common::Sample;
use std::f64::consts::PI;

use crate::common::{pixels_of, png};
use crate::no_cell::letters;
use crate::synthetic_cell::{Random, Scene};
use myospring::microscopy::burned_in;
use myospring::microscopy::cells::{PictureCells, PictureOptions};

const SIDE: usize = 240;

/// How a caption with a scale bar is drawn.
#[derive(Debug, Clone, Copy)]
struct Drawn {
    /// Height of a letter, and half the width of its strokes, pixels.
    height: f64,
    half_stroke: f64,
    /// Whether its edge is smoothed, as programs draw text.
    smooth: bool,
}

impl Drawn {
    /// How much of each pixel is drawn.
    fn cover(self) -> Vec<f64> {
        let Self { height, half_stroke, smooth } = self;
        let edge = if smooth { 0.5 } else { 1e-9 };
        let cover = |at: usize| {
            let (x, y) = ((at % SIDE) as f64, (at / SIDE) as f64);
            let off = letters([(x - 20.0) / height, (y - 180.0) / height])
                .into_iter()
                .fold(f64::INFINITY, |least, off| least.min(off * height));
            let bar = (20.0..100.0).contains(&x) && (168.0..173.0).contains(&y);
            let letter = ((half_stroke + edge - off) / (2.0 * edge)).clamp(0.0, 1.0);
            if bar { 1.0 } else { letter }
        };
        (0..SIDE * SIDE).map(cover).collect()
    }
}

/// A striped cell of eight bits on a dark ground, with noise.
fn cell() -> Vec<f64> {
    let scene = Scene { field_um: 60.0, contrast: 0.08, noise: 4.0, ..Scene::default() };
    let values = scene.fluorescence().plane;
    values.values().iter().map(|&value| f64::from(value.min(255.0))).collect()
}

/// A block of 8 x 8 pixels, quantised as JPEG does: its cosine transform in steps that grow with the frequency.
fn compressed(channel: &mut [f64], step: f64) {
    let basis = |k: usize, n: usize| {
        let scale = if k == 0 { 0.125_f64.sqrt() } else { 0.5 };
        scale * (PI * (2 * n + 1) as f64 * k as f64 / 16.0).cos()
    };
    let turned = |values: [[f64; 8]; 8], forward: bool| {
        let mut out = [[0.0; 8]; 8];
        for (k, row) in out.iter_mut().enumerate() {
            for (l, sum) in row.iter_mut().enumerate() {
                for (n, values) in values.iter().enumerate() {
                    for (m, value) in values.iter().enumerate() {
                        let [a, b] = if forward {
                            [basis(k, n), basis(l, m)]
                        } else {
                            [basis(n, k), basis(m, l)]
                        };
                        *sum += a * b * value;
                    }
                }
            }
        }
        out
    };
    for (top, left) in (0..SIDE).step_by(8).flat_map(|y| (0..SIDE).step_by(8).map(move |x| (y, x)))
    {
        let at = |y: usize, x: usize| (top + y) * SIDE + left + x;
        let block: [[f64; 8]; 8] =
            std::array::from_fn(|y| std::array::from_fn(|x| channel[at(y, x)] - 128.0));
        let mut waves = turned(block, true);
        for (k, row) in waves.iter_mut().enumerate() {
            for (l, wave) in row.iter_mut().enumerate() {
                let step = step * (1.0 + 0.5 * (k + l) as f64);
                *wave = (*wave / step).round() * step;
            }
        }
        let block = turned(waves, false);
        for (y, row) in block.iter().enumerate() {
            for (x, value) in row.iter().enumerate() {
                channel[at(y, x)] = (value + 128.0).round().clamp(0.0, 255.0);
            }
        }
    }
}

/// Pixels of marks that are still there, and pixels away from marks that were painted over.
fn missed_and_wrong(drawn: Drawn, colour: [f64; 3], lossy: Option<f64>) -> [usize; 2] {
    let (cover, cell) = (drawn.cover(), cell());
    let channels = colour.map(|value| {
        let mixed = cell.iter().zip(&cover).map(|(seen, cover)| seen + cover * (value - seen));
        let mut channel: Vec<f64> = mixed.map(f64::round).collect();
        if let Some(step) = lossy {
            compressed(&mut channel, step);
        }
        channel
    });
    let [red, green, blue] = &channels;
    let samples: Vec<u8> = (0..SIDE * SIDE)
        .flat_map(|at| [red[at], green[at], blue[at]])
        .map(|value| value as u8)
        .collect();
    let bytes = png([SIDE as u32; 2], 3, &samples);
    let options = PictureOptions { pixel_size: Some(pixels_of(0.25)), ..PictureOptions::default() };
    let clean = PictureCells::unsegmented(&bytes, &options).unwrap().plane;
    let weights = [0.2126, 0.7152, 0.0722];
    let before = |at: usize| -> f64 {
        if red[at] == green[at] && green[at] == blue[at] {
            return red[at];
        }
        channels.iter().zip(weights).map(|(channel, weight)| weight * channel[at]).sum()
    };
    let changed = |at: &usize| (f64::from(clean.values()[*at]) - before(*at)).abs() > 1e-3;
    let missed = (0..SIDE * SIDE).filter(|&at| cover[at] > 0.5).filter(|at| !changed(at)).count();
    let near = |at: usize| {
        let (column, row) = (at % SIDE, at / SIDE);
        let across = column.saturating_sub(5)..(column + 6).min(SIDE);
        let down = row.saturating_sub(5)..(row + 6).min(SIDE);
        down.into_iter().any(|y| across.clone().any(|x| cover[y * SIDE + x] > 0.0))
    };
    let wrong = (0..SIDE * SIDE).filter(|at| changed(at)).filter(|&at| !near(at)).count();
    [missed, wrong]
}

#[test]
#[ignore = "slow"]
fn marks_of_any_size_stroke_and_colour_are_painted_over_and_nothing_else() {
    let mut sample = Sample::one_in(17);
    let [white, yellow, red, cyan] =
        [[255.0; 3], [255.0, 255.0, 0.0], [255.0, 0.0, 0.0], [0.0, 200.0, 255.0]];
    for (height, half_stroke) in [(16.0, 1.3), (24.0, 2.0), (40.0, 3.5)] {
        for smooth in [false, true] {
            for colour in [white, yellow, red, cyan] {
                for lossy in [None, Some(6.0)] {
                    if sample.leaves_out() {
                        continue;
                    }
                    // Thin letters of one grey value that are smoothed or compressed have few pixels of that value.
                    if colour == white && half_stroke < 2.0 {
                        continue;
                    }
                    let drawn = Drawn { height, half_stroke, smooth };
                    let [missed, wrong] = missed_and_wrong(drawn, colour, lossy);
                    let all = drawn.cover().iter().filter(|&&cover| cover > 0.5).count();
                    let way = format!("{drawn:?}, {colour:?}, {lossy:?}");
                    assert!(missed * 20 <= all, "{way}: {missed} of {all} are still there");
                    // Compression smears colour over its blocks of 8 pixels.
                    assert!(wrong <= 8, "{way}: {wrong} pixels away from marks");
                }
            }
        }
    }
}

#[test]
fn a_colour_picture_of_several_stains_has_no_marks() {
    // The cell in green, round nuclei in blue, both with noise.
    let mut random = Random(3);
    let samples: Vec<u8> = cell()
        .iter()
        .enumerate()
        .flat_map(|(at, &green)| {
            let (x, y) = ((at % SIDE) as f64, (at / SIDE) as f64);
            let nucleus = (-((x % 80.0 - 40.0).powi(2) + (y % 80.0 - 40.0).powi(2)) / 200.0).exp();
            let blue = (200.0 * nucleus + 10.0 + 3.0 * random.normal()).clamp(0.0, 255.0);
            [0, green as u8, blue as u8]
        })
        .collect();
    let bytes = png([SIDE as u32; 2], 3, &samples);
    let options = PictureOptions { pixel_size: Some(pixels_of(0.25)), ..PictureOptions::default() };
    let seen = PictureCells::unsegmented(&bytes, &options).unwrap();
    assert!(seen.notes.iter().all(|note| !note.contains("burned")), "{:?}", seen.notes);
}

#[test]
#[ignore = "slow"]
fn overexposed_stripes_are_no_marks_at_any_pixel_and_orientation() {
    let mut sample = Sample::one_in(11);
    for pixel_um in [0.1, 0.2, 0.3, 0.4, 0.5, 0.65, 0.8, 1.0] {
        for turn_deg in [0.0, 5.0, 20.0, 50.0, 90.0] {
            // Along rows and columns of coarse pixels stripes are as crisp and straight as what is drawn.
            for noise in [0.0, 10.0] {
                if sample.leaves_out() {
                    continue;
                }
                let field_um = 120.0;
                let scene = Scene {
                    pixel_um,
                    turn_deg,
                    noise,
                    blur_um: 0.25,
                    field_um,
                    ..Scene::default()
                };
                let plane = scene.fluorescence().plane;
                // Of a peak of 1000 counts, as eight bits store it.
                for largest in [800.0, 500.0, 380.0, 260.0] {
                    let stored = plane.map(|value| (value.min(largest) / largest * 255.0).round());
                    let painted = burned_in::painted_over(&stored);
                    let way = (pixel_um, turn_deg, noise, largest);
                    assert!(painted.is_none(), "{way:?}: {}", painted.unwrap().note);
                }
            }
        }
    }
}
