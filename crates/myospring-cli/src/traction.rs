//! `myospring traction`.

use crate::analyse::table::{frame_rate, quantity};
use crate::args::TractionArgs;
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::files::FILES;
use crate::table::{aligned, number};
use crate::terminal::Terminal;
use crate::{interrupt, print};
use myospring::experiment::traction::{FoundTractions, Traction};
use myospring::experiment::{Experiment, Folder, Outcome};
use myospring::mechanics::gel::Gel;
use myospring::output::json;
use myospring::units::Dimension;
use std::path::{Path, PathBuf};

pub(crate) fn traction(args: &TractionArgs) -> Result<ExitCode, Failure> {
    let length = |option: &str, text: &Option<String>| {
        text.as_deref().map(|text| quantity(option, text, Dimension::Length)).transpose()
    };
    let [u, v] = args.displacements.as_slice() else {
        return Err(Failure::new(
            "two arrays are needed: displacements to the right, and downward",
        ));
    };
    let gel = Gel {
        poisson: args.gel_poisson,
        thickness: length("--gel-thickness", &args.gel_thickness)?,
        ..Gel::half_space(quantity("--gel-modulus", &args.gel_modulus, Dimension::Pressure)?)
    };
    let experiment = Traction {
        unit_um: length("--unit", &args.unit)?,
        region: args.region.clone(),
        frame_rate_per_s: args.frame_rate.as_deref().map(frame_rate).transpose()?,
        ..Traction::of(
            [u.clone(), v.clone()],
            quantity("--pixel-size", &args.pixel_size, Dimension::Length)?,
            gel,
        )
    };
    let read = experiment.displacements.iter().chain(&experiment.region);
    read.for_each(|path| FILES.note(path));
    let target = args.output.output.clone().unwrap_or_else(|| folder(u));
    Folder::check(&target, args.output.force, &FILES)?;
    let terminal = Terminal::new(args.output.quiet);
    let found = experiment.run(&FILES, &terminal)?;
    let folder = Folder::claim(&target, args.output.force, &FILES)?;
    interrupt::heed(interrupt::WRITING);
    found.save(&folder, &terminal)?;
    let target = folder.finish(&terminal)?;
    terminal.clear();
    if args.output.json {
        print::out(&json::for_people(&found.numbers())?)?;
    } else {
        print::out(&words(&found))?;
        print::out(&format!("\nwritten: {}", target.display()))?;
    }
    if !args.output.quiet {
        found.warnings().iter().for_each(|warning| print::warn(warning));
    }
    Ok(ExitCode::SUCCESS)
}

/// The numbers of the frame of the largest force.
fn words(found: &FoundTractions) -> String {
    let strongest = found.strongest();
    let tractions = &found.tractions[strongest.frame];
    let row =
        |name: &str, value: f64, unit: &str| vec![name.to_owned(), number(value), unit.to_owned()];
    let mut rows = vec![
        row("force, all directions", strongest.force_nn, "nN"),
        row("  that noise alone would make", strongest.noise_floor_nn, "nN"),
        row("contractile moment", strongest.contractile_moment_fj, "fJ"),
        row("energy of the gel", strongest.energy_fj, "fJ"),
        row("noise of displacements", tractions.noise_um, "um"),
        row("shortest wave of the map", tractions.shortest_wave_um, "um"),
    ];
    if found.frames.len() > 1 {
        let which = strongest.t_ms.map_or_else(
            || row("largest of all frames: frame", strongest.frame as f64, ""),
            |t_ms| row("largest of all frames: time", t_ms, "ms"),
        );
        rows.insert(0, which);
    }
    aligned(&rows, &[1])
}

/// The default folder for the results.
fn folder(u: &Path) -> PathBuf {
    let folder =
        u.parent().and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
    let name = folder.map_or_else(|| "traction".to_owned(), |folder| format!("{folder}_traction"));
    Path::new("results").join(name)
}
