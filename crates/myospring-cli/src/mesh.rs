//! `myospring mesh`.

use crate::args::MeshArgs;
use crate::failure::Failure;
use crate::input::{self, Input};
use crate::interrupt;
use crate::overlay::{self, Lattice};
use crate::print;
use crate::results::Folder;
use myospring::output::{figure, json};
use myospring::run_file::Shaped;
use std::path::Path;
use std::process::ExitCode;

pub(crate) fn mesh(args: &MeshArgs) -> Result<ExitCode, Failure> {
    input::one_cell(args.settings.all_cells())?;
    let Input { name, run, shaped, .. } =
        input::read(args.input.as_deref(), args.settings.overrides(), Some(&args.output))?;
    let field = run.fibre_field(&shaped)?;
    let Shaped { mesh, mut report, outline, picture } = shaped;
    if let (Some((cells, _)), Some(field)) = (&picture, &field) {
        report.warnings.extend(cells.fibre_warnings(field));
    }
    let target = args
        .output
        .output
        .clone()
        .unwrap_or_else(|| Path::new("results").join(format!("{name}_mesh")));
    interrupt::heed(interrupt::WRITING);
    let folder = Folder::claim(&target, args.output.force)?;
    folder.write("mesh.json", json::pretty(&report)?)?;
    folder.write("outline.geojson", outline.to_geojson())?;
    folder.figures(&[("mesh", &|| figure::mesh(&mesh))])?;
    if let Some((cells, cell)) = &picture {
        let fibres = run.fibres(&mesh, field.as_ref());
        let lattice = Some(Lattice { mesh: &mesh, fibres: &fibres, field: field.as_ref() });
        let draw = || overlay::draw(&name, cells, &[cell], lattice, &report.warnings);
        folder.figures(&[("overlay", &draw)])?;
    }
    let target = folder.finish()?;
    if args.output.json {
        print::out(&json::pretty(&report)?)?;
        return Ok(ExitCode::SUCCESS);
    }
    let text = report.to_string();
    let lines: Vec<&str> = text.lines().filter(|line| !line.starts_with("warning")).collect();
    print::out(&lines.join("\n"))?;
    print::out(&format!("\nresults in {}", target.display()))?;
    if !args.output.quiet {
        for warning in &report.warnings {
            print::warn(warning);
        }
    }
    Ok(ExitCode::SUCCESS)
}
