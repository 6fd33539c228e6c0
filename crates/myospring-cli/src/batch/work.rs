//! One picture of a batch: its cells found, each beaten.

use super::row::{Row, Status};
use crate::args::BatchArgs;
use crate::failure::Failure;
use crate::results::Folder;
use crate::{input, overlay, run};
use myospring::microscopy::cells::{PictureCell, PictureCells};
use myospring::microscopy::segment::Choice;
use myospring::output::files;
use myospring::output::report::Summary;
use myospring::run_file::{PictureSource, Run, Source};
use myospring::simulation::Progress;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::Instant;

/// Resolution of the overlays, dots per inch.
const DPI: f64 = 150.0;

/// What all pictures have in common.
pub(super) struct Work<'a> {
    pub(super) args: &'a BatchArgs,
    pub(super) target: &'a Path,
}

impl Work<'_> {
    /// The SHA-256 of a picture and its rows, at least one; whatever goes wrong is a row.
    pub(super) fn picture(&self, path: &Path, name: &str) -> (String, Vec<Row>) {
        let hash = std::fs::read(path).map(|bytes| run::hash(&bytes)).unwrap_or_default();
        // A fault of ours in one picture must not cost the others.
        let rows = catch_unwind(AssertUnwindSafe(|| self.rows(path, name)));
        let rows = match rows {
            Ok(Ok(rows)) => rows,
            Ok(Err(failure)) => vec![Row::failed(name, failure.to_string())],
            Err(_) => {
                let reason = "the program made a mistake; please report it with this picture";
                vec![Row::failed(name, reason.to_owned())]
            }
        };
        (hash, rows)
    }

    fn rows(&self, path: &Path, name: &str) -> Result<Vec<Row>, Failure> {
        let start = Instant::now();
        let (_, run) = input::settle(Some(path), self.args.settings.overrides())?;
        let Source::Picture(source) = &run.shape.source else {
            return Err(Failure::new("this is not a picture"));
        };
        let bytes = run.shape.bytes(|file| std::fs::read(file))?;
        let cells = source.cells(&bytes)?;
        let segment_s = start.elapsed().as_secs_f64();
        let (chosen, mut rows) = self.chosen(source, &cells, name)?;
        let every = self.every_cell();
        let left_out = |cell: &PictureCell| left_out(cell, every, source.allow_cut);
        let beaten: Vec<&PictureCell> =
            chosen.iter().filter(|cell| left_out(cell).is_none()).collect();
        let figure = overlay::draw(name, &cells, &beaten, None, &cells.notes)?;
        let file = self.target.join("overlays").join(format!("{}.png", own(name)));
        if let Some(folder) = file.parent() {
            files::create_folder(folder)?;
        }
        files::write(&file, figure.to_png(DPI)?)?;

        for cell in chosen {
            let mut row = described(name, &cells, &cell);
            row.number("segment_s", segment_s);
            if let Some(reason) = left_out(&cell) {
                row.status = Status::LeftOut;
                row.reason = reason;
            } else if let Err(failure) = self.beat(&run, &cells, cell, &mut row) {
                row.status = Status::Failed;
                row.reason = failure.to_string();
            }
            rows.push(row);
        }
        if rows.iter().all(|row| row.status == Status::LeftOut) {
            let reasons: Vec<String> = rows
                .iter()
                .take(3)
                .map(|row| format!("cell {}: {}", row.cell.as_deref().unwrap_or("?"), row.reason))
                .collect();
            let reason =
                format!("no cell is whole and sure enough to beat: {}", reasons.join("; "));
            rows.push(Row::failed(name, reason));
        }
        Ok(rows)
    }

    fn every_cell(&self) -> bool {
        let settings = &self.args.settings;
        let choices = ["segmentation.cell", "segmentation.seed", "shape.label"];
        settings.all_cells() || !choices.iter().any(|key| settings.get(key).is_some())
    }

    /// The cells to be beaten, and rows of those that cannot be outlined.
    fn chosen(
        &self,
        source: &PictureSource,
        cells: &PictureCells,
        name: &str,
    ) -> Result<(Vec<PictureCell>, Vec<Row>), Failure> {
        if !self.every_cell() {
            let cell = cells.cell(source.choice, source.allow_cut);
            return Ok((vec![cell.map_err(|cause| source.failed(cause))?], Vec::new()));
        }
        let (mut chosen, mut failed) = (Vec::new(), Vec::new());
        for number in 1..=cells.len() as u32 {
            match cells.cell(Choice::Number(number), true) {
                Ok(cell) => chosen.push(cell),
                Err(error) => {
                    let mut row = Row::failed(name, error.to_string());
                    row.cell = Some(number.to_string());
                    failed.push(row);
                }
            }
        }
        Ok((chosen, failed))
    }

    /// Beats one cell and adds its numbers to the row.
    fn beat(
        &self,
        run: &Run,
        cells: &PictureCells,
        cell: PictureCell,
        row: &mut Row,
    ) -> Result<(), Failure> {
        let start = Instant::now();
        let name = cell.name.replace('/', "_");
        let shaped = run.shape.mesh_cell(cells.clone(), cell)?;
        let field = run.fibre_field(&shaped)?;
        let mut report = shaped.report;
        row.number("spacing_um", report.spacing_um);
        row.number("masses", shaped.mesh.len() as f64);
        row.number("springs", shaped.mesh.springs.len() as f64);
        row.number("triangles", shaped.mesh.simplices.len() as f64);
        if let Some(field) = &field {
            report.warnings.extend(cells.fibre_warnings(field));
            let fibres = field.summary();
            row.number("fibres_from_picture_pct", 100.0 * fibres.share_from_picture);
            row.number("fibre_angle_to_axis_deg", fibres.mean_angle_deg);
            row.number("fibre_order", fibres.order);
        }
        // Moved by one thread, as all simulations unless told otherwise: the cores have pictures.
        let simulation = run.simulation(shaped.mesh, field.as_ref())?;
        let prepared = simulation.ready()?;
        let outcome = prepared.run(|Progress { .. }| true);
        let stimuli = run.stimulus_times();
        let mut warnings = run.warnings(&report);
        warnings.extend(prepared.warnings());
        row.warnings = warnings.join("; ");
        let summary = Summary::new(&outcome.recording, &stimuli, report, warnings);
        if let Some(beat) = summary.beats.first() {
            for metric in beat.metrics() {
                let mean = summary.beat_to_beat.iter().find(|spread| spread.name == metric.name);
                let value = mean.map(|spread| spread.mean).or(metric.value);
                row.number(column(metric.name, metric.unit), value);
            }
        }
        if self.args.figures {
            let target = self.target.join("cells").join(format!("{}_{name}", own(&row.picture)));
            let folder = Folder::claim(&target, true)?;
            run::write(&folder, run, &simulation, &outcome, &summary, &stimuli)?;
            folder.finish()?;
        }
        row.number("beat_s", start.elapsed().as_secs_f64());
        match outcome.stop {
            Some(stop) => Err(Failure::new(format!("the beat stopped early: {stop}"))),
            None => Ok(()),
        }
    }
}

/// Why a cell is not beaten.
fn left_out(cell: &PictureCell, every: bool, allow_cut: bool) -> Option<String> {
    if !every {
        return None;
    }
    let on_frame = cell.shape.pixels_on_frame;
    if on_frame > 0 && !allow_cut {
        return Some(format!(
            "the frame cuts it ({on_frame} pixels); --allow-cut beats it nevertheless"
        ));
    }
    if cell.confidence.is_doubtful() {
        let reasons = cell.confidence.reasons.join("; ");
        return Some(format!("doubtful, confidence {:.2} of 1: {reasons}", cell.confidence.score));
    }
    None
}

/// What is known of a cell before it beats.
fn described(picture: &str, cells: &PictureCells, cell: &PictureCell) -> Row {
    let mut row = Row {
        picture: picture.to_owned(),
        cell: Some(cell.name.clone()),
        status: Status::Ok,
        reason: String::new(),
        modality: Some(cells.modality().to_owned()),
        numbers: Vec::new(),
        warnings: cells.notes.join("; "),
    };
    let (shape, size) = (&cell.shape, &cell.shape.dimensions);
    row.number("pixel_size_um", cells.pixel_size.um());
    row.number("confidence", cell.confidence.score);
    row.number("contrast", cell.confidence.contrast);
    row.number("area_um2", shape.area_um2);
    row.number("perimeter_um", shape.perimeter_um);
    row.number("length_um", size.length_um);
    row.number("width_um", size.width_um);
    row.number("mean_width_um", size.mean_width_um);
    row.number("aspect_ratio", size.aspect_ratio);
    row.number("long_axis_deg", size.long_axis_deg);
    row.number("solidity", shape.solidity);
    row.number("circularity", shape.circularity);
    row.number("pixels_on_frame", shape.pixels_on_frame as f64);
    row
}

/// `peak_tension` in `kPa` gives `peak_tension_kPa`; `L0/s` becomes `L0_per_s`.
fn column(name: &str, unit: &str) -> String {
    match unit {
        "" => name.to_owned(),
        unit => {
            let unit = unit.replace('%', "pct").replace('/', "_per_");
            format!("{name}_{}", unit.replace('^', "").replace(' ', "_"))
        }
    }
}

/// A name without ending that no other picture has: `a/b.tif` gives `a/b_tif`, for there may be an `a/b.png`.
fn own(name: &str) -> String {
    name.rsplit_once('.').map_or(name.to_owned(), |(stem, ending)| format!("{stem}_{ending}"))
}
