//! Where a cell adheres to its gel, from a picture or a table.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use myospring::mechanics::compliance::Compliance;
use myospring::mechanics::gel::GelBed;
use myospring::mechanics::support::SupportKind;
use myospring::recording::Recording;
use myospring::run_file::RunFile;
use myospring::simulation::Simulation;
use std::io;

const SIZE: [u32; 2] = [40, 20];
/// um.
const PIXEL: f64 = 2.5;

/// A picture of 40 x 20 pixels of 2.5 um as a PNG.
fn png(grey: impl Fn(u32, u32) -> u8) -> Vec<u8> {
    let mut bytes = Vec::new();
    let [width, height] = SIZE;
    let mut encoder = png::Encoder::new(&mut bytes, width, height).write_header().unwrap();
    let pixels: Vec<u8> = (0..width * height).map(|at| grey(at % width, at / width)).collect();
    encoder.write_image_data(&pixels).unwrap();
    encoder.finish().unwrap();
    bytes
}

/// A cell of 80 x 30 um on a gel of 10 kPa, with these settings of mechanics, and the bytes of any further file.
fn made(mechanics: &str, file: &[u8]) -> Result<(Simulation, Vec<String>), String> {
    let cell = png(|x, y| if (4..36).contains(&x) && (4..16).contains(&y) { 200 } else { 0 });
    let text = format!(
        "[shape]\npicture = \"cell.png\"\npixel_size = \"2.5 um\"\nspacing = \"5 um\"\n\
         [mechanics]\nsupport = \"gel\"\ngel_modulus = \"10 kPa\"\n{mechanics}"
    );
    let run = RunFile::from_text(&text).unwrap().resolve().unwrap();
    let read = |name: &str| -> io::Result<Vec<u8>> {
        Ok(if name == "cell.png" { cell.clone() } else { file.to_vec() })
    };
    let shaped = run.shape.mesh(&run.shape.bytes(read).unwrap()).unwrap();
    let made = run.make(shaped, read).map_err(|error| error.to_string())?;
    Ok((Simulation { duration: 200.0, ..made.simulation }, made.report.warnings))
}

fn of(mechanics: &str, file: &[u8]) -> Simulation {
    made(mechanics, file).unwrap().0
}

fn beat(simulation: &Simulation) -> Recording {
    let outcome = simulation.build().unwrap().run(|_| true);
    assert!(outcome.stop.is_none(), "{:?}", outcome.stop);
    outcome.recording
}

/// um.
fn shortest(recording: &Recording) -> f64 {
    recording.samples.iter().map(|sample| sample.length_um).fold(f64::INFINITY, f64::min)
}

/// The nodes that adhere.
fn attached(simulation: &Simulation) -> Vec<usize> {
    let SupportKind::Gel(gel) = simulation.support else { panic!("no gel") };
    let Simulation { mesh, long_axis, adhesion, .. } = simulation;
    GelBed::adhering(gel, mesh, *long_axis, adhesion.as_deref()).unwrap().nodes().to_vec()
}

#[test]
fn a_picture_that_is_lit_at_the_ends_is_as_the_ends_and_one_that_is_lit_everywhere_as_everywhere() {
    let ends = of("adhesion = \"ends\"", &[]);
    let x = |node: usize| ends.mesh.point(node)[0];
    let nodes = attached(&ends);
    let (left, right): (Vec<f64>, Vec<f64>) =
        nodes.iter().map(|&node| x(node)).partition(|x| *x < 50.0);
    assert!(nodes.len() > 20 && nodes.len() < ends.mesh.len() / 2);
    let most = left.into_iter().fold(0.0, f64::max);
    let least = right.into_iter().fold(f64::INFINITY, f64::min);
    // The squares around the nodes beside them do not reach these pixels.
    let is_lit = |column: u32| {
        let centre = PIXEL * (f64::from(column) + 0.5);
        centre < most + 0.5 * PIXEL || centre > least - 0.5 * PIXEL
    };
    let lit = png(|x, _| if is_lit(x) { 90 } else { 0 });
    let (lit, warnings) = made("adhesion = \"ends.png\"", &lit).unwrap();
    assert_eq!(attached(&lit), nodes);
    assert!(beat(&lit) == beat(&ends));
    assert!(!warnings.iter().any(|it| it.contains("ends.png")), "{warnings:?}");
    let stiff = "adhesion_stiffness = \"2 kPa/um\"\n";
    for stiffness in ["", stiff] {
        let white = of(&format!("{stiffness}adhesion = \"all.png\""), &png(|_, _| 33));
        assert!(beat(&white) == beat(&of(stiffness, &[])), "{stiffness}");
    }
}

#[test]
fn grey_values_relative_to_the_largest_and_values_of_a_table_are_factors_on_the_stiffness() {
    let stiff = "adhesion_stiffness = \"2 kPa/um\"\n";
    // The left half of the cell adheres half as firmly.
    let halves = png(|x, _| if x < 20 { 60 } else { 120 });
    let by_picture = of(&format!("{stiff}adhesion = \"halves.png\""), &halves);
    let adhesion = by_picture.adhesion.as_ref().unwrap();
    for (node, adhesion) in adhesion.iter().enumerate() {
        let x = by_picture.mesh.point(node)[0];
        let near = (x - 50.0).abs() < 5.0;
        let wanted = if x < 50.0 { 0.5 } else { 1.0 };
        assert!((0.5..=1.0).contains(adhesion) && (near || *adhesion == wanted), "{x}: {adhesion}");
    }
    // Twice the stiffness with half the adhesion is the same, up to the interpolation of either path, 1e-6 of the length.
    let full = beat(&of(stiff, &[]));
    let table = "x_um,y_um,adhesion\n50,25,0.5\n".as_bytes();
    let half = beat(&of("adhesion_stiffness = \"4 kPa/um\"\nadhesion = \"a.csv\"", table));
    for (half, full) in half.samples.iter().zip(&full.samples) {
        assert!((half.length_um - full.length_um).abs() < 2e-6 * 80.0, "{} ms", full.t_ms);
    }
    let firm = beat(&of("adhesion_stiffness = \"4 kPa/um\"\n", &[]));
    assert!(shortest(&firm) > shortest(&full) + 0.01);
    // A row for each node.
    let rows = format!("adhesion\n{}", "1\n".repeat(by_picture.mesh.len()));
    let by_rows = beat(&of(&format!("{stiff}adhesion = \"a.csv\""), rows.as_bytes()));
    assert!(by_rows == full);
}

#[test]
fn what_says_nothing_of_where_the_cell_adheres_is_refused_with_file_and_reason() {
    let mut small = Vec::new();
    let mut encoder = png::Encoder::new(&mut small, 8, 8).write_header().unwrap();
    encoder.write_image_data(&[9; 64]).unwrap();
    encoder.finish().unwrap();
    let outside = png(|x, _| if x < 2 { 200 } else { 0 });
    for (name, bytes, message) in [
        ("a.png", small, "has [8, 8] pixels, the picture of the cell [40, 20]; the adhesion needs"),
        ("a.png", png(|_, _| 0), "`a.png` is black everywhere in the cell"),
        ("a.png", outside, "`a.png` is black everywhere in the cell"),
        ("a.csv", b"x_um,y_um,adhesion\n500,500,1\n".to_vec(), "so none lies in it"),
        ("a.csv", b"x_um,y_um,adhesion\n".to_vec(), "1 to 100000 points"),
        ("a.csv", b"x_um,y_um,adhesion\n50,25,0\n".to_vec(), "in 0 of its"),
        ("a.csv", b"x_um,y_um,adhesion\n50,25,-1\n".to_vec(), "line 2: adhesion is -1"),
        ("a.csv", b"adhesion\n1\n".to_vec(), "nodes: give one for each"),
        (
            "a.csv",
            b"stiffness\n1\n".to_vec(),
            "with one row for each node, or `x_um,y_um,adhesion`",
        ),
    ] {
        let error = made(&format!("adhesion = \"{name}\""), &bytes).err().unwrap();
        assert!(error.contains(name) && error.contains(message), "{message}: {error}");
    }
    // A ground that is nowhere black.
    let grey = png(|x, _| 10 + x as u8);
    let told = |mechanics: &str| made(mechanics, &grey).unwrap().1.join("\n");
    assert!(told("adhesion = \"a.png\"").contains("nowhere black in the cell"));
    let stated = told("adhesion = \"a.png\"\nadhesion_stiffness = \"2 kPa/um\"");
    assert!(!stated.contains("nowhere black"), "{stated}");
}
