//! `myospring mesh`.

use crate::args::MeshArgs;
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::files::FILES;
use crate::input::{self, refusals};
use crate::interrupt;
use crate::print;
use crate::terminal::Terminal;
use myospring::experiment::mesh::MeshCell;
use myospring::experiment::{Experiment, Folder, Outcome, save};
use myospring::output::json;
use std::path::Path;

pub(crate) fn mesh(args: &MeshArgs) -> Result<ExitCode, Failure> {
    input::one_cell(args.settings.all_cells())?;
    let (name, run) = input::settle(args.input.as_deref(), &args.settings.overrides())?;
    let has_no_thickness =
        args.settings.get("material.thickness").is_some() && !run.shape.is_thick();
    let output = &args.output;
    let results = || Path::new("results").join(format!("{name}_mesh"));
    let target = output.output.clone().unwrap_or_else(results);
    Folder::check(&target, output.force, &FILES)?;
    let refused = refusals(output, &name);
    let observer = Terminal::new(output.quiet);
    let meshed = MeshCell { name, run, refused: Some(refused) }.run(&FILES, &observer)?;
    interrupt::heed(interrupt::WRITING);
    let target = save(&meshed, &target, output.force, &FILES, &observer)?;
    if output.json {
        print::out(&json::for_people(&meshed.numbers())?)?;
        return Ok(ExitCode::SUCCESS);
    }
    let text = meshed.shaped.report.to_string();
    let lines: Vec<&str> = text.lines().filter(|line| !line.starts_with("warning")).collect();
    print::out(&lines.join("\n"))?;
    if let Some(fibres) = &meshed.fibres_of_picture() {
        print::out(&format!("{:<20} {fibres}", "fibres"))?;
    }
    print::out(&format!("\nresults in {}", target.display()))?;
    if !output.quiet {
        for warning in meshed.warnings() {
            print::warn(&warning);
        }
        if has_no_thickness {
            print::warn(
                "the mesh of a flat cell is the same with any --thickness; for a thick cell state \
                 --profile round, dome or slab",
            );
        }
    }
    Ok(ExitCode::SUCCESS)
}
