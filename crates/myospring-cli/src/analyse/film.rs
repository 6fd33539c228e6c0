//! `myospring analyse` of a film of light.

use super::table;
use crate::args::AnalyseArgs;
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::files::FILES;
use crate::table::{aligned, number};
use crate::terminal::Terminal;
use crate::{interrupt, print};
use myospring::experiment::optical::{MapWaves, OpticalReport};
use myospring::experiment::{Experiment, Folder, Outcome};
use myospring::measured::TableOptions;
use myospring::output::json;
use std::path::Path;

pub(super) fn analyse(args: &AnalyseArgs, film: &Path) -> Result<ExitCode, Failure> {
    let until = args.to.as_deref().map(|to| ("--to", to));
    let given = table::options(&args.table, args.pixel_size.as_deref(), until)?;
    let TableOptions { frame_rate_per_s, pixel_size_um, .. } = given;
    let known = TableOptions { frame_rate_per_s, pixel_size_um, ..TableOptions::default() };
    if given != known || args.smooth.is_some() || args.keep_drift {
        return Err(Failure::new(format!(
            "`{}` is a film: options of tables do not apply to it",
            film.display()
        ))
        .advise("options of films are --frame-rate, --pixel-size, --light and those of stimuli"));
    }
    let experiment = MapWaves {
        film: film.to_owned(),
        frame_rate: frame_rate_per_s,
        pixel_size_um,
        beats: table::beats(&args.stimuli, None, false)?,
        falls: args.light.as_deref().map(|light| light == "falls"),
    };
    let name = film.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let target = args.output.output.clone();
    let target = target.unwrap_or_else(|| Path::new("results").join(format!("{name}_waves")));
    let folder = Folder::claim(&target, args.output.force, &FILES)?;
    let terminal = Terminal::new(args.output.quiet);
    let outcome = experiment.run(&FILES, &terminal)?;
    interrupt::heed(interrupt::WRITING);
    outcome.save(&folder, &terminal)?;
    let target = folder.finish(&terminal)?;
    terminal.clear();
    if args.output.json {
        print::out(&json::for_people(&outcome.numbers())?)?;
    } else {
        print::out(&for_people(&outcome.report))?;
        print::out(&format!("\nwritten: {}", target.display()))?;
    }
    if !args.output.quiet {
        outcome.warnings().iter().for_each(|warning| print::warn(warning));
    }
    Ok(ExitCode::SUCCESS)
}

fn for_people(report: &OpticalReport) -> String {
    let way = if report.falls { "falls" } else { "rises" };
    let of = match report.pixels_of_a_point {
        1 => "a pixel each".to_owned(),
        side => format!("{side} x {side} pixels each"),
    };
    let mut lines = vec![
        format!(
            "{}: {} of {} frames at {} /s, pixels of {} um",
            report.film,
            report.frames_read,
            report.frames,
            number(report.frames_per_second),
            number(report.pixel_size_um)
        ),
        format!(
            "{} points, {of}; {:.0} % of them beat; their light {way} in a beat, with a noise of {:.1} % of its height",
            report.points, report.beating_pct, report.noise_pct
        ),
        format!(
            "{} waves; activation counts from {}",
            report.waves.len(),
            if report.stimulated { "the stimulus" } else { "the first points that are activated" }
        ),
    ];
    let mut rows = vec![["metric", "mean", "SD", "waves", "unit"].map(str::to_owned).to_vec()];
    for metric in report.waves.first().into_iter().flat_map(|wave| &wave.metrics) {
        let spread = report.spread.iter().find(|spread| spread.name == metric.name);
        let (mean, deviation, count) = match spread {
            Some(all) => (number(all.mean), number(all.standard_deviation), all.beats.to_string()),
            None => {
                (metric.value.map_or_else(|| "-".to_owned(), number), String::new(), "1".to_owned())
            }
        };
        rows.push(vec![
            metric.name.replace('_', " "),
            mean,
            deviation,
            count,
            metric.unit.to_owned(),
        ]);
    }
    lines.push(aligned(&rows, &[1, 2, 3]));
    lines.join("\n")
}
