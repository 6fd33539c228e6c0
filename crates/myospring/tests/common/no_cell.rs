//! Pictures without a single whole heart cell: marks, posts, sheets, panels of a figure.
#![allow(dead_code, reason = "no user of this file needs all of it")]

use std::f64::consts::TAU;

use super::synthetic_cell::Random;
use myospring::microscopy::filter;
use myospring::microscopy::plane::Plane;

/// What a picture without a cell shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Object {
    /// A scale bar with letters.
    Caption,
    /// A round thing without texture.
    Post,
    /// A straight-edged thing without texture.
    Block,
    /// A confluent sheet with stripes, brighter in one place.
    Sheet,
    /// A panel of a figure, full of stripes.
    Panel,
}

impl Object {
    pub(crate) const ALL: [Self; 5] =
        [Self::Caption, Self::Post, Self::Block, Self::Sheet, Self::Panel];
}

/// How it was taken.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Taken {
    pub(crate) pixel_um: f64,
    /// Brightness above the background, counts.
    pub(crate) bright: f64,
    /// Standard deviation of the noise, counts.
    pub(crate) noise: f64,
    /// Largest value that can be stored.
    pub(crate) largest: f64,
    pub(crate) seed: u64,
}

/// Strokes of the letters: x and y of both ends, in heights of a letter; the first number is the letter's place.
const STROKES: [[f64; 5]; 12] = [
    // "H E L 1"
    [0.0, 0.0, 0.0, 0.0, 1.0],
    [0.0, 0.6, 0.0, 0.6, 1.0],
    [0.0, 0.0, 0.5, 0.6, 0.5],
    [1.0, 0.0, 0.0, 0.0, 1.0],
    [1.0, 0.0, 0.0, 0.6, 0.0],
    [1.0, 0.0, 0.5, 0.5, 0.5],
    [1.0, 0.0, 1.0, 0.6, 1.0],
    [2.0, 0.0, 0.0, 0.0, 1.0],
    [2.0, 0.0, 1.0, 0.6, 1.0],
    [3.0, 0.3, 0.0, 0.3, 1.0],
    [3.0, 0.1, 1.0, 0.5, 1.0],
    [3.0, 0.1, 0.2, 0.3, 0.0],
];

/// Distance of a place from a stroke.
fn from_stroke([x, y]: [f64; 2], [x0, y0, x1, y1]: [f64; 4]) -> f64 {
    let (along, down) = (x1 - x0, y1 - y0);
    let part = ((x - x0) * along + (y - y0) * down) / (along * along + down * down);
    let part = part.clamp(0.0, 1.0);
    (x - x0 - part * along).hypot(y - y0 - part * down)
}

/// Distances of a place from the strokes of the letters, in heights of a letter.
pub(crate) fn letters([x, y]: [f64; 2]) -> [f64; 12] {
    STROKES.map(|[place, x0, y0, x1, y1]| from_stroke([x - place, y], [x0, y0, x1, y1]))
}

/// A field of view of 120 um.
pub(crate) fn picture(object: Object, taken: Taken) -> Plane {
    let Taken { pixel_um, bright, noise, largest, seed } = taken;
    let side = (120.0 / pixel_um).round() as usize;
    let mut random = Random(seed);
    // z-discs in fibres whose direction varies from place to place.
    let stripes = |x: f64, y: f64| {
        let along = x + 6.0 * (y / 25.0).sin();
        let stripes = 0.5 + 0.5 * (TAU * along / 1.9).cos();
        let rows = 0.6 + 0.4 * (TAU * y / 2.6).cos();
        0.15 + 0.85 * stripes * rows
    };
    let value = |x: f64, y: f64| match object {
        Object::Caption => 0.05 * stripes(x, y),
        Object::Post => f64::from(u8::from((x - 60.0).hypot(y - 55.0) < 20.0)),
        Object::Block => f64::from(u8::from((x + y - 120.0).abs() < 60.0 && (x - y).abs() < 25.0)),
        Object::Sheet => {
            let patch = (-((x - 50.0) / 25.0).powi(2) - ((y - 70.0) / 18.0).powi(2)).exp();
            (0.45 + 0.55 * patch) * stripes(x, y)
        }
        Object::Panel => {
            let within = (20.0..90.0).contains(&x) && (30.0..100.0).contains(&y);
            if within { stripes(x, y) } else { 0.0 }
        }
    };
    let centre = |at: usize| (at as f64 + 0.5) * pixel_um;
    let values = (0..side * side).map(|at| value(centre(at % side), centre(at / side)) as f32);
    let plane = Plane::new(side, side, values.collect()).unwrap();
    // What is drawn by a program is not blurred by a lens.
    let lens = if object == Object::Panel { 0.0 } else { 0.3 };
    let blurred = filter::gaussian(&plane, lens / pixel_um);
    let mut values: Vec<f32> = blurred
        .values()
        .iter()
        .map(|&value| {
            let light = 0.04 * largest + bright * f64::from(value);
            (light + noise * random.normal()).clamp(0.0, largest).round() as f32
        })
        .collect();
    if object == Object::Caption {
        let height = side as f64 / 10.0;
        let drawn = |x: f64, y: f64| {
            let at = [(x - 0.5 * side as f64) / height, (y - 0.85 * side as f64) / height];
            let letters = letters(at).iter().any(|&off| off < 0.09);
            let bar =
                (0.5..0.9).contains(&(x / side as f64)) && (0.8..0.82).contains(&(y / side as f64));
            letters || bar
        };
        for (at, value) in values.iter_mut().enumerate() {
            if drawn((at % side) as f64, (at / side) as f64) {
                *value = largest as f32;
            }
        }
    }
    Plane::new(side, side, values).unwrap()
}

/// A straight-edged thing without texture, turned, `size_um` long, in noise (counts) like that of a camera: it grows
/// with the light. Its light is 400 counts above a background of 100.
pub(crate) fn uniform_block(size_um: f64, pixel_um: f64, noise: f64, lens_um: f64) -> Plane {
    let side = ((3.0 * size_um).max(60.0) / pixel_um).round() as usize;
    let place = |at: usize| (at as f64 + 0.5 - 0.5 * side as f64) * pixel_um / size_um;
    let inside = (0..side * side).map(|at| {
        let (x, y) = (place(at % side), place(at / side));
        let (along, across) = (0.9 * x + 0.436 * y, 0.9 * y - 0.436 * x);
        if along.abs() < 0.5 && across.abs() < 0.3 { 1.0 } else { 0.0 }
    });
    let plane = Plane::new(side, side, inside.collect()).unwrap();
    let mut random = Random(7);
    let blurred = filter::gaussian(&plane, lens_um / pixel_um);
    let seen = blurred.values().iter().map(|&light| {
        let light = f64::from(light);
        let grain = noise * (0.3 + 0.7 * light).sqrt() * random.normal();
        (100.0 + 400.0 * light + grain).clamp(0.0, 65535.0).round() as f32
    });
    Plane::new(side, side, seen.collect()).unwrap()
}
