//! Pictures of cells that touch or lie across each other, and of single ones that look as though they were two.
#![allow(dead_code, reason = "no user of this file needs all of it")]
#![allow(clippy::unwrap_used, reason = "there is a value for each pixel")]

use std::f64::consts::TAU;

use super::synthetic_cell::{Random, Scene};
use myospring::microscopy::filter::gaussian;
use myospring::microscopy::plane::Plane;

/// The form of a cell; lengths are um.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Form {
    /// A rod with rounded corners.
    Rod { length: f64, width: f64 },
    /// A rod of 100 x 24 um whose ends are half as wide, one up and one down.
    Stepped,
    /// A drop: a broad end and a long tip.
    Drop,
    /// A body with so many arms that taper.
    Star { arms: usize },
    /// A rod of 100 x 26 um that is narrower in the middle, by this part.
    Waisted { by: f64 },
    /// A rod of 100 x 20 um from which an arm branches off.
    Branched,
    /// A rod that bends by 140 deg.
    Bent,
    /// A disc.
    Disc { radius: f64 },
}

/// A cell and where it lies, um and degrees from the middle of the scene, y up.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Body {
    pub(crate) form: Form,
    pub(crate) at: [f64; 2],
    pub(crate) turn_deg: f64,
    /// Brightness, 1 is usual.
    pub(crate) bright: f64,
}

/// How cells look inside.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Look {
    /// Whether there are stripes, 1.9 um apart.
    pub(crate) stripes: bool,
    /// How much of the light a membrane takes, 0.4 um inside the rim of each cell.
    pub(crate) membrane: f64,
    /// How strong columns of myofibrils along the cell are, part of the light.
    pub(crate) columns: f64,
    /// How much light is missing in the nucleus, 0 to 1.
    pub(crate) nucleus: f64,
    /// How much brighter the middle of the cell is than its ends.
    pub(crate) uneven: f64,
    /// Cells that overlap add their light.
    pub(crate) sums: bool,
}

impl Default for Look {
    /// Stripes and membranes that take a third of the light.
    fn default() -> Self {
        Self { stripes: true, membrane: 0.33, columns: 0.3, nucleus: 0.0, uneven: 0.0, sums: false }
    }
}

/// A picture of several cells, and the pixels of each; those of an overlap belong to both.
pub(crate) struct Touching {
    pub(crate) plane: Plane,
    pub(crate) cells: Vec<Vec<bool>>,
}

impl Touching {
    /// The worst of the cells' best Dice's coefficients with any of the parts that were found.
    pub(crate) fn worst_dice(&self, numbers: &[u32]) -> f64 {
        let best = |cell: &Vec<bool>| {
            let most = numbers.iter().copied().max().unwrap_or(0) as usize;
            let (mut both, mut size) = (vec![0_usize; most + 1], vec![0_usize; most + 1]);
            for (&number, &inside) in numbers.iter().zip(cell) {
                size[number as usize] += 1;
                both[number as usize] += usize::from(inside);
            }
            let own = cell.iter().filter(|inside| **inside).count();
            (1..=most)
                .map(|number| 2.0 * both[number] as f64 / (size[number] + own).max(1) as f64)
                .fold(0.0, f64::max)
        };
        self.cells.iter().map(best).fold(1.0, f64::min)
    }
}

/// Places within a cell: how deep, along its fibres and across, um.
struct Place {
    depth: f64,
    along: f64,
    across: f64,
}

fn capsule([x, y]: [f64; 2], from: [f64; 2], to: [f64; 2], radii: [f64; 2]) -> f64 {
    let (u, v) = (to[0] - from[0], to[1] - from[1]);
    let part = (((x - from[0]) * u + (y - from[1]) * v) / (u * u + v * v)).clamp(0.0, 1.0);
    let radius = radii[0] + part * (radii[1] - radii[0]);
    radius - (x - from[0] - part * u).hypot(y - from[1] - part * v)
}

fn rod([x, y]: [f64; 2], length: f64, width: f64) -> f64 {
    let corner = 2.5_f64.min(width / 4.0);
    let (u, v) = (x.abs() - length / 2.0 + corner, y.abs() - width / 2.0 + corner);
    corner - u.max(0.0).hypot(v.max(0.0)) - u.max(v).min(0.0)
}

impl Form {
    fn place(self, [x, y]: [f64; 2]) -> Place {
        let straight = |depth| Place { depth, along: x, across: y };
        match self {
            Self::Rod { length, width } => straight(rod([x, y], length, width)),
            Self::Stepped => straight(
                rod([x, y], 76.0, 24.0).max(rod([x - 40.0, y - 5.5], 22.0, 13.0)).max(rod(
                    [x + 40.0, y + 5.5],
                    22.0,
                    13.0,
                )),
            ),
            Self::Drop => {
                straight(capsule([x, y], [-30.0, 0.0], [10.0, 0.0], [17.0, 7.0]).max(capsule(
                    [x, y],
                    [10.0, 0.0],
                    [50.0, 0.0],
                    [7.0, 3.0],
                )))
            }
            Self::Star { arms } => {
                let arm = |k: usize| {
                    let turn = TAU * (k as f64 + 0.15 * (k as f64 * 2.3).sin()) / arms as f64;
                    let length = 38.0 + 9.0 * (k as f64 * 1.7).cos();
                    let tip = [length * turn.cos(), length * turn.sin()];
                    capsule([x, y], [0.0, 0.0], tip, [11.0, 1.8])
                };
                let depth = (0..arms).map(arm).fold(15.0 - x.hypot(y), f64::max);
                Place { depth, along: x.hypot(y), across: 25.0 * y.atan2(x) }
            }
            Self::Waisted { by } => {
                let half = 13.0 * (1.0 - by * (-(x / 12.0).powi(2)).exp());
                straight((half - y.abs()).min(50.0 - x.abs()))
            }
            Self::Branched => {
                let main = rod([x, y], 100.0, 20.0);
                let (sine, cosine) = 35.0_f64.to_radians().sin_cos();
                let (u, v) = (x * cosine + y * sine, y * cosine - x * sine);
                let arm = rod([u - 28.0, v], 60.0, 13.0);
                if main >= arm { straight(main) } else { Place { depth: arm, along: u, across: v } }
            }
            Self::Bent => {
                let (radius, turn) = (x.hypot(y + 30.0), x.atan2(y + 30.0));
                let depth = (10.0 - (radius - 45.0).abs()).min((1.2 - turn.abs()) * 45.0);
                Place { depth, along: 45.0 * turn, across: radius - 45.0 }
            }
            Self::Disc { radius } => straight(radius - x.hypot(y)),
        }
    }
}

/// A cell in the middle.
pub(crate) fn one(form: Form) -> Vec<Body> {
    vec![Body { form, at: [0.0, 0.0], turn_deg: 0.0, bright: 1.0 }]
}

/// Cells that are one, however they look.
pub(crate) fn singles() -> Vec<(&'static str, Form, Look)> {
    let look = Look::default();
    let rod = Form::Rod { length: 100.0, width: 24.0 };
    vec![
        ("rod", rod, look),
        ("slender rod", Form::Rod { length: 150.0, width: 16.0 }, look),
        ("broad cell", Form::Rod { length: 120.0, width: 45.0 }, look),
        ("rod with strong columns", rod, Look { columns: 0.9, ..look }),
        ("rod without stripes", rod, Look { stripes: false, ..look }),
        ("rod with a dark nucleus", rod, Look { nucleus: 0.7, ..look }),
        ("rod, bright in the middle", rod, Look { uneven: 0.8, ..look }),
        ("rod with stepped ends", Form::Stepped, look),
        ("tear-drop", Form::Drop, look),
        ("star of 3 arms", Form::Star { arms: 3 }, look),
        ("star of 4 arms", Form::Star { arms: 4 }, look),
        ("star of 5 arms", Form::Star { arms: 5 }, look),
        ("star of 6 arms, nucleus", Form::Star { arms: 6 }, Look { nucleus: 0.6, ..look }),
        ("rod with a waist of 80 %", Form::Waisted { by: 0.2 }, look),
        ("rod with a waist of 65 %", Form::Waisted { by: 0.35 }, look),
        ("branched rod", Form::Branched, look),
        ("bent rod", Form::Bent, look),
        ("disc", Form::Disc { radius: 25.0 }, look),
    ]
}

/// Two rods of 100 x 24 um, the second moved and turned.
pub(crate) fn two(at: [f64; 2], turn_deg: f64) -> Vec<Body> {
    let form = Form::Rod { length: 100.0, width: 24.0 };
    let half = at.map(|at| at / 2.0);
    vec![
        Body { form, at: half.map(|at| -at), turn_deg: 0.0, bright: 1.0 },
        Body { form, at: half, turn_deg, bright: 1.0 },
    ]
}

/// Two rods that touch or lie across each other, in all ways.
pub(crate) fn pairs() -> Vec<(&'static str, Vec<Body>, Look)> {
    let look = Look::default();
    let none = Look { membrane: 0.0, ..look };
    let plain = Look { stripes: false, columns: 0.0, ..none };
    let (side, end) = (two([8.0, 24.0], 0.0), two([100.0, 0.0], 0.0));
    let (corner, tee) = (two([38.0, 62.0], 90.0), two([0.0, 62.0], 90.0));
    let mut slim = end.clone();
    slim[1].form = Form::Rod { length: 100.0, width: 15.0 };
    let mut dim = side.clone();
    dim[1].bright = 0.6;
    vec![
        ("side by side, dark line", side.clone(), look),
        ("the same without stripes", side.clone(), Look { stripes: false, ..look }),
        ("the same, line of half the depth", side.clone(), Look { membrane: 0.15, ..look }),
        ("side by side, no line", side, none),
        ("side by side, no line, one 0.6 times as bright", dim, none),
        ("end to end, dark line", end.clone(), look),
        ("end to end, dark line, widths of 24 and 15 um", slim.clone(), look),
        ("end to end, no line", end, none),
        ("end to end, no line, widths of 24 and 15 um", slim, none),
        ("end to end, 15 um aside, no line", two([100.0, 15.0], 0.0), none),
        ("end to end, 8 um aside, no line", two([100.0, 8.0], 0.0), none),
        ("L, dark line", corner.clone(), look),
        ("L, no line", corner.clone(), none),
        ("L, no line, no stripes", corner, plain),
        ("T, dark line", tee.clone(), look),
        ("T, no line", tee.clone(), none),
        ("T, no line, no stripes", tee, plain),
        ("X, one above the other", two([0.0, 0.0], 90.0), look),
        ("X at 50 deg", two([0.0, 0.0], 50.0), look),
        (
            "X at 90 deg, brighter where both are",
            two([0.0, 0.0], 90.0),
            Look { sums: true, ..look },
        ),
        (
            "X at 30 deg, brighter where both are",
            two([0.0, 0.0], 30.0),
            Look { sums: true, ..look },
        ),
    ]
}

impl Look {
    fn value(&self, body: &Body, place: &Place) -> f64 {
        let Place { depth, along, across } = *place;
        // A pixel on the line between two cells lies in both.
        if depth < -1e-6 {
            return 0.0;
        }
        // Stripes of one cell go on in no other.
        let phase = 0.37 * body.at[0] + 1.3 * body.at[1];
        let wave = along + 0.4 * (across / 3.0).sin() + phase;
        let stripes = if self.stripes { 0.5 + 0.5 * (TAU * wave / 1.9).cos() } else { 0.6 };
        let column = (TAU * across / 2.6).cos() + 0.6 * (TAU * (across + phase) / 7.3).cos();
        let rows = 1.0 - self.columns * (0.5 - 0.5 * column / 1.6);
        let uneven = 1.0 + self.uneven * ((-(along / 25.0).powi(2)).exp() - 0.5);
        let nucleus = (along / 9.0).powi(2) + (across / 4.0).powi(2);
        let nucleus = 1.0 - self.nucleus * f64::from(u8::from(nucleus < 1.0));
        let membrane = 1.0 - self.membrane * (-((depth - 0.2) / 0.45).powi(2)).exp();
        body.bright * (0.25 + 0.75 * stripes * rows) * uneven * nucleus * membrane
    }

    /// The bright cells on a dark ground.
    pub(crate) fn fluorescence(&self, scene: &Scene, bodies: &[Body]) -> Touching {
        let bright = 1000.0 * scene.contrast;
        picture(scene, bodies, 100.0, |places| {
            let mut light = 0.0_f64;
            for (body, place) in bodies.iter().zip(places) {
                let own = self.value(body, place);
                light = if self.sums {
                    light + own
                } else if own > 0.0 {
                    own
                } else {
                    light
                };
            }
            bright * light
        })
    }
}

/// The cells as grey as their background, each with a dark rim, with a bright halo around all and with grains.
pub(crate) fn brightfield(scene: &Scene, bodies: &[Body]) -> Touching {
    picture(scene, bodies, 0.0, |places| {
        let rim = |depth: f64| -(-((depth - 0.8) / 0.7).powi(2)).exp();
        let top = places.iter().rev().find(|place| place.depth > 0.0);
        let change = if let Some(Place { depth, along, across }) = top {
            let wave = (across / 0.7 + (along / 2.3).sin()).cos();
            rim(*depth) + if *depth > 1.5 { 0.35 * (along / 0.9).sin() * wave } else { 0.0 }
        } else {
            let depth = places.iter().map(|place| place.depth).fold(f64::MIN, f64::max);
            rim(depth) + 0.6 * (-((depth + 1.0) / 0.8).powi(2)).exp()
        };
        1000.0 * (1.0 + scene.contrast * change)
    })
}

/// Cells by what their pixels are in each of them, above a background, lit, blurred and noisy.
fn picture(
    scene: &Scene,
    bodies: &[Body],
    background: f64,
    value: impl Fn(&[Place]) -> f64,
) -> Touching {
    let turned = |[x, y]: [f64; 2], deg: f64| {
        let (sine, cosine) = deg.to_radians().sin_cos();
        [x * cosine + y * sine, y * cosine - x * sine]
    };
    let side = (scene.field_um / scene.pixel_um).round() as usize;
    let mut cells = vec![vec![false; side * side]; bodies.len()];
    let mut values = Vec::with_capacity(side * side);
    for at in 0..side * side {
        let x = ((at % side) as f64 + 0.5) * scene.pixel_um - scene.field_um / 2.0;
        let y = scene.field_um / 2.0 - ((at / side) as f64 + 0.5) * scene.pixel_um;
        let [x, y] = turned([x, y], scene.turn_deg);
        let place =
            |body: &Body| body.form.place(turned([x - body.at[0], y - body.at[1]], body.turn_deg));
        let places: Vec<Place> = bodies.iter().map(place).collect();
        for (cell, place) in cells.iter_mut().zip(&places) {
            cell[at] = place.depth > 0.0;
        }
        values.push(value(&places) as f32);
    }
    let mut random = Random(scene.seed);
    let plane = Plane::new(side, side, values).unwrap();
    let blurred = gaussian(&plane, scene.blur_um / scene.pixel_um);
    let noisy = blurred.values().iter().enumerate().map(|(at, &value)| {
        let lit = background + f64::from(value) * scene.light(at % side, at / side);
        (lit + scene.noise * random.normal()).clamp(0.0, 65535.0).round() as f32
    });
    let plane = Plane::new(side, side, noisy.collect()).unwrap();
    Touching { plane, cells }
}
