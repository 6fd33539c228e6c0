//! `myospring traction`.

use crate::analyse::table::{frame_rate, quantity};
use crate::args::TractionArgs;
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::files::FILES;
use crate::input::ending;
use crate::table::{aligned, number};
use crate::terminal::Terminal;
use crate::{interrupt, print};
use myospring::experiment::analyse::{AnalysedCurve, KEY, Mean, means};
use myospring::experiment::tables::TABLES;
use myospring::experiment::traction::{
    Beads, CellPlace, Followed, FoundTractions, Source, Traction,
};
use myospring::experiment::{Experiment, Folder, Outcome};
use myospring::mechanics::gel::Gel;
use myospring::output::json;
use myospring::units::Dimension;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

pub(crate) fn traction(args: &TractionArgs) -> Result<ExitCode, Failure> {
    let length = |option: &str, text: &Option<String>| {
        text.as_deref().map(|text| quantity(option, text, Dimension::Length)).transpose()
    };
    let gel = Gel {
        poisson: args.gel_poisson,
        thickness: length("--gel-thickness", &args.gel_thickness)?,
        ..Gel::half_space(quantity("--gel-modulus", &args.gel_modulus, Dimension::Pressure)?)
    };
    let pixel_size_um = length("--pixel-size", &args.pixel_size)?;
    let (unit_um, subset_um) = (length("--unit", &args.unit)?, length("--subset", &args.subset)?);
    let source = match args.input.as_slice() {
        [u, v] => Source::Arrays {
            files: arrays(args, u, v)?,
            pixel_size_um: pixel_size_um.ok_or_else(|| {
                Failure::new(
                    "--pixel-size is missing: the arrays do not say how far apart their places are",
                )
                .advise("give it like --pixel-size \"0.63 um\"")
            })?,
            unit_um,
            subset_um,
        },
        [table] if TABLES.contains(&ending(table).as_str()) => {
            let file = displacements(args, table)?;
            Source::Table { file, pixel_size_um, unit_um, subset_um }
        }
        [film] => Source::Beads(Beads {
            reference: args.reference.clone(),
            rest: args.frame,
            pixel_size_um,
            subset_um,
            channel: args.channel,
            ..Beads::of(pictures(args, film)?)
        }),
        _ => return Err(Failure::new("give a film, or two arrays of displacements")),
    };
    let experiment = Traction {
        source,
        gel,
        cell: args.cell.clone().map(|path| CellPlace::File { path, channel: args.cell_channel }),
        frame_rate_per_s: args.frame_rate.as_deref().map(frame_rate).transpose()?,
        threads: args.threads.map(NonZeroUsize::get),
    };
    experiment.files().into_iter().for_each(|path| FILES.note(path));
    let target = args.output.output.clone().unwrap_or_else(|| folder(&experiment));
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

fn is_array(path: &Path) -> bool {
    ending(path) == "npy"
}

/// Two arrays, without an option that is for pictures.
fn arrays(args: &TractionArgs, u: &Path, v: &Path) -> Result<[PathBuf; 2], Failure> {
    if !is_array(u) && !is_array(v) {
        let (first, second) = (u.display(), v.display());
        return Err(Failure::new(format!("`{first}` and `{second}` are no arrays (.npy) of displacements")).advise(
            format!(
                "for the pulled and the relaxed gel: myospring traction {first} --reference {second}; for a film: the folder \
                 of its pictures"
            ),
        ));
    }
    displacements(args, u)?;
    Ok([u.to_owned(), v.to_owned()])
}

/// A file of displacements, without an option that is for pictures.
fn displacements(args: &TractionArgs, file: &Path) -> Result<PathBuf, Failure> {
    let of_pictures = [
        ("--reference", args.reference.is_some()),
        ("--frame", args.frame.is_some()),
        ("--channel", args.channel.is_some()),
    ];
    match of_pictures.iter().find(|(_, is_given)| *is_given) {
        Some((option, _)) => Err(Failure::new(format!(
            "{option} is for pictures of beads; displacements do not need it"
        ))),
        None => Ok(file.to_owned()),
    }
}

/// A film, without an option that is for arrays.
fn pictures(args: &TractionArgs, film: &Path) -> Result<PathBuf, Failure> {
    if is_array(film) {
        return Err(Failure::new(format!("`{}` is one array", film.display()))
            .advise("give two: displacements to the right, and downward, like u.npy v.npy"));
    }
    if args.unit.is_some() {
        return Err(Failure::new(
            "--unit is for displacements; pictures of beads have --pixel-size",
        ));
    }
    Ok(film.to_owned())
}

/// How displacements were found, the numbers of the frame of the largest force, and beats.
fn words(found: &FoundTractions) -> String {
    let strongest = found.strongest();
    let tractions = &found.tractions[found.strongest_at()];
    let row =
        |name: &str, value: f64, unit: &str| vec![name.to_owned(), number(value), unit.to_owned()];
    let mut rows = vec![
        row("axial force", strongest.axial_force_nn, "nN"),
        row("  standard deviation by noise", strongest.axial_noise_floor_nn, "nN"),
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
    let mut text = found.followed().map_or_else(String::new, of_beads);
    text.push_str(&aligned(&rows, &[1]));
    if let Some(read) = &found.beats {
        text.push_str(&beats(read));
    }
    text
}

fn of_beads(followed: &Followed) -> String {
    let rest = if followed.relative_to_rest {
        "\nforces are relative to the cell at rest: its resting tension is not in them"
    } else {
        ""
    };
    format!(
        "{}: displacements from {}{rest}\n{} x {} places, squares of {:.1} um, beads {:.2} um apart; interpolated {:.1} % on \
         average, {:.1} % at most\nmotion of the stage: {}, up to {:.2} um\n",
        followed.film,
        followed.reference,
        followed.places[0],
        followed.places[1],
        followed.subset_um,
        followed.bead_distance_um,
        followed.interpolated_pct_mean,
        followed.interpolated_pct_most,
        followed.stage,
        followed.stage_largest_um
    )
}

/// Beats of the axial force.
fn beats(read: &AnalysedCurve) -> String {
    let analysis = match &read.found {
        Ok(analysis) => analysis,
        Err(cause) => return format!("\nno beats of the axial force: {cause}"),
    };
    let means = means(analysis);
    let rows = KEY.iter().filter_map(|(title, names)| {
        let mean = Mean::first(&means, names)?.in_words()?;
        Some(vec![(*title).to_owned(), mean])
    });
    let count = analysis.counted().len();
    let rows: Vec<Vec<String>> = rows.collect();
    format!("\nbeats of the axial force: {count} whole\n{}", aligned(&rows, &[]))
}

/// The default folder for the results.
fn folder(experiment: &Traction) -> PathBuf {
    let name = match &experiment.source {
        // Arrays are `u.npy` in every folder.
        Source::Arrays { files, .. } => files[0].parent().and_then(Path::file_name),
        Source::Table { file, .. } => file.file_stem(),
        Source::Beads(beads) => beads.film.file_stem(),
    };
    let name = name.map(|name| name.to_string_lossy().into_owned());
    let name = name.map_or_else(|| "traction".to_owned(), |name| format!("{name}_traction"));
    Path::new("results").join(name)
}
