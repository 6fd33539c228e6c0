//! Draws every figure of a made-up beat: `cargo run --example figures -- FOLDER`.

use std::path::{Path, PathBuf};

use myospring::mesh::pixel_size::PixelSize;
use myospring::output::field::Fields;
use myospring::output::figure::{
    Contour, ContractionOptions, DrawnCell, Figure, Overlay, Tick, action_potential_and_tension,
    cell_shapes, contraction, key_shapes, mesh, overlay, overview,
};
use myospring::output::files;

#[path = "../tests/output/synthetic.rs"]
mod synthetic;

type Outcome = Result<(), Box<dyn std::error::Error>>;

fn save(folder: &Path, name: &str, figure: &Figure, dpi: f64) -> Outcome {
    files::write(&folder.join(format!("{name}.svg")), figure.to_svg())?;
    files::write(&folder.join(format!("{name}.png")), figure.to_png(dpi)?)?;
    Ok(())
}

fn main() -> Outcome {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "figures".to_owned()));
    files::create_folder(&folder)?;
    let stimuli = [synthetic::STIMULUS];

    let long = synthetic::elongated(1.0);
    let along = vec![[1.0, 0.0]; long.simplices.len()];
    let beats = [30.0, 40.0, 50.0].map(|kpa| synthetic::recording(&long, along[0], kpa, false));
    let strongest = &beats[2];
    save(&folder, "action-potential", &action_potential_and_tension(strongest, &stimuli)?, 300.0)?;
    let cell = DrawnCell::new(Fields::new(&long, &along, None)?, None)?;
    save(&folder, "cell", &cell_shapes(&cell, &key_shapes(strongest, &stimuli))?, 300.0)?;
    let curves = [("30 kPa", &beats[0]), ("40 kPa", &beats[1]), ("50 kPa", &beats[2])];
    let plain = ContractionOptions::default();
    save(&folder, "contraction", &contraction(&curves, &plain)?, 300.0)?;
    let band = ContractionOptions {
        stimulus_times_ms: stimuli.to_vec(),
        reference_band: Some(([7.0, 12.0], "adult ventricular myocytes, unloaded")),
    };
    save(&folder, "contraction-band", &contraction(&curves, &band)?, 300.0)?;
    save(&folder, "mesh", &mesh(&synthetic::elongated(2.0))?, 300.0)?;
    save(&folder, "overview", &overview(&cell, strongest, &stimuli)?, 200.0)?;

    let (round, axis) = synthetic::roundish(2.0);
    let along = vec![axis; round.simplices.len()];
    let cell = DrawnCell::new(Fields::new(&round, &along, None)?, None)?;
    let beat = synthetic::recording(&round, axis, 50.0, true);
    let potential = action_potential_and_tension(&beat, &stimuli)?;
    save(&folder, "action-potential-mv", &potential, 300.0)?;
    save(&folder, "cell-round", &cell_shapes(&cell, &key_shapes(&beat, &stimuli))?, 300.0)?;
    save(&folder, "mesh-round", &mesh(&round)?, 300.0)?;
    save(&folder, "overview-round", &overview(&cell, &beat, &stimuli)?, 200.0)?;
    save(&folder, "overlay", &striped_picture()?, 200.0)?;
    Ok(())
}

/// A round cell with stripes across its fibres, which turn, and a smaller one beside it.
fn striped_picture() -> Result<Figure, Box<dyn std::error::Error>> {
    let (columns, rows, pixel) = (600, 440, 0.25);
    let centre = [68.0, 55.0];
    let (mut mesh, _) = synthetic::roundish(2.0);
    for (axis, points) in mesh.points.iter_mut().enumerate() {
        for x in points {
            *x += centre[axis];
        }
    }
    let (sin, cos) = 25f64.to_radians().sin_cos();
    // As `synthetic::roundish` has it.
    let bulge = |a: f64, b: f64| 1.0 + 0.05 * (3.0 * b.atan2(a)).cos();
    let ring = |centre: [f64; 2], half: [f64; 2]| -> Vec<[f64; 2]> {
        let point = |k: i32| {
            let (b, a) = f64::from(k).to_radians().sin_cos();
            let [a, b] = [half[0] * a, half[1] * b];
            let [a, b] = [a, b].map(|x| x * bulge(a, b));
            [centre[0] + cos * a - sin * b, centre[1] + sin * a + cos * b]
        };
        (0..360).map(point).collect()
    };
    let within = |[x, y]: [f64; 2], half: [f64; 2]| {
        let (a, b) = (cos * x + sin * y, cos * y - sin * x);
        (a / half[0]).hypot(b / half[1]) < bulge(a, b)
    };
    // Rings around a point far below: fibres run along them, z-discs across.
    let angle = |[x, y]: [f64; 2]| (y + 90.0).atan2(x - 110.0);
    let grey = |at: usize| {
        let point = [(at % columns) as f64 * pixel, (rows - at / columns) as f64 * pixel];
        let from = [point[0] - centre[0], point[1] - centre[1]];
        let other = within([point[0] - 136.0, point[1] - 22.0], [13.0, 7.0]);
        let stripes = 0.15 * (440.0 * angle(point)).cos();
        let cell = if from[0] < 20.0 { 0.3 + stripes } else { 0.3 };
        (if within(from, [57.0, 34.0]) || other { cell } else { 0.05 }) as f32
    };
    let values: Vec<f32> = (0..columns * rows).map(grey).collect();
    let fibres: Vec<Tick> = (0..mesh.len())
        .map(|node| {
            let point_um = mesh.point(node);
            let from_picture = point_um[0] < centre[0] + 20.0;
            let (sin, cos) = if from_picture { angle(point_um).sin_cos() } else { (-cos, sin) };
            Tick { point_um, direction: [-sin, cos], coherency: 0.6, from_picture }
        })
        .collect();
    let [chosen, other] = [ring(centre, [57.0, 34.0]), ring([136.0, 22.0], [13.0, 7.0])];
    let cells = [
        Contour { name: "1", rings: vec![&chosen], chosen: true },
        Contour { name: "2", rings: vec![&other], chosen: false },
    ];
    let figure = overlay(&Overlay {
        title: "A made-up cell",
        width: columns,
        height: rows,
        values: &values,
        pixel_size: PixelSize::new(pixel)?,
        cells: &cells,
        mesh: Some(&mesh),
        fibres: &fibres,
        sarcomeres: None,
        warnings: &["2 cells were found; the largest was taken".to_owned()],
    })?;
    Ok(figure)
}
