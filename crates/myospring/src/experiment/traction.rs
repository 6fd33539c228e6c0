//! Tractions from displacements of a gel: force, contractile moment and energy over time, and maps.
//!
//! # Example
//! ```
//! use myospring::experiment::traction::Traction;
//! use myospring::experiment::{Experiment, Files};
//! use myospring::mechanics::gel::Gel;
//! use myospring::output::npz::{self, Array};
//!
//! // A gel that is drawn together in the middle of the window, in pixels.
//! let (rows, columns) = (40, 60);
//! let field = |along: usize| {
//!     (0..rows * columns).map(move |place| {
//!         let at = [(place % columns) as f64 - 30.0, (place / columns) as f64 - 20.0];
//!         -at[along] * (-(at[0] * at[0] + at[1] * at[1]) / 50.0).exp() * 0.2
//!     })
//! };
//! let array = |along| npz::to_npy(&Array::floats([rows, columns], field(along)));
//! let held = [("u.npy".to_owned(), array(0)), ("v.npy".to_owned(), array(1))];
//!
//! let description = Traction::of(["u.npy".into(), "v.npy".into()], 0.5, Gel::half_space(10.0));
//! let found = description.run(&Files::holding(held.into()), &())?;
//! let frame = &found.frames[0];
//! assert!(frame.force_nn > 3.0 * frame.noise_floor_nn && frame.contractile_moment_fj > 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use super::{Draw, Experiment, ExperimentError, Files, Folder, Observer, Outcome};
use crate::mechanics::gel::cytometry::{self, Tractions};
use crate::mechanics::gel::{Gel, Surface};
use crate::mesh::{Mesh, lattice};
use crate::microscopy::picture::Selection;
use crate::microscopy::read::read_picture;
use crate::output::field::Fields;
use crate::output::figure::{self, DrawnCell, FigureError, Theme};
use crate::output::json;
use crate::output::npz::{self, Array};
use crate::output::table::{Column, Table};
use crate::recording::{Frame, Recording, Sample, Signal, TRACTION_FORCE};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Smallest number of rows and of columns of a window.
const LEAST: usize = 8;
/// Columns or rows of a map, at most.
const DRAWN: usize = 128;
/// A force below this many times what noise alone makes is doubtful.
const DOUBTFUL: f64 = 2.0;

/// Finds the tractions that displaced a gel.
#[derive(Debug, Clone)]
pub struct Traction {
    /// NumPy arrays of the displacements to the right and downward, rows from the top: of rows and columns, or of frames, rows
    /// and columns.
    pub displacements: [PathBuf; 2],
    /// Distance of neighbouring places, um.
    pub pixel_size_um: f64,
    /// What a displacement of 1 is, um: the distance of places, unless stated.
    pub unit_um: Option<f64>,
    /// The gel; where a cell adheres to it is not used.
    pub gel: Gel,
    /// A picture of as many rows and columns: tractions are 0 where it is black.
    pub region: Option<PathBuf>,
    /// Frames a second.
    pub frame_rate_per_s: Option<f64>,
}

/// What was found.
#[derive(Debug, Clone)]
pub struct FoundTractions {
    /// One for each frame.
    pub frames: Vec<TractionFrame>,
    /// The tractions of each frame, rows from the lowest.
    pub tractions: Vec<Tractions>,
    gel: Gel,
    surfaces: Vec<Surface>,
    is_confined: bool,
}

/// The numbers of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TractionFrame {
    /// Number of the frame, from 0.
    pub frame: usize,
    /// Its time, ms, if the frame rate is known.
    pub t_ms: Option<f64>,
    /// Sum of the absolute tractions, nN.
    #[serde(rename = "traction_force_nN")]
    pub force_nn: f64,
    /// Minus the sum of traction times place, fJ: above 0 where the gel is drawn together.
    #[serde(rename = "contractile_moment_fJ")]
    pub contractile_moment_fj: f64,
    /// Half of the sum of traction times displacement, fJ.
    #[serde(rename = "gel_energy_fJ")]
    pub energy_fj: f64,
    /// The sum of absolute tractions that noise alone would make, nN.
    #[serde(rename = "noise_floor_nN")]
    pub noise_floor_nn: f64,
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
    smoothing_um_per_kpa: f64,
    definitions: BTreeMap<&'static str, &'static str>,
    warnings: Vec<String>,
}

const DEFINITIONS: [(&str, &str); 4] = [
    ("traction_force_nN", "sum of the absolute tractions, whatever their direction"),
    (
        "contractile_moment_fJ",
        "minus the sum of traction times place; above 0 where the gel is drawn together",
    ),
    ("gel_energy_fJ", "half of the sum of traction times displacement"),
    (
        "noise_floor_nN",
        "sum of absolute tractions that the noise of the displacements alone would make",
    ),
];

impl Traction {
    /// Of these arrays, with places at this distance (um), which is also what a displacement of 1 is.
    pub fn of(displacements: [PathBuf; 2], pixel_size_um: f64, gel: Gel) -> Self {
        Self {
            displacements,
            pixel_size_um,
            unit_um: None,
            gel,
            region: None,
            frame_rate_per_s: None,
        }
    }

    fn check(&self) -> Result<(), ExperimentError> {
        let Gel { modulus, poisson, thickness, .. } = self.gel;
        let positive = [
            ("the pixel size", Some(self.pixel_size_um), "um"),
            ("the unit of displacements", self.unit_um, "um"),
            ("Young's modulus of the gel", Some(modulus), "kPa"),
            ("the thickness of the gel", thickness, "um"),
            ("the frame rate", self.frame_rate_per_s, "/s"),
        ];
        for (what, value, unit) in positive {
            if let Some(value) = value.filter(|value| !(value.is_finite() && *value > 0.0)) {
                return Err(ExperimentError::new(format!(
                    "{what} is {value} {unit}; it must be above 0 {unit}"
                )));
            }
        }
        if !(0.0..0.5).contains(&poisson) {
            let message =
                format!("Poisson's ratio of the gel is {poisson}; it must be from 0 to below 0.5");
            return Err(
                ExperimentError::new(message).advise("0.49 stands for a gel that keeps its volume")
            );
        }
        Ok(())
    }

    /// The displacements of each frame, um.
    fn surfaces(&self, files: &Files) -> Result<Vec<Surface>, ExperimentError> {
        let [u, v] = [array(files, &self.displacements[0])?, array(files, &self.displacements[1])?];
        if u.shape() != v.shape() {
            let [first, second] = self.displacements.each_ref().map(|path| path.display());
            let message = format!(
                "`{first}` has the shape {:?} and `{second}` {:?}; both components of the displacement are needed in the same \
                 places",
                u.shape(),
                v.shape()
            );
            return Err(ExperimentError::new(message));
        }
        let shape = u.shape();
        let (rows, columns) = (shape[shape.len() - 2], shape[shape.len() - 1]);
        let unit = self.unit_um.unwrap_or(self.pixel_size_um);
        let (u, v) = (u.as_floats().unwrap_or_default(), v.as_floats().unwrap_or_default());
        let frames = u.chunks_exact(rows * columns).zip(v.chunks_exact(rows * columns));
        let surface = |(u, v): (&[f64], &[f64])| Surface {
            spacing: self.pixel_size_um,
            origin: [0.0; 2],
            shape: [columns, rows],
            // Rows from the lowest, and up is positive.
            displacements: [upward(u, columns, unit), upward(v, columns, -unit)],
        };
        Ok(frames.map(surface).collect())
    }

    /// Where tractions are sought, rows from the lowest.
    fn region(
        &self,
        files: &Files,
        shape: [usize; 2],
    ) -> Result<Option<Vec<bool>>, ExperimentError> {
        let Some(path) = &self.region else { return Ok(None) };
        let bytes = files.bytes(path).map_err(|error| ExperimentError::unread(path, &error))?;
        let name = path.display();
        let picture = read_picture(&bytes, &Selection::default())
            .map_err(|error| ExperimentError::new(format!("`{name}`: {error}")))?;
        let (plane, [columns, rows]) = (picture.plane, shape);
        if [plane.width(), plane.height()] != shape {
            let message = format!(
                "`{name}` has {} columns and {} rows, the displacements have {columns} and {rows}",
                plane.width(),
                plane.height()
            );
            return Err(
                ExperimentError::new(message).advise("scale it to one pixel for each displacement")
            );
        }
        let lit = (0..rows).rev().flat_map(|row| (0..columns).map(move |column| (column, row)));
        let region: Vec<bool> = lit.map(|(column, row)| plane.at(column, row) > 0.0).collect();
        if !region.contains(&true) {
            return Err(ExperimentError::new(format!(
                "`{name}` is black everywhere, so there is no region in it"
            )));
        }
        Ok(Some(region))
    }
}

/// The array of a file: floats of rows and columns, or of frames, rows and columns.
fn array(files: &Files, path: &Path) -> Result<Array, ExperimentError> {
    let bytes = files.bytes(path).map_err(|error| ExperimentError::unread(path, &error))?;
    let name = path.display();
    let advice = "save displacements as floats of rows and columns, or frames, rows and columns: numpy.save(\"u.npy\", \\
         numpy.ascontiguousarray(u, float))";
    let array = npz::from_npy(&bytes).filter(|array| array.as_floats().is_some());
    let array = array.ok_or_else(|| {
        ExperimentError::new(format!("`{name}` is no NumPy array of floats in the order of C"))
            .advise(advice)
    })?;
    let shape = array.shape();
    if !matches!(shape.len(), 2 | 3) || shape[shape.len() - 2..].iter().any(|count| *count < LEAST)
    {
        let message = format!(
            "`{name}` has the shape {shape:?}; displacements need rows and columns, at least {LEAST} each, or frames, \
             rows and columns"
        );
        return Err(ExperimentError::new(message).advise(advice));
    }
    let numbers = array.as_floats().unwrap_or_default();
    if let Some(at) = numbers.iter().position(|number| !number.is_finite()) {
        let (columns, rows) = (shape[shape.len() - 1], shape[shape.len() - 2]);
        let missing = numbers.iter().filter(|number| !number.is_finite()).count();
        let message = format!(
            "`{name}` has {} in row {}, column {} of frame {}, and {missing} such places in all",
            numbers[at],
            at / columns % rows,
            at % columns,
            at / (columns * rows)
        );
        return Err(
            ExperimentError::new(message).advise("fill them, for example from their neighbours")
        );
    }
    Ok(array)
}

/// Rows from the top as rows from the lowest, times a factor.
fn upward(values: &[f64], columns: usize, factor: f64) -> Vec<f64> {
    values.chunks_exact(columns).rev().flatten().map(|value| factor * value).collect()
}

impl Experiment for Traction {
    type Outcome = FoundTractions;

    fn run(
        &self,
        files: &Files,
        observer: &dyn Observer,
    ) -> Result<FoundTractions, ExperimentError> {
        self.check()?;
        let surfaces = self.surfaces(files)?;
        let moves = |axis: &Vec<f64>| axis.iter().any(|moved| *moved != axis[0]);
        if !surfaces.iter().flat_map(|surface| &surface.displacements).any(moves)
            && !surfaces.is_empty()
        {
            let [u, v] = self.displacements.each_ref().map(|path| path.display());
            let message =
                format!("nothing moves: all displacements in `{u}` are the same, and all in `{v}`");
            return Err(ExperimentError::new(message)
                .advise("check that the two arrays are those of the pulled gel"));
        }
        let Some(first) = surfaces.first() else {
            let name = self.displacements[0].display();
            return Err(ExperimentError::new(format!("`{name}` has no frames")));
        };
        let region = self.region(files, first.shape)?;
        observer.interruption().check().map_err(ExperimentError::new)?;
        let tractions = cytometry::tractions(&self.gel, &surfaces, region.as_deref())
            .map_err(ExperimentError::new)?;
        let all = first.shape[0] * first.shape[1];
        let places =
            region.as_ref().map_or(all, |region| region.iter().filter(|in_it| **in_it).count());
        let frame = |(frame, (surface, found)): (usize, (&Surface, &Tractions))| {
            let [x, y] = &found.tractions_pa;
            let area = surface.spacing * surface.spacing;
            let (mut moment, mut energy) = (0.0, 0.0);
            for place in 0..all {
                // 1 Pa um^2 is 1e-3 nN.
                let pull = [x[place], y[place]].map(|traction| 1e-3 * area * traction);
                let at = [place % surface.shape[0], place / surface.shape[0]]
                    .map(|at| surface.spacing * at as f64);
                moment -= pull[0] * at[0] + pull[1] * at[1];
                let [u, v] = &surface.displacements;
                energy += 0.5 * (pull[0] * u[place] + pull[1] * v[place]);
            }
            TractionFrame {
                frame,
                t_ms: self.frame_rate_per_s.map(|rate| 1e3 * frame as f64 / rate),
                force_nn: found.force_nn(surface.spacing, None),
                contractile_moment_fj: moment,
                energy_fj: energy,
                noise_floor_nn: found.noise_floor_nn(surface.spacing, places),
            }
        };
        let frames = surfaces.iter().zip(&tractions).enumerate().map(frame).collect();
        let is_confined = region.is_some();
        Ok(FoundTractions { frames, tractions, gel: self.gel, surfaces, is_confined })
    }
}

impl FoundTractions {
    /// The frame of the largest force.
    ///
    /// # Panics
    /// Never: there is at least one frame.
    pub fn strongest(&self) -> &TractionFrame {
        let frames = self.frames.iter();
        let strongest = frames.reduce(|a, b| if b.force_nn > a.force_nn { b } else { a });
        strongest.unwrap_or_else(|| unreachable!("there is a frame"))
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
            column("contractile_moment_fJ", &|frame| Some(frame.contractile_moment_fj)),
            column("gel_energy_fJ", &|frame| Some(frame.energy_fj)),
            column("noise_floor_nN", &|frame| Some(frame.noise_floor_nn)),
        ]);
        Table { columns }.for_people()
    }

    /// The tractions of all frames as they were read: rows from the top, down is positive.
    fn arrays(&self) -> [(&'static str, Array); 2] {
        let [columns, rows] = self.surfaces[0].shape;
        let of = |axis: usize, sign: f64| {
            let frames = self.tractions.iter();
            let values = frames.flat_map(|found| upward(&found.tractions_pa[axis], columns, sign));
            Array::floats([self.tractions.len(), rows, columns], values)
        };
        [("traction_x_Pa", of(0, 1.0)), ("traction_y_Pa", of(1, -1.0))]
    }

    fn figure(&self) -> Result<figure::Figure, FigureError> {
        let Surface { spacing, shape, .. } = self.surfaces[0];
        // As many as the eye can distinguish.
        let step = (shape[0].max(shape[1])).div_ceil(DRAWN);
        let [columns, rows] = shape.map(|count| count / step);
        let spacing = step as f64 * spacing;
        let nothing = |_| FigureError::Nothing { what: "places" };
        let mesh: Mesh = lattice::rectangle(columns - 1, rows - 1, spacing).map_err(nothing)?;
        let fibres = vec![[1.0, 0.0]; mesh.simplices.len()];
        let at = self.strongest().frame;
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
        let frame = Frame {
            t_ms: self.frames[at].t_ms.unwrap_or(f64::NAN),
            ta_kpa: f64::NAN,
            ta_by_triangle_kpa: None,
            on_gel_nn: Some(forces),
            positions: mesh.points.clone(),
        };
        let time = |frame: &TractionFrame| frame.t_ms.unwrap_or(frame.frame as f64);
        let samples = self.frames.iter().map(|frame| Sample { t_ms: time(frame), ..Sample::STILL });
        let force = Signal {
            name: TRACTION_FORCE.to_owned(),
            unit: "nN".to_owned(),
            values: self.frames.iter().map(|frame| frame.force_nn).collect(),
        };
        let recording =
            Recording { samples: samples.collect(), frames: vec![frame], signals: vec![force] };
        let fields = Fields::new(&mesh, &fibres, None)?;
        figure::traction(&DrawnCell::new(fields, None)?, &recording, &[])
    }
}

impl Outcome for FoundTractions {
    fn numbers(&self) -> impl Serialize {
        let strongest = self.strongest();
        let found = &self.tractions[strongest.frame];
        Numbers {
            frames: self.frames.len(),
            gel: self.gel,
            pixel_size_um: self.surfaces[0].spacing,
            confined_to_a_region: self.is_confined,
            largest_force: strongest,
            shortest_wave_um: found.shortest_wave_um,
            displacement_noise_um: found.noise_um,
            smoothing_um_per_kpa: found.smoothing,
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
                 region, a picture of the cell, to have those of the cell alone"
                    .to_owned(),
            );
        }
        if force < DOUBTFUL * floor {
            warnings.push(format!(
                "the largest force, {force:.3} nN, is less than {DOUBTFUL} times what noise of the displacements alone would \
                 make, {floor:.3} nN: it may be noise"
            ));
        }
        if strongest.contractile_moment_fj < 0.0 {
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
        folder.write("tractions.npz", npz::to_bytes(&self.arrays())?)?;
        let figures: [(&str, Draw<'_>); 1] = [("traction", &|| self.figure())];
        folder.figures(Theme::default(), &figures, observer)
    }
}
