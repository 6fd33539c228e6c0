//! The tractions that were found: numbers, tables, arrays, a map.

use super::beats::{self, BeatsReport, report};
use super::followed::Followed;
use super::frame::TractionFrame;
use super::measured::{Displacements, upward};
use super::page::{self, Shown};
use crate::experiment::analyse::AnalysedCurve;
use crate::experiment::{Draw, ExperimentError, Folder, Observer, Outcome};
use crate::measured::Curve;
use crate::mechanics::gel::cytometry::Tractions;
use crate::mechanics::gel::pull::PullAxis;
use crate::mechanics::gel::{Gel, Surface};
use crate::mesh::{Mesh, lattice};
use crate::output::field::Fields;
use crate::output::figure::{self, DrawnCell, FigureError, Theme};
use crate::output::json;
use crate::output::npz::{self, Array};
use crate::output::table::{Column, Table};
use crate::recording::{AXIAL_FORCE, Frame, Recording, Sample, Signal, TRACTION_FORCE};
use serde::Serialize;
use std::collections::BTreeMap;

/// Columns or rows of a map, at most.
const DRAWN: usize = 128;
/// A force below this many times what noise alone makes is doubtful.
const DOUBTFUL: f64 = 2.0;
/// Part of the places that may be interpolated without a warning, %.
const MANY_INTERPOLATED_PCT: f64 = 30.0;

/// What was found.
#[derive(Debug, Clone)]
pub struct FoundTractions {
    /// One for each frame.
    pub frames: Vec<TractionFrame>,
    /// The tractions of each frame, rows from the lowest.
    pub tractions: Vec<Tractions>,
    /// The direction in which the cell pulls; `None` where there are no tractions.
    pub axis: Option<PullAxis>,
    /// Beats of the axial force; `None` where times are not known.
    pub beats: Option<AnalysedCurve>,
    pub(super) gel: Gel,
    pub(super) measured: Displacements,
    pub(super) is_confined: bool,
}

/// summary.json.
#[derive(Serialize)]
struct Numbers<'a> {
    frames: usize,
    gel: Gel,
    pixel_size_um: f64,
    confined_to_a_region: bool,
    /// Of the frame of the largest force.
    largest_force: &'a TractionFrame,
    /// Waves shorter than this are damped to less than half.
    shortest_wave_um: f64,
    displacement_noise_um: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    beads: Option<&'a Followed>,
    /// Direction in which the cell pulls, degrees from the right toward the top of the picture, -90 to 90.
    axis_degrees: Option<f64>,
    smoothing_um_per_kpa: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    beats: Option<BeatsReport<'a>>,
    definitions: BTreeMap<&'static str, &'static str>,
    warnings: Vec<String>,
}

const DEFINITIONS: [(&str, &str); 6] = [
    ("traction_force_nN", "sum of the absolute tractions, whatever their direction"),
    (
        "axial_force_nN",
        "force across the middle of the cell along the direction in which it pulls most, from the frame of the largest \
         contractile moment: minus half of the sum of traction along it, times the sign of the place along it; above 0 where \
         the halves are pulled toward each other",
    ),
    (
        "contractile_moment_fJ",
        "minus the sum of traction times place; above 0 where the gel is drawn together",
    ),
    ("gel_energy_fJ", "half of the sum of traction times displacement"),
    (
        "noise_floor_nN",
        "sum of absolute tractions that the noise of the displacements alone would make",
    ),
    (
        "axial_noise_floor_nN",
        "standard deviation of the axial force that the noise of the displacements alone would make",
    ),
];

impl FoundTractions {
    /// The place, in the list of frames, of the frame of the largest force.
    pub fn strongest_at(&self) -> usize {
        let force = |at: &usize| self.frames[*at].force_nn;
        let all = 0..self.frames.len();
        all.reduce(|a, b| if force(&b) > force(&a) { b } else { a }).unwrap_or(0)
    }

    /// The frame of the largest force.
    pub fn strongest(&self) -> &TractionFrame {
        &self.frames[self.strongest_at()]
    }

    /// How displacements were found, if they were found in pictures of beads.
    pub fn followed(&self) -> Option<&Followed> {
        self.measured.followed.as_ref()
    }

    /// Distance of neighbouring places, um.
    pub fn spacing_um(&self) -> f64 {
        self.measured.surfaces[0].spacing
    }

    /// The axial force over time, where times are known.
    pub fn force(&self) -> Option<Curve> {
        beats::curve(&self.frames)
    }

    /// Displacements (um), then tractions (Pa), each to the right and downward: of frames, rows from the top, and columns.
    pub fn fields(&self) -> [Array; 4] {
        let [columns, rows] = self.measured.grid.shape;
        let array = |of: &dyn Fn(usize) -> Vec<f64>| {
            let count = self.frames.len();
            Array::floats([count, rows, columns], (0..count).flat_map(of))
        };
        let moved = |axis: usize, sign: f64| {
            array(&|at| upward(&self.measured.surfaces[at].displacements[axis], columns, sign))
        };
        let pulled = |axis: usize, sign: f64| {
            array(&|at| upward(&self.tractions[at].tractions_pa[axis], columns, sign))
        };
        [moved(0, 1.0), moved(1, -1.0), pulled(0, 1.0), pulled(1, -1.0)]
    }

    fn table(&self) -> Table {
        let column = |name: &str, of: &dyn Fn(&TractionFrame) -> Option<f64>| Column::Number {
            name: name.to_owned(),
            values: self.frames.iter().map(of).collect(),
        };
        let mut columns = vec![column("frame", &|frame| Some(frame.frame as f64))];
        if self.frames.iter().any(|frame| frame.t_ms.is_some()) {
            columns.push(column("t_ms", &|frame| frame.t_ms));
        }
        columns.extend([
            column("traction_force_nN", &|frame| Some(frame.force_nn)),
            column("axial_force_nN", &|frame| Some(frame.axial_force_nn)),
            column("contractile_moment_fJ", &|frame| Some(frame.contractile_moment_fj)),
            column("gel_energy_fJ", &|frame| Some(frame.energy_fj)),
            column("noise_floor_nN", &|frame| Some(frame.noise_floor_nn)),
            column("axial_noise_floor_nN", &|frame| Some(frame.axial_noise_floor_nn)),
        ]);
        if let Some(followed) = self.followed() {
            let column = |name: &str, values: Vec<f64>| Column::Number {
                name: name.to_owned(),
                values: values.into_iter().map(Some).collect(),
            };
            let stage = |axis: usize| followed.stage_um.iter().map(|by| by[axis]).collect();
            columns.extend([
                column("stage_x_um", stage(0)),
                column("stage_y_um", stage(1)),
                column("interpolated_pct", followed.interpolated_pct.clone()),
            ]);
        }
        Table { columns }.for_people()
    }

    /// The displacements in pixels of the pictures, as programs for traction-force microscopy have them: rows and columns, of
    /// films with the frames before them.
    fn in_pixels(&self) -> [Array; 2] {
        let [u, v, ..] = self.fields();
        [u, v].map(|array| {
            let pixel = self.measured.grid.pixel_um;
            let numbers = array.as_floats().unwrap_or_default().iter().map(|um| um / pixel);
            let from = usize::from(array.shape()[0] == 1);
            Array::floats(&array.shape()[from..], numbers)
        })
    }

    fn shown(&self) -> Shown<'_> {
        let found = &self.tractions[self.strongest_at()];
        Shown {
            frames: &self.frames,
            strongest: self.strongest(),
            beats: self.beats.as_ref(),
            // Why it is not drawn is a warning when it is saved.
            map: self.figure().ok(),
            gel: self.gel,
            is_confined: self.is_confined,
            followed: self.followed(),
            noise_um: found.noise_um,
            shortest_wave_um: found.shortest_wave_um,
            definitions: &DEFINITIONS,
            warnings: self.warnings(),
        }
    }

    fn figure(&self) -> Result<figure::Figure, FigureError> {
        let Surface { spacing, shape, .. } = self.measured.surfaces[0];
        // As many as the eye can distinguish.
        let step = (shape[0].max(shape[1])).div_ceil(DRAWN);
        let [columns, rows] = shape.map(|count| count / step);
        let spacing = step as f64 * spacing;
        let nothing = |_| FigureError::Nothing { what: "places" };
        let mesh: Mesh = lattice::rectangle(columns - 1, rows - 1, spacing).map_err(nothing)?;
        let fibres = vec![[1.0, 0.0]; mesh.simplices.len()];
        let at = self.strongest_at();
        let found = &self.tractions[at];
        let forces = found.tractions_pa.each_ref().map(|axis| {
            let mean = |place: usize| {
                let [left, low] = [place % columns, place / columns].map(|at| at * step);
                let block = (low..low + step)
                    .flat_map(|row| (left..left + step).map(move |column| row * shape[0] + column));
                block.map(|at| axis[at]).sum::<f64>() / (step * step) as f64
            };
            let means = mesh.areas.iter().enumerate();
            means.map(|(place, area)| 1e-3 * mean(place) * area).collect()
        });
        let t_ms = self.frames[at].t_ms.unwrap_or(f64::NAN);
        let still = Frame::new(t_ms, f64::NAN, mesh.points.clone());
        let frame = Frame { on_gel_nn: Some(forces), ..still };
        // Without times there is no curve, only the map.
        let timed: Vec<(f64, &TractionFrame)> =
            self.frames.iter().filter_map(|frame| Some((frame.t_ms?, frame))).collect();
        let samples = timed.iter().map(|(t_ms, _)| Sample { t_ms: *t_ms, ..Sample::STILL });
        let force = |name: &str, of: fn(&TractionFrame) -> f64| Signal {
            name: name.to_owned(),
            unit: "nN".to_owned(),
            values: timed.iter().map(|(_, frame)| of(frame)).collect(),
        };
        let signals = vec![
            force(TRACTION_FORCE, |frame| frame.force_nn),
            force(AXIAL_FORCE, |frame| frame.axial_force_nn),
        ];
        let recording = Recording {
            samples: samples.collect(),
            frames: vec![frame],
            signals,
            ..Recording::default()
        };
        let fields = Fields::new(&mesh, &fibres, None)?;
        figure::traction(&DrawnCell::new(fields, None)?, &recording, &[])
    }
}

impl Outcome for FoundTractions {
    fn numbers(&self) -> impl Serialize {
        let found = &self.tractions[self.strongest_at()];
        let degrees = |axis: PullAxis| axis.direction[1].atan2(axis.direction[0]).to_degrees();
        Numbers {
            frames: self.frames.len(),
            gel: self.gel,
            pixel_size_um: self.measured.surfaces[0].spacing,
            confined_to_a_region: self.is_confined,
            largest_force: self.strongest(),
            shortest_wave_um: found.shortest_wave_um,
            displacement_noise_um: found.noise_um,
            beads: self.followed(),
            axis_degrees: self.axis.map(degrees),
            smoothing_um_per_kpa: found.smoothing,
            beats: self.beats.as_ref().map(report),
            definitions: DEFINITIONS.into(),
            warnings: self.warnings(),
        }
    }

    fn warnings(&self) -> Vec<String> {
        let strongest = self.strongest();
        let (force, floor) = (strongest.force_nn, strongest.noise_floor_nn);
        let mut warnings = Vec::new();
        if !self.is_confined {
            warnings.push(
                "force, moment and energy are sums over the whole window and include false tractions at its edges; give a \
                 film, a picture or outlines of the cell to have those of the cell alone"
                    .to_owned(),
            );
        }
        if force < DOUBTFUL * floor {
            warnings.push(format!(
                "the largest force, {force:.3} nN, is less than {DOUBTFUL} times what noise of the displacements alone would \
                 make, {floor:.3} nN: it may be noise"
            ));
        }
        let interpolated = self.followed().map_or(0.0, |followed| followed.interpolated_pct_most);
        if interpolated > MANY_INTERPOLATED_PCT {
            warnings.push(format!(
                "in a frame {interpolated:.0} % of the displacements were not found but interpolated from their neighbours; \
                 larger squares (subset) are found more often"
            ));
        }
        if self.followed().is_some_and(|followed| followed.interrupted) {
            warnings.push(format!("interrupted: {} frames were followed", self.frames.len()));
        }
        // Without a region, false tractions at the edges of the window may decide the sign.
        if self.is_confined && strongest.contractile_moment_fj < 0.0 {
            warnings.push(
                "the gel is pushed apart at the largest force, not drawn together: are the displacements from the relaxed \
                 gel to the pulled one, and is the second array downward positive?"
                    .to_owned(),
            );
        }
        warnings
    }

    fn save(&self, folder: &Folder, observer: &dyn Observer) -> Result<(), ExperimentError> {
        folder.write("traction.csv", self.table().to_csv()?)?;
        folder.write("summary.json", json::pretty(&self.numbers())?)?;
        folder.write("report.html", page::html(self.shown())?)?;
        let [.., x, y] = self.fields();
        folder.write(
            "tractions.npz",
            npz::to_bytes(&[("traction_x_Pa", x), ("traction_y_Pa", y)])?,
        )?;
        if self.followed().is_some() {
            let [u, v] = self.in_pixels();
            folder.write("u.npy", npz::to_npy(&u))?;
            folder.write("v.npy", npz::to_npy(&v))?;
        }
        let figures: [(&str, Draw<'_>); 1] = [("traction", &|| self.figure())];
        folder.figures(Theme::default(), &figures, observer)
    }
}
