//! What a batch writes in addition to its table: overlays, and curves and figures of each cell.

use crate::experiment::run::{Finished, RunNumbers, Style, resolved, write_figures, write_numbers};
use crate::experiment::{Files, Folder, Inputs, Observer, overlay};
use crate::microscopy::cells::{PictureCell, PictureCells};
use crate::output::files::Manifest;
use crate::output::page::Photograph;
use crate::study::Cause;
use crate::study::pictures::{Keeper, Picture, SimulatedCell};
use std::path::{Component, Path};

const OVERLAYS: &str = "overlays";
const THUMBNAILS: &str = "thumbnails";
const CELLS: &str = "cells";

/// Resolution of the overlays, dots per inch.
const DPI: f64 = 150.0;

/// Where it is written.
pub(super) struct Kept<'a> {
    /// Whether each cell gets a folder of curves and figures.
    pub(super) figures: bool,
    /// That of the folder of the results; without one nothing is written.
    pub(super) manifest: Option<&'a Manifest>,
    pub(super) files: &'a Files,
    pub(super) observer: &'a dyn Observer,
}

impl Keeper for Kept<'_> {
    fn found(
        &self,
        picture: &Picture,
        cells: &PictureCells,
        to_beat: &[&PictureCell],
        notes: &[String],
    ) -> Result<(), Cause> {
        let Some(manifest) = self.manifest else { return Ok(()) };
        let figure = overlay::draw(&picture.name, cells, to_beat, None, notes)?;
        let file = format!("{OVERLAYS}/{}.png", own(&picture.name));
        manifest.write(&file, figure.to_png(DPI)?)?;
        let plane = &cells.plane;
        let photograph = Photograph {
            width: plane.width(),
            height: plane.height(),
            values: plane.values(),
            pixel_size: cells.pixel_size,
        };
        for cell in cells.outlines() {
            if let Some(png) = photograph.thumbnail(&cell.outline)? {
                manifest.write(&thumbnail(&picture.file, &cell.name), png)?;
            }
        }
        Ok(())
    }

    fn beaten(&self, beaten: &SimulatedCell<'_>) -> Result<(), Cause> {
        let Some(manifest) = self.manifest.filter(|_| self.figures) else { return Ok(()) };
        let SimulatedCell {
            picture,
            cell,
            run,
            simulation,
            outline,
            fibres,
            finished,
            summary,
            ..
        } = beaten;
        let name = format!("{}_{}", own(&picture.name), cell.replace('/', "_"));
        let place = format!("{CELLS}/{name}");
        let folder = Folder::claim_part(manifest.part(&place), self.files)?;
        let numbers =
            RunNumbers { summary, fibres: Some(fibres.report()), integration: finished.effort };
        let stimuli = run.stimulus_times();
        write_numbers(&folder, run, simulation, fibres, finished, &numbers)?;
        // Pictures are not copied; the run file names them relative to its folder.
        let mut inputs = Inputs::default();
        for path in run.to_run_file().paths_mut() {
            inputs.stays(path, &manifest.folder().join(&place));
        }
        let step = finished.effort.time_step();
        let run_file = resolved(run, (&inputs, ""), simulation, beaten.spacing_um, step);
        folder.write("run.toml", run_file)?;
        write_figures(
            &folder,
            &Finished {
                name: cell,
                run,
                simulation,
                outline,
                fibres,
                // The overlay of the whole picture is written separately.
                picture: None,
                outcome: finished,
                numbers: &numbers,
                stimuli: &stimuli,
                style: Style::default(),
                mesh_figure: None,
                inputs: &Inputs::default(),
                observer: self.observer,
            },
        )?;
        folder.finish(self.observer)?;
        Ok(())
    }
}

/// Where the small picture of a cell is.
pub(super) fn thumbnail(picture: &str, cell: &str) -> String {
    format!("{THUMBNAILS}/{}_{}.png", own(picture), cell.replace('/', "_"))
}

/// A name within the results, without ending, that no other picture has: `a/b.tif` gives `a/b_tif`,
/// since there may be an `a/b.png`; `../b.tif` gives `up/b_tif`.
fn own(name: &str) -> String {
    let parts = Path::new(name).components().filter_map(|part| match part {
        Component::Normal(part) => Some(part.to_string_lossy().into_owned()),
        Component::ParentDir => Some("up".to_owned()),
        _ => None,
    });
    let name = parts.collect::<Vec<_>>().join("/");
    name.rsplit_once('.').map_or(name.clone(), |(stem, ending)| format!("{stem}_{ending}"))
}
