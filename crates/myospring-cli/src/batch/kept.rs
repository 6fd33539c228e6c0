//! What a batch keeps beside its table: overlays, and curves and figures of each cell.

use crate::files::FILES;
use crate::look::Look;
use crate::outputs::Finished;
use crate::run::resolved;
use crate::summary::{self, Numbers};
use crate::terminal::Terminal;
use crate::{outputs, overlay};
use myospring::experiment::Folder;
use myospring::experiment::Inputs;
use myospring::microscopy::cells::{PictureCell, PictureCells};
use myospring::output::files::Manifest;
use myospring::study::Cause;
use myospring::study::pictures::{Beaten, Keeper, Picture};
use std::path::{Component, Path};

/// The table for people and for programs.
pub(super) const CSV: &str = "cells.csv";
pub(super) const PARQUET: &str = "cells.parquet";
const OVERLAYS: &str = "overlays";
const CELLS: &str = "cells";

/// Resolution of the overlays, dots per inch.
const DPI: f64 = 150.0;

/// Where it is kept.
pub(super) struct Kept<'a> {
    /// Whether each cell gets a folder of curves and figures.
    pub(super) figures: bool,
    pub(super) manifest: &'a Manifest,
}

impl Keeper for Kept<'_> {
    fn found(
        &self,
        picture: &Picture,
        cells: &PictureCells,
        to_beat: &[&PictureCell],
        notes: &[String],
    ) -> Result<(), Cause> {
        let figure = overlay::draw(&picture.name, cells, to_beat, None, notes)?;
        let file = format!("{OVERLAYS}/{}.png", own(&picture.name));
        Ok(self.manifest.write(&file, figure.to_png(DPI)?)?)
    }

    fn beaten(&self, beaten: &Beaten<'_>) -> Result<(), Cause> {
        if !self.figures {
            return Ok(());
        }
        let Beaten { picture, cell, run, simulation, outline, fibres, finished, summary, .. } =
            beaten;
        let name = format!("{}_{}", own(&picture.name), cell.replace('/', "_"));
        let place = format!("{CELLS}/{name}");
        let folder = Folder::claim_part(self.manifest.part(&place), &FILES)?;
        let report = fibres.report();
        let numbers = Numbers { summary, fibres: Some(&report), integration: finished.effort };
        let stimuli = run.stimulus_times();
        summary::write(&folder, run, simulation, fibres, finished, &numbers)?;
        // Pictures stay where they are, and the run file names them as seen from its folder.
        let mut inputs = Inputs::default();
        for path in run.to_run_file().paths_mut() {
            inputs.stays(path, &self.manifest.folder().join(&place));
        }
        let step = finished.effort.time_step();
        let run_file = resolved(run, (&inputs, ""), simulation, beaten.spacing_um, step);
        folder.write("run.toml", run_file)?;
        outputs::figures(
            &folder,
            &Finished {
                name: cell,
                run,
                simulation,
                outline,
                fibres,
                // The overlay of the whole picture stands beside.
                picture: None,
                outcome: finished,
                numbers: &numbers,
                stimuli: &stimuli,
                look: Look::default(),
                inputs: &Inputs::default(),
            },
        )?;
        folder.finish(&Terminal::new(true))?;
        Ok(())
    }
}

/// A name within the results, without ending, that no other picture has: `a/b.tif` gives `a/b_tif`, for there may be
/// an `a/b.png`; `../b.tif` gives `up/b_tif`.
fn own(name: &str) -> String {
    let parts = Path::new(name).components().filter_map(|part| match part {
        Component::Normal(part) => Some(part.to_string_lossy().into_owned()),
        Component::ParentDir => Some("up".to_owned()),
        _ => None,
    });
    let name = parts.collect::<Vec<_>>().join("/");
    name.rsplit_once('.').map_or(name.clone(), |(stem, ending)| format!("{stem}_{ending}"))
}
