//! Fits to films: the cell is followed, and its stretch is the curve.

use crate::args::FitArgs;
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::files::FILES;
use crate::options::Given;
use crate::terminal::Terminal;
use crate::{analyse, input, print};
use myospring::analysis::kind::Kind;
use myospring::experiment::Folder;
use myospring::experiment::tables::is_of_tables;
use myospring::experiment::track::{Followed, Report, Track};
use myospring::measured::Curve;
use myospring::microscopy::outlines::{NamedOutline, write_geojson};
use myospring::output::track::{self as table, TrackRow};
use myospring::settings::{Run, Source};
use std::path::{Path, PathBuf};

/// Where the film's results go.
const FOLDER: &str = "track";

/// The film among what is fitted to, if it is one: the only file, or the only thing that was given.
pub(super) fn named(args: &FitArgs) -> Result<Option<PathBuf>, Failure> {
    let is_film = |path: &Path| !is_of_tables(path);
    match args.to.as_slice() {
        [] if args.input.as_deref().is_some_and(|path| !is_film(path)) => {
            let path = args.input.as_deref().unwrap_or(Path::new("")).display().to_string();
            Err(Failure::new(format!("`{path}` has curves, it is no film"))
                .advise(format!("name measured curves like this: myospring fit --to {path}")))
        }
        [] => args.input.clone().map(Some).ok_or_else(|| {
            Failure::new("there is nothing to fit to")
                .advise("name a measured curve, --to cell.csv, or a film: myospring fit film.avi")
        }),
        [one] => Ok(Some(one.clone()).filter(|path| is_film(path))),
        several => match several.iter().find(|path| is_film(path)) {
            None => Ok(None),
            Some(film) => Err(Failure::new(format!(
                "`{}` is no table of curves; a film stands alone",
                film.display()
            ))),
        },
    }
}

/// Follows the cell of a film.
pub(super) fn follow(
    args: &FitArgs,
    film: &Path,
    overrides: &[Given],
) -> Result<Followed, Failure> {
    let rate = args.table.frame_rate.as_deref().map(analyse::table::frame_rate).transpose()?;
    let mut experiment =
        Track { settings: overrides.to_vec(), frame_rate: rate, ..Track::of(film) };
    let name = experiment.check(&FILES)?;
    experiment.refused = Some(input::refusals(&args.output, &name));
    experiment.follow(&FILES, &Terminal::new(args.output.quiet))
}

/// The curve of a film: its cell's mean stretch along the contraction, unless a column of `track.csv` was named.
pub(super) fn curve(args: &FitArgs, rows: &[TrackRow]) -> Result<Curve, Failure> {
    type Read = fn(&TrackRow) -> Option<f64>;
    const COLUMNS: [(&str, Kind, &str, Read); 4] = [
        ("stretch_1", Kind::NormalisedLength, "", |row| Some(row.stretch_1)),
        ("length_um", Kind::Length, "um", |row| Some(row.length_um)),
        ("shortening_pct", Kind::Shortening, "%", |row| Some(row.shortening_pct)),
        ("sarcomere_um", Kind::SarcomereLength, "um", |row| row.sarcomere_um),
    ];
    let wanted = match args.table.columns.as_slice() {
        [] => COLUMNS[0].0,
        [one] => one.trim(),
        _ => return Err(Failure::new("--columns: of a film one column is fitted")),
    };
    let Some((name, kind, unit, read)) = COLUMNS.into_iter().find(|(name, ..)| *name == wanted)
    else {
        let known = COLUMNS.map(|(name, ..)| name).join(", ");
        return Err(Failure::new(format!("--columns: a film has no `{wanted}`"))
            .advise(format!("it has {known}")));
    };
    let points: Vec<(f64, f64)> =
        rows.iter().filter_map(|row| Some((row.t_ms, read(row)?))).collect();
    let (times_ms, values): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
    let lines = (0..times_ms.len() as u64).map(|row| row + 2).collect();
    let stimuli_ms = Vec::new();
    Ok(Curve { name: name.to_owned(), kind, unit, times_ms, values, lines, stimuli_ms })
}

/// Ends a fit that was interrupted before anything was fitted.
pub(super) fn only_followed(folder: Folder) -> Result<ExitCode, Failure> {
    let target = folder.finish(&Terminal::new(true))?;
    print::note(&format!(
        "interrupted: nothing was fitted; the frames that were followed are in {}",
        target.display()
    ));
    Ok(ExitCode::from(1))
}

/// Writes what was followed; a run of the film alone (`own`) then has the shape of its frame at rest.
pub(super) fn write(
    folder: &Folder,
    target: &Path,
    followed: &Followed,
    report: &Report,
    name: &str,
    run: &mut Run,
    own: bool,
) -> Result<(), Failure> {
    let within = |file: &str| format!("{FOLDER}/{file}");
    folder.write(&within("track.csv"), table::to_csv(&report.rows)?)?;
    folder.write(&within("rest.tif"), &followed.rest_picture)?;
    let outline = NamedOutline { name: name.to_owned(), outline: followed.shaped.outline.clone() };
    folder.write(&within("outline.geojson"), write_geojson(&[outline]))?;
    if let Source::Picture(source) = &mut run.shape.source
        && own
    {
        let written = |file: &str| target.join(within(file)).to_string_lossy().into_owned();
        source.path = written("rest.tif");
        source.outline = Some(written("outline.geojson"));
    }
    Ok(())
}
