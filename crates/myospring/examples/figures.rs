//! Draws every figure of a made-up beat: `cargo run --example figures -- FOLDER`.

use std::path::{Path, PathBuf};

use myospring::output::figure::{
    ContractionOptions, Figure, action_potential_and_tension, cell_shapes, contraction, key_shapes,
    mesh, overview,
};
use myospring::output::files;

#[path = "../tests/output/synthetic.rs"]
mod synthetic;

type Outcome = Result<(), Box<dyn std::error::Error>>;

fn save(folder: &Path, name: &str, figure: &Figure, dpi: f64) -> Outcome {
    files::write(&folder.join(format!("{name}.svg")), &figure.svg)?;
    files::write(&folder.join(format!("{name}.png")), figure.to_png(dpi)?)?;
    Ok(())
}

fn main() -> Outcome {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "figures".to_owned()));
    files::create_folder(&folder)?;
    let stimuli = [synthetic::STIMULUS];

    let long = synthetic::elongated(1.0);
    let axis = [1.0, 0.0];
    let beats = [30.0, 40.0, 50.0].map(|kpa| synthetic::recording(&long, axis, kpa, false));
    let strongest = &beats[2];
    save(&folder, "action-potential", &action_potential_and_tension(strongest, &stimuli)?, 300.0)?;
    save(&folder, "cell", &cell_shapes(&long, &key_shapes(strongest, &stimuli), axis)?, 300.0)?;
    let curves = [("30 kPa", &beats[0]), ("40 kPa", &beats[1]), ("50 kPa", &beats[2])];
    let plain = ContractionOptions::default();
    save(&folder, "contraction", &contraction(&curves, &plain)?, 300.0)?;
    let band = ContractionOptions {
        stimulus_times_ms: stimuli.to_vec(),
        reference_band: Some(([7.0, 12.0], "adult ventricular myocytes, unloaded")),
    };
    save(&folder, "contraction-band", &contraction(&curves, &band)?, 300.0)?;
    save(&folder, "mesh", &mesh(&synthetic::elongated(2.0))?, 300.0)?;
    save(&folder, "overview", &overview(&long, strongest, axis, &stimuli)?, 200.0)?;

    let (round, axis) = synthetic::roundish(2.0);
    let beat = synthetic::recording(&round, axis, 50.0, true);
    let potential = action_potential_and_tension(&beat, &stimuli)?;
    save(&folder, "action-potential-mv", &potential, 300.0)?;
    save(&folder, "cell-round", &cell_shapes(&round, &key_shapes(&beat, &stimuli), axis)?, 300.0)?;
    save(&folder, "mesh-round", &mesh(&round)?, 300.0)?;
    save(&folder, "overview-round", &overview(&round, &beat, axis, &stimuli)?, 200.0)?;
    Ok(())
}
