//! Where the direction of the fibres and the length of sarcomeres hold and where they do not: made-up rods whose
//! columns of myofibrils are stronger than their stripes, at all angles, over contrast, noise, blur and pixel
//! size; pictures without stripes; and real pictures, where `MYOSPRING_SHARED_DATA` names their folder. Prints the
//! tables of docs/reference/accuracy.md.
//!
//! `cargo run --release -p myospring-verification --example fibre_robustness [FOLDER]` with a folder writes there what was read
//! of each real picture, as CSV.
#![allow(clippy::print_stdout, reason = "a program")]
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "an example")]

use std::error::Error;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

use myospring::mesh::pixel_size::PixelSize;
use myospring::microscopy::fibres::{Fibre, FibreField, FibreSettings, Stain, fibres};
use myospring::microscopy::picture::Selection;
use myospring::microscopy::plane::Plane;
use myospring::microscopy::read::read_picture;

/// Angles of the rods, degrees; each is another cell.
const ANGLES: [f64; 7] = [0.0, 26.0, 52.0, 78.0, 104.0, 130.0, 156.0];

/// A rod-shaped cell with columns of myofibrils along it and stripes across them.
#[derive(Clone, Copy)]
struct Rod {
    pixel_um: f64,
    length_um: f64,
    width_um: f64,
    sarcomere_um: f64,
    /// Heights of stripes and columns, and the standard deviation of the noise of a pixel.
    stripes: f64,
    columns: f64,
    noise: f64,
    /// Standard deviation of the blur, um.
    blur_um: f64,
    /// Steps from column to column by which stripes are out of line, of a period.
    disorder: f64,
    nuclei: bool,
    rim: f64,
    /// Bright spots in the cell.
    spots: usize,
}

/// Stripes of height 1, columns three times as high, noise of a quarter.
const ROD: Rod = Rod {
    pixel_um: 0.15,
    length_um: 90.0,
    width_um: 22.0,
    sarcomere_um: 1.85,
    stripes: 1.0,
    columns: 3.0,
    noise: 0.25,
    blur_um: 0.15,
    disorder: 0.1,
    nuclei: true,
    rim: 2.0,
    spots: 0,
};

/// Random numbers, always the same for a seed (xorshift).
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Mean 0, standard deviation 1 (a sum of uniform numbers).
    fn normal(&mut self) -> f64 {
        ((0..4).map(|_| self.uniform()).sum::<f64>() - 2.0) * 3.0_f64.sqrt()
    }

    /// A curve over a length that wanders with a standard deviation of 1 over `scale_um`.
    fn wander(&mut self, scale_um: f64) -> impl Fn(f64) -> f64 + use<> {
        let waves: Vec<[f64; 3]> = (0..6)
            .map(|_| {
                let wave = self.normal() / scale_um;
                [wave, TAU * self.uniform(), (2.0_f64 / 6.0).sqrt()]
            })
            .collect();
        move |x| waves.iter().map(|[k, phase, height]| height * (k * x + phase).cos()).sum()
    }
}

/// A picture with what is true of it.
struct Scene {
    plane: Plane,
    inside: Vec<bool>,
    /// Within the cell, not in a nucleus.
    striped: Vec<bool>,
}

fn gauss(x: f64) -> f64 {
    (-0.5 * x * x).exp()
}

/// A column of myofibrils.
struct Bundle {
    /// Across the rod, um.
    place: f64,
    /// How it wanders.
    own: Box<dyn Fn(f64) -> f64>,
    height: f64,
    /// Its height along the rod.
    swell: Box<dyn Fn(f64) -> f64>,
    /// Of its stripes, and how that drifts along the rod.
    phase: f64,
    drift: Box<dyn Fn(f64) -> f64>,
}

impl Rod {
    fn bundles(&self, random: &mut Random) -> Vec<Bundle> {
        let mut bundles = Vec::new();
        let (mut place, mut phase) = (-0.5 * self.width_um - 2.0, 0.0);
        while place < 0.5 * self.width_um + 2.0 {
            phase += self.disorder * random.normal();
            let height = (0.4 * random.normal()).exp();
            bundles.push(Bundle {
                place,
                own: Box::new(random.wander(6.0)),
                height,
                swell: Box::new(random.wander(5.0)),
                phase,
                drift: Box::new(random.wander(4.0)),
            });
            place += 1.0 + 0.5 * random.uniform();
        }
        bundles
    }

    /// The picture of a rod that lies at an angle, degrees counter-clockwise.
    fn scene(&self, angle_deg: f64, seed: u64) -> Scene {
        let mut random =
            Random(0x9e37_79b9_7f4a_7c15 ^ (seed + 1).wrapping_mul(0x2545_f491_4f6c_dd1d));
        for _ in 0..10 {
            random.uniform();
        }
        let (sin, cos) = angle_deg.to_radians().sin_cos();
        let (length, width) = (self.length_um, self.width_um);
        let side = |a: f64, b: f64| {
            (((a * length).abs() + (b * width).abs() + 8.0) / self.pixel_um) as usize
        };
        let [columns, rows] = [side(cos, sin), side(sin, cos)];
        let common = random.wander(10.0);
        let bundles = self.bundles(&mut random);
        let waist = TAU * random.uniform();
        let nuclei: [[f64; 2]; 2] =
            [-1.0, 1.0].map(|x| [x * length / 9.0, 4.0 * random.uniform() - 2.0]);
        let spots: Vec<[f64; 2]> = (0..self.spots)
            .map(|_| [length * (random.uniform() - 0.5), width * (random.uniform() - 0.5)])
            .collect();
        let mut scene = (Vec::new(), Vec::new(), Vec::new());
        for row in 0..rows {
            for column in 0..columns {
                let x = (column as f64 + 0.5 - 0.5 * columns as f64) * self.pixel_um;
                let y = -(row as f64 + 0.5 - 0.5 * rows as f64) * self.pixel_um;
                let (u, v) = (cos * x + sin * y, cos * y - sin * x);
                let half = 0.5 * width * (1.0 - 0.15 * (8.0 * u / length + waist).sin().powi(2));
                let depth = (half - v.abs()).min(0.5 * length - u.abs());
                let inside = depth > 0.0;
                let nucleus = nuclei.map(|[a, b]| ((u - a) / 7.0).hypot((v - b) / 4.0));
                let nucleus = if self.nuclei { nucleus[0].min(nucleus[1]) } else { 9.0 };
                let mut grey = 0.05;
                if inside {
                    let (mut bundle, mut phase, mut weight) = (0.0, 0.0, 1e-9);
                    for Bundle { place, own, height, swell, phase: step, drift } in &bundles {
                        if (v - place).abs() < 3.0 {
                            let off = v - place - 0.25 * own(u) - 0.3 * common(u);
                            bundle += height * (0.35 * swell(u)).exp() * gauss(off / 0.33);
                            let near = gauss(off / 0.6);
                            phase += near * (step + self.disorder * drift(u));
                            weight += near;
                        }
                    }
                    let stripe = (1.5
                        * ((TAU * (u / self.sarcomere_um + phase / weight)).cos() - 1.0))
                        .exp();
                    grey = 0.5
                        + self.columns * 0.5 * bundle
                        + self.stripes * stripe * (0.6 + 0.4 * bundle.min(1.5));
                    if nucleus < 1.0 {
                        grey = 0.6;
                    }
                    grey += 1.5 * gauss((nucleus - 1.0) * 5.0 / 0.4);
                    grey += self.rim * gauss((depth - 0.3) / 0.35);
                    for [a, b] in &spots {
                        grey += 4.0 * gauss((u - a) / 0.3) * gauss((v - b) / 0.3);
                    }
                    grey *= 0.75 + 0.25 * (x / 17.0 + 1.0).sin() * (y / 13.0).cos();
                }
                scene.0.push(grey);
                scene.1.push(inside);
                scene.2.push(inside && nucleus > 1.0);
            }
        }
        let (grey, inside, striped) = scene;
        let grey = blurred(&grey, columns, self.blur_um / self.pixel_um);
        let values =
            grey.iter().map(|grey| (1000.0 * (grey + self.noise * random.normal())) as f32);
        Scene { plane: Plane::new(columns, rows, values.collect()).unwrap(), inside, striped }
    }
}

/// A Gaussian along rows, then along columns; the rim is continued outward.
fn blurred(values: &[f64], columns: usize, sigma: f64) -> Vec<f64> {
    let reach = (3.0 * sigma).ceil() as i64;
    let weights: Vec<f64> = (-reach..=reach).map(|at| gauss(at as f64 / sigma)).collect();
    let sum: f64 = weights.iter().sum();
    let reach = reach.cast_unsigned() as usize;
    let pass = |values: &[f64], [wide, step]: [usize; 2]| -> Vec<f64> {
        let mean = |at: usize| {
            let place = at / step % wide;
            let first = at - place * step;
            let term = |(off, weight): (usize, &f64)| {
                weight * values[first + (place + off).saturating_sub(reach).min(wide - 1) * step]
            };
            weights.iter().enumerate().map(term).sum::<f64>() / sum
        };
        (0..values.len()).map(mean).collect()
    };
    let rows = values.len() / columns;
    pass(&pass(values, [columns, 1]), [rows, columns])
}

/// Angle between two lines, degrees, 0 to 90.
fn apart(a_deg: f64, b_deg: f64) -> f64 {
    let turn = (a_deg - b_deg).rem_euclid(180.0);
    turn.min(180.0 - turn)
}

/// The structure tensor of the raw picture, as it was used for stripes before: across the threads it sees.
fn structure_tensor() -> FibreSettings {
    FibreSettings {
        gradient_scale_um: 0.3,
        background_scale_um: 1.2,
        rim_um: 1.5,
        ..FibreSettings::of(Stain::Filament)
    }
}

/// What was read over several pictures.
#[derive(Default)]
struct Tally {
    places: usize,
    answered: usize,
    errors: Vec<f64>,
    lengths: Vec<f64>,
    /// Places of nuclei, and how many of them answered.
    blank: [usize; 2],
}

impl Tally {
    fn add(&mut self, rod: &Rod, scene: &Scene, field: &FibreField, angle_deg: f64) {
        let (columns, rows) = (scene.plane.width(), scene.plane.height());
        for (point, fibre) in field.on_grid(1.0) {
            let column = ((point[0] / rod.pixel_um) as usize).min(columns - 1);
            let row = rows - 1 - ((point[1] / rod.pixel_um) as usize).min(rows - 1);
            let at = row * columns + column;
            if !scene.inside[at] {
                continue;
            }
            if !scene.striped[at] {
                self.blank[0] += 1;
                self.blank[1] += usize::from(fibre.from_picture);
                continue;
            }
            self.places += 1;
            if fibre.from_picture {
                self.answered += 1;
                self.errors.push(apart(fibre.angle_deg(), angle_deg));
                self.lengths.extend(fibre.sarcomere_um);
            }
        }
    }

    fn far(&self, degrees: f64) -> f64 {
        let far = self.errors.iter().filter(|&&error| error > degrees).count();
        100.0 * far as f64 / self.errors.len().max(1) as f64
    }
}

fn median(values: &[f64]) -> f64 {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

fn read(scene: &Scene, pixel_um: f64, axis_deg: f64, settings: &FibreSettings) -> FibreField {
    let (sin, cos) = axis_deg.to_radians().sin_cos();
    let pixel = PixelSize::new(pixel_um).unwrap();
    fibres(&scene.plane, &scene.inside, pixel, [cos, sin], settings).unwrap()
}

/// One row: the period of the stripes, beside the structure tensor in brackets.
fn row(name: &str, rod: &Rod) {
    let (mut stripes, mut tensor) = (Tally::default(), Tally::default());
    let mut seconds = Vec::new();
    let mut warned = 0;
    for (seed, angle) in ANGLES.into_iter().enumerate() {
        let scene = rod.scene(angle, seed as u64);
        let start = Instant::now();
        // The long axis lies wrong on purpose: it must not help.
        let field = read(&scene, rod.pixel_um, angle + 90.0, &FibreSettings::of(Stain::ZDisc));
        seconds.push(start.elapsed().as_secs_f64());
        stripes.add(rod, &scene, &field, angle);
        warned += usize::from(field.misfit().is_some());
        let field = read(&scene, rod.pixel_um, angle, &structure_tensor());
        // What lies across the threads that it sees.
        tensor.add(rod, &scene, &field, angle + 90.0);
    }
    let share = |tally: &Tally| 100.0 * tally.answered as f64 / tally.places.max(1) as f64;
    let blank = |tally: &Tally| 100.0 * tally.blank[1] as f64 / tally.blank[0].max(1) as f64;
    println!(
        "| {name} | {:.0} ({:.0}) | {:.1} ({:.1}) | {:.1} ({:.1}) | {:.0} ({:.0}) | {:.3} | {warned} | {:.2} s |",
        share(&stripes),
        share(&tensor),
        median(&stripes.errors),
        median(&tensor.errors),
        stripes.far(30.0),
        tensor.far(30.0),
        blank(&stripes),
        blank(&tensor),
        median(&stripes.lengths),
        median(&seconds),
    );
}

const HEAD: &str = "| picture | read, % | median error, deg | off by more than 30 deg, % | read in nuclei, % | \
sarcomere, um | misfits of 7 | time |\n|---|---|---|---|---|---|---|---|";

fn rods() {
    println!("Rods of 90 x 22 um; in brackets the structure tensor.\n\n{HEAD}");
    let rod = ROD;
    for columns in [0.0, 1.0, 3.0, 6.0, 10.0] {
        row(&format!("columns {columns} times the stripes"), &Rod { columns, ..rod });
    }
    for pixel_um in [0.08, 0.1, 0.2, 0.3, 0.4] {
        row(&format!("pixels of {pixel_um} um"), &Rod { pixel_um, ..rod });
    }
    let hard = Rod { columns: 10.0, ..rod };
    for pixel_um in [0.08, 0.3, 0.4] {
        row(&format!("columns 10 times, pixels of {pixel_um} um"), &Rod { pixel_um, ..hard });
    }
    for noise in [0.5, 1.0, 2.0] {
        row(&format!("noise of {noise}"), &Rod { noise, ..rod });
        row(&format!("columns 10 times, noise of {noise}"), &Rod { noise, ..hard });
    }
    for blur_um in [0.25, 0.35, 0.5] {
        row(&format!("columns 10 times, blur of {blur_um} um"), &Rod { blur_um, ..hard });
    }
    for disorder in [0.2, 0.3] {
        row(&format!("stripes out of line by {disorder}"), &Rod { disorder, ..rod });
        row(&format!("columns 10 times, out of line by {disorder}"), &Rod { disorder, ..hard });
    }
    for sarcomere_um in [1.5, 1.65, 2.1, 2.4] {
        row(&format!("sarcomeres of {sarcomere_um} um"), &Rod { sarcomere_um, ..rod });
    }
    row("50 x 12 um, one nucleus wide", &Rod { length_um: 50.0, width_um: 12.0, ..rod });
    row("300 bright spots", &Rod { spots: 300, ..rod });
    println!("\nNo stripes.\n\n{HEAD}");
    let none = Rod { stripes: 0.0, ..rod };
    let plain = Rod { columns: 0.0, nuclei: false, rim: 0.0, ..none };
    row("noise alone", &plain);
    row("a bright rim alone", &Rod { rim: 4.0, ..plain });
    row("nuclei and rim", &Rod { columns: 0.0, ..none });
    for columns in [1.0, 3.0, 10.0] {
        row(&format!("columns {columns}, no stripes"), &Rod { columns, ..none });
    }
    row("columns 10, pixels of 0.3 um", &Rod { columns: 10.0, pixel_um: 0.3, ..none });
    row("100 bright spots", &Rod { spots: 100, ..plain });
    row("800 bright spots", &Rod { spots: 800, ..plain });
    println!("\nA wrong pixel size: stripes of another distance.\n\n{HEAD}");
    for sarcomere_um in [0.9, 1.09, 1.3, 2.8, 3.7] {
        row(
            &format!("stripes {sarcomere_um} um apart"),
            &Rod { sarcomere_um, disorder: 0.05, ..rod },
        );
    }
}

/// Picture, mask if there is one, side of a pixel in um.
const REAL: [(&str, &str, f64); 6] = [
    ("sarcgraph_e5_fluorescence.png", "sarcgraph_e5_mask.png", 0.27),
    ("sarcgraph_e2_rest.png", "sarcgraph_e2_mask.png", 0.18),
    ("sarcgraph_e1_rest.png", "", 0.18),
    ("sarcgraph_sample_5.png", "", 0.18),
    ("morphoscript_test3.tif", "morphoscript_test3_mask.png", 1.0 / 16.068_993),
    ("contrax_brightfield.tif", "contrax_brightfield_mask.png", 0.27),
];

fn real(images: &Path, output: Option<&Path>) -> Result<(), Box<dyn Error>> {
    println!(
        "\nReal and made-up pictures; in brackets the structure tensor.\n\n| picture | read, % | sarcomere: median \
         (quartiles), um | mean order | time |\n|---|---|---|---|---|"
    );
    for (name, mask, pixel_um) in REAL {
        let plane = |file: &str| -> Result<Plane, Box<dyn Error>> {
            Ok(read_picture(&std::fs::read(images.join(file))?, &Selection::default())?.plane)
        };
        let picture = plane(name)?;
        let inside = if mask.is_empty() {
            vec![true; picture.values().len()]
        } else {
            plane(mask)?.values().iter().map(|&value| value > 0.0).collect()
        };
        let pixel = PixelSize::new(pixel_um)?;
        let start = Instant::now();
        let field = fibres(&picture, &inside, pixel, [1.0, 0.0], &FibreSettings::of(Stain::ZDisc))?;
        let seconds = start.elapsed().as_secs_f64();
        let tensor = fibres(&picture, &inside, pixel, [1.0, 0.0], &structure_tensor())?.summary();
        let summary = field.summary();
        let [first, third] = summary.sarcomere_quartiles_um.unwrap_or([f64::NAN; 2]);
        println!(
            "| {name} | {:.0} ({:.0}) | {:.2} ({first:.2} to {third:.2}) | {:.2} | {seconds:.2} s |",
            100.0 * summary.share_from_picture,
            100.0 * tensor.share_from_picture,
            summary.median_sarcomere_um.unwrap_or(f64::NAN),
            summary.mean_order,
        );
        for warning in field.warnings() {
            println!("<!-- {warning} -->");
        }
        if let Some(output) = output {
            let mut table =
                "x_um,y_um,angle_deg,from_picture,sarcomere_um,order,coverage\n".to_owned();
            for (point, fibre) in field.on_grid(2.0) {
                let [x, y] = point;
                let Fibre { from_picture, sarcomere_um, order, coverage, .. } = fibre;
                let sarcomere = sarcomere_um.map(|um| um.to_string()).unwrap_or_default();
                let angle = fibre.angle_deg();
                writeln!(table, "{x},{y},{angle},{from_picture},{sarcomere},{order},{coverage}")?;
            }
            std::fs::write(output.join(name).with_extension("csv"), table)?;
        }
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let output = std::env::args_os().nth(1).map(PathBuf::from);
    rods();
    if let Some(data) = std::env::var_os("MYOSPRING_SHARED_DATA") {
        return real(&Path::new(&data).join("images"), output.as_deref());
    }
    println!("\nSKIPPED: MYOSPRING_SHARED_DATA does not name the folder of the real pictures");
    Ok(())
}
