//! The fibres and sarcomeres of a whole picture, without an outline.

use crate::experiment::fibres::{FILE, row};
use crate::experiment::{Experiment, ExperimentError, Files, Folder, Observer, Outcome, overlay};
use crate::microscopy::cells::PictureCells;
use crate::microscopy::fibres::{FibreSettings, SarcomereDoubt, Stain};
use crate::microscopy::whole_frame::WholeFrame;
use crate::output::fibres::{FibreRow, to_csv};
use crate::output::figure::{Figure, FigureError, Sarcomeres, Tick};
use crate::output::json;
use crate::run_file::Source;
use crate::settings::{FibreDirection, Run};
use serde::Serialize;

/// Resolution of the overlay, dots per inch.
const DPI: f64 = 200.0;

/// Reads the fibres of a whole picture: a sheet or a tissue, in which no cell has an outline.
pub struct ReadWholeFrame {
    /// The picture, as people named it.
    pub picture: String,
    /// How it is read.
    pub run: Run,
}

/// What was read.
pub struct FieldOfView {
    picture: String,
    settings: FibreSettings,
    /// The picture, without cells.
    pub cells: PictureCells,
    /// Its fibres, place by place.
    pub read: WholeFrame,
}

/// What was read, as `report.json` has it.
#[derive(Serialize)]
pub struct FrameReport<'a> {
    /// The picture, as it was named.
    pub picture: &'a str,
    /// Width of the frame, um.
    pub width_um: f64,
    /// Height of the frame, um.
    pub height_um: f64,
    /// Side of a pixel, um.
    pub pixel_size_um: f64,
    /// Where that comes from.
    pub pixel_size_source: &'static str,
    /// Distance of neighbouring places, um.
    pub spacing_um: f64,
    /// The fibres.
    pub fibres: FrameFibres,
    notes: Vec<String>,
}

/// Numbers over the part of a frame that was read.
#[derive(Serialize)]
pub struct FrameFibres {
    stain: Stain,
    /// Part of the frame that was read, per cent.
    pub read_pct: f64,
    /// Mean direction, degrees counter-clockwise from x, above -90 and up to 90.
    pub direction_deg: Option<f64>,
    /// How parallel the fibres are, 0 to 1.
    pub alignment: Option<f64>,
    /// Median length of the sarcomeres, um.
    pub sarcomere_um: Option<f64>,
    /// Its first quartile, um.
    pub sarcomere_q1_um: Option<f64>,
    /// Its third quartile, um.
    pub sarcomere_q3_um: Option<f64>,
    /// Why that length is doubtful, if it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sarcomere_doubt: Option<SarcomereDoubt>,
}

impl Experiment for ReadWholeFrame {
    type Outcome = FieldOfView;

    fn run(&self, files: &Files, observer: &dyn Observer) -> Result<FieldOfView, ExperimentError> {
        let run = self.run.clone().interrupted_by(&observer.interruption());
        let Source::Picture(source) = &run.shape.source else {
            let message = format!("`{}` is not a picture", self.picture);
            return Err(ExperimentError::new(message).advise("give a picture (.png, .tif, .tiff)"));
        };
        let settings = match self.run.fibre {
            FibreDirection::Auto(asked) => asked.settings(),
            FibreDirection::Picture(settings) => settings,
            FibreDirection::LongAxis | FibreDirection::Angle(_) => {
                let message = "--whole-frame reads the fibres from the picture";
                return Err(ExperimentError::new(message)
                    .advise("leave --fibre out, or give --fibre picture"));
            }
        };
        let bytes = self.run.shape.bytes(|file| files.bytes(file))?;
        let cells = source.unsegmented(&bytes)?;
        let read = WholeFrame::read(&cells, &settings, self.run.shape.spacing)?;
        Ok(FieldOfView { picture: self.picture.clone(), settings, cells, read })
    }
}

impl FieldOfView {
    /// What was read, as `report.json` has it.
    pub fn report(&self) -> FrameReport<'_> {
        let WholeFrame { size_um: [width_um, height_um], spacing_um, summary, .. } = &self.read;
        let quartiles = summary.sarcomere_quartiles_um;
        FrameReport {
            picture: &self.picture,
            width_um: *width_um,
            height_um: *height_um,
            pixel_size_um: self.cells.pixel_size.um(),
            pixel_size_source: self.cells.pixel_size_source,
            spacing_um: *spacing_um,
            fibres: FrameFibres {
                stain: self.settings.stain,
                read_pct: 100.0 * summary.share_from_picture,
                direction_deg: self.read.direction_deg,
                alignment: self.read.alignment,
                sarcomere_um: summary.median_sarcomere_um,
                sarcomere_q1_um: quartiles.map(|[first, _]| first),
                sarcomere_q3_um: quartiles.map(|[_, third]| third),
                sarcomere_doubt: summary.sarcomere_doubt,
            },
            notes: self.warnings(),
        }
    }

    fn overlay(&self) -> Result<Figure, FigureError> {
        let (places, report) = (&self.read.places, self.report());
        let ticks: Vec<Tick> = places.iter().map(overlay::tick).collect();
        let lengths: Vec<f64> = places.iter().filter_map(|(_, place)| place.sarcomere_um).collect();
        let sarcomeres = report.fibres.sarcomere_um.map(|median_um| Sarcomeres {
            lengths_um: &lengths,
            median_um,
            read_pct: report.fibres.read_pct,
        });
        overlay::of_frame(&self.picture, &self.cells, &ticks, sarcomeres, &report.notes)
    }
}

impl Outcome for FieldOfView {
    fn numbers(&self) -> impl Serialize {
        self.report()
    }

    fn warnings(&self) -> Vec<String> {
        let notes = self.cells.notes.iter().cloned();
        notes.chain(self.read.note().map(str::to_owned)).collect()
    }

    fn save(&self, folder: &Folder, _: &dyn Observer) -> Result<(), ExperimentError> {
        let is_doubtful = self.read.doubtful_lengths();
        let places = self.read.places.iter();
        let rows: Vec<FibreRow> =
            places.map(|(point_um, place)| row(*point_um, place, &is_doubtful)).collect();
        folder.write(FILE, to_csv(&[("frame", rows)])?)?;
        folder.write("overlay.png", self.overlay()?.to_png(DPI)?)?;
        folder.write("report.json", json::pretty(&self.report())?)
    }
}
