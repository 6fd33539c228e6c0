//! `myospring mesh`.

use crate::args::MeshArgs;
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::fibres;
use crate::files::FILES;
use crate::input::{self, Input};
use crate::interrupt;
use crate::overlay::{self, Lattice};
use crate::print;
use crate::terminal::Terminal;
use myospring::experiment::Folder;
use myospring::mesh::quality::MeshReport;
use myospring::output::figure::{self, Theme};
use myospring::output::json;
use myospring::run_file::Shaped;
use myospring::settings::FibreReport;
use serde::Serialize;
use std::path::Path;

/// mesh.json.
#[derive(Serialize)]
struct Numbers<'a> {
    #[serde(flatten)]
    mesh: &'a MeshReport,
    /// Of a picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    fibres: Option<&'a FibreReport>,
}

pub(crate) fn mesh(args: &MeshArgs) -> Result<ExitCode, Failure> {
    input::one_cell(args.settings.all_cells())?;
    let (name, run) = input::settle(args.input.as_deref(), args.settings.overrides())?;
    let mut target = args.output.output.clone();
    let target = target.get_or_insert_with(|| Path::new("results").join(format!("{name}_mesh")));
    Folder::check(target, args.output.force, &FILES)?;
    let Input { name, run, shaped, .. } = input::mesh(name, run, Some(&args.output))?;
    let Shaped { mesh, mut report, outline, picture } = shaped;
    let fibres = run.fibre.on(&mesh, picture.as_ref().map(|(cells, cell)| (cells, cell)))?;
    report.warnings.extend(fibres.warnings.iter().cloned());
    let of_picture = picture.is_some().then(|| fibres.report());
    let numbers = Numbers { mesh: &report, fibres: of_picture.as_ref() };
    interrupt::heed(interrupt::WRITING);
    let folder = Folder::claim(target, args.output.force, &FILES)?;
    folder.write("mesh.json", json::for_people(&numbers)?)?;
    folder.write("outline.geojson", outline.to_geojson())?;
    folder.figures(Theme::default(), &[("mesh", &|| figure::mesh(&mesh))], &Terminal::new(true))?;
    if let Some((cells, cell)) = &picture {
        let lattice = Some(Lattice { mesh: &mesh, fibres: &fibres });
        let draw = || overlay::draw(&name, cells, &[cell], lattice, &report.warnings);
        folder.figures(Theme::default(), &[("overlay", &draw)], &Terminal::new(true))?;
    }
    fibres::write(&folder, [(name.as_str(), &mesh, &fibres)])?;
    let target = folder.finish(&Terminal::new(true))?;
    if args.output.json {
        print::out(&json::for_people(&numbers)?)?;
        return Ok(ExitCode::SUCCESS);
    }
    let text = report.to_string();
    let lines: Vec<&str> = text.lines().filter(|line| !line.starts_with("warning")).collect();
    print::out(&lines.join("\n"))?;
    if let Some(fibres) = &of_picture {
        print::out(&format!("{:<20} {fibres}", "fibres"))?;
    }
    print::out(&format!("\nresults in {}", target.display()))?;
    if !args.output.quiet {
        for warning in &report.warnings {
            print::warn(warning);
        }
    }
    Ok(ExitCode::SUCCESS)
}
