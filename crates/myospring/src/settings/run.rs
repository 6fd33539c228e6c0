//! A run: everything checked, in internal units, every default filled in.

use super::adhesion::{self, AdhesionError};
use super::calcium::{self, CalciumError, Calibration};
use super::conductivity::{self, ConductivityError};
use super::content::{self, ContentError};
use super::fibres::{Asked, FibreDirection, FibreReport, Fibres, FibresError};
use super::models::{FromFile, Models};
use super::places::FromPlaces;
use super::problem::Problem;
use super::sarcomeres::{self, SarcomereError};
use super::shape::{Shape, Shaped, Source};
use super::shown::Shown;
use super::steady::{self, CacheError};
use super::tension::{self, TensionError};
use super::tissue::TissueSettings;
use crate::cell::given_tension::TensionClock;
use crate::cell::pacing::Protocol;
use crate::cell::solve::SolverSettings;
use crate::cell::{CellModel, TensionKind, coelho_2021};
use crate::exchange::{Coupling, TissueError};
use crate::interruption::Interruption;
use crate::mechanics::active::ActiveLaw;
use crate::mechanics::area::AreaLaw;
use crate::mechanics::material::{Material, default_material};
use crate::mechanics::support::SupportKind;
use crate::mesh::outline::Outline;
use crate::mesh::quality::{MeshReport, long_axis};
use crate::mesh::thick::Thick;
use crate::mesh::{Mesh, built_in};
use crate::microscopy::cells::{PictureCell, PictureCells};
use crate::microscopy::outlines::trace::{Edge, trace_mask};
use crate::microscopy::segment::Modality;
use crate::simulation::{Numerics, Simulation, StretchFelt};
use std::io;
use std::path::Path;
use std::sync::Arc;

/// Default peak tension, kPa: the largest of `coelho_2021`, Fig. 6.
const PEAK_TENSION: f64 = 50.0;
/// Default time from the last stimulus to the end of a run, ms: the paper's 600 ms.
const AFTER_LAST_STIMULUS: f64 = 550.0;

/// A run ready to be meshed and simulated.
#[derive(Clone)]
pub struct Run {
    /// The cell models that `cell.model` may name.
    pub models: Models,
    /// How the file of the cell model is read.
    pub from_file: FromFile,
    /// Title, for people; may be empty.
    pub title: String,
    /// The cell model with its parameters.
    pub cell: Arc<dyn CellModel>,
    /// The table of prescribed calcium, as written, if given.
    pub calcium: Option<String>,
    /// Calibration of a ratio in that table.
    pub calibration: Calibration,
    /// The table of a prescribed tension, as written, if given.
    pub tension: Option<String>,
    /// From when the times of that table count; `None` is from each stimulus.
    pub tension_clock: Option<TensionClock>,
    /// Largest change over ten beats at which pacing before the run ends; `None` starts from the
    /// model's initial state.
    pub steady_state: Option<f64>,
    /// Folder in which steady states are stored; empty for none.
    pub steady_state_cache: String,
    /// Peak of the active tension, kPa; ignored for a model whose tension is in kPa.
    pub peak_tension: f64,
    /// Stimuli.
    pub protocol: Protocol,
    /// The cell's shape.
    pub shape: Shape,
    /// Passive properties of the cell.
    pub material: Material,
    /// How the tension acts.
    pub active: ActiveLaw,
    /// Direction of the fibres.
    pub fibre: FibreDirection,
    /// Angle by which the fibres of a thick cell turn from its lowest to its highest point, degrees.
    pub helix_angle: f64,
    /// Which stretch acts on the cell model, if it depends on stretch.
    pub stretch_felt: StretchFelt,
    /// Content of myofibrils in each place; from a picture, order times coverage of its fibres,
    /// relative to the mean over the cell, and 0 where it shows none.
    pub myofibril_content: FromPlaces,
    /// Length of the sarcomeres at rest in each place: the reference if uniform; from a picture,
    /// with the value of the nearest place where it shows none.
    pub sarcomere_length: FromPlaces,
    /// Length of the sarcomere at which the cell model's stretch is 1, um; ignored if all have it.
    pub sarcomere_reference: Option<f64>,
    /// Speed at which stimuli travel along the cell, um/ms; `None` for everywhere at once.
    pub wave_speed: Option<f64>,
    /// How the cells of a tissue stimulate each other; `None` for one cell.
    pub tissue: Option<TissueSettings>,
    /// The support of the cell.
    pub support: SupportKind,
    /// The file that says where the cell adheres to a gel, as written; `None` is as the gel says.
    pub adhesion: Option<String>,
    /// Distance between clamped ends before the beat, relative to the cell at rest.
    pub end_stretch: f64,
    /// Numerical settings.
    pub numerics: Numerics,
    /// Time simulated, ms.
    pub duration: f64,
    /// What may end the work on it early: pacing, fibres, preparation and the run itself; of its picture, too, by
    /// [`Run::interrupted_by`]. No file has it.
    pub interruption: Interruption,
    /// What was assumed where the settings are silent, and a person should know.
    pub assumed: Vec<String>,
}

/// A run with its mesh.
pub struct MeshedRun {
    /// The simulation, ready to be built.
    pub simulation: Simulation,
    /// Report on the mesh, with warnings on the picture and the fibres.
    pub report: MeshReport,
    /// The outline, um, rotated if requested; for a mask, the smooth outline of its pixels.
    /// [`Carried::rings`](crate::mesh::carried::Carried::rings) moves it with the mesh.
    pub outline: Outline,
    /// The fibres, and what the picture shows of them.
    pub fibres: Fibres,
    /// The picture with its cells, and the chosen one.
    pub picture: Option<(PictureCells, PictureCell)>,
    /// Of a stack of slices, the brightest of each place, and the cell in it.
    pub above: Option<(PictureCells, PictureCell)>,
}

impl MeshedRun {
    /// What the picture or the stack shows of the fibres, where there is one.
    pub fn fibres_of_picture(&self) -> Option<FibreReport> {
        let sought = self.fibres.slices.is_some() || self.fibres.not_read.is_some();
        (self.picture.is_some() || sought).then(|| self.fibres.report())
    }
}

/// Quantities that vary over a cell, as lists over the triangles of its mesh, or over its nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct Places {
    /// Direction of the fibres, unit vectors ([`FibreDirection::on`]).
    pub fibres: Vec<[f64; 2]>,
    /// Their direction in the tetrahedra of a thick cell ([`Fibres::in_space`]); `None` is that of the triangles below.
    pub fibres_in_space: Option<Vec<[f64; 3]>>,
    /// Content of myofibrils; `None` is 1 everywhere.
    pub myofibril_content: Option<Vec<f64>>,
    /// Stretch of the myofilaments in the cell at rest; `None` is 1 everywhere.
    pub resting_stretch: Option<Vec<f64>>,
    /// How strongly each node adheres to a gel; `None` is 1 everywhere.
    pub adhesion: Option<Vec<f64>>,
    /// How the cells of a tissue are coupled ([`Run::coupling`]); `None` is one cell.
    pub tissue: Option<Coupling>,
}

/// Why a simulation cannot be made from a shape.
#[derive(Debug, thiserror::Error)]
pub enum MakeError {
    /// The picture shows no fibres.
    #[error(transparent)]
    Fibre(#[from] FibresError),
    /// The content of myofibrils cannot be read.
    #[error(transparent)]
    Content(#[from] ContentError),
    /// Where the tissue conducts cannot be read.
    #[error(transparent)]
    Conductivity(#[from] ConductivityError),
    /// Where the cell adheres cannot be read.
    #[error(transparent)]
    Adhesion(#[from] AdhesionError),
    /// The cell does not reach a steady state.
    #[error(transparent)]
    Steady(#[from] CacheError),
    /// The length of sarcomeres cannot be read.
    #[error(transparent)]
    Sarcomere(#[from] SarcomereError),
    /// The course of calcium or tension cannot be read.
    #[error(transparent)]
    Driven(#[from] DrivenError),
    /// The file of the cell model can no longer be read.
    #[error("the cell model: {0}")]
    Model(Problem),
    /// The cells cannot be coupled.
    #[error(transparent)]
    Tissue(#[from] TissueError),
}

/// Why a prescribed course of calcium or tension cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum DrivenError {
    /// That of calcium.
    #[error(transparent)]
    Calcium(#[from] CalciumError),
    /// That of tension.
    #[error(transparent)]
    Tension(#[from] TensionError),
}

impl Run {
    /// The run of an empty run file: the built-in cell, with a beat as in `coelho_2021`.
    pub fn default_run() -> Self {
        let cell = coelho_2021::model();
        let protocol = Protocol::once(cell.default_stimulus());
        let numerics = Numerics::default();
        Self {
            models: Models::default(),
            from_file: FromFile::default(),
            title: String::new(),
            cell: Arc::new(cell),
            calcium: None,
            calibration: Calibration::default(),
            tension: None,
            tension_clock: None,
            steady_state: None,
            steady_state_cache: String::new(),
            peak_tension: PEAK_TENSION,
            protocol,
            shape: Shape {
                source: Source::BuiltIn(&built_in::CELLS[0]),
                rotate: 0.0,
                spacing: None,
                any_size: false,
                form: None,
            },
            material: default_material(),
            active: ActiveLaw::Fibre,
            fibre: FibreDirection::Auto(Asked::default()),
            helix_angle: 0.0,
            stretch_felt: StretchFelt::Cell,
            myofibril_content: FromPlaces::Uniform,
            sarcomere_length: FromPlaces::Uniform,
            sarcomere_reference: None,
            wave_speed: None,
            tissue: None,
            support: SupportKind::MassCentre,
            adhesion: None,
            end_stretch: 1.0,
            duration: usual_duration(&protocol, &numerics),
            numerics,
            interruption: Interruption::default(),
            assumed: Vec::new(),
        }
    }

    /// Whether the cell model's tension is relative, so that it is scaled to the peak tension.
    pub(crate) fn has_relative_tension(&self) -> bool {
        matches!(self.cell.tension_kind(), TensionKind::Relative { .. })
    }

    /// Strength of its cell, for a legend: the peak tension to which it is scaled, or the model's
    /// name if its tension is in kPa.
    ///
    /// # Example
    /// ```
    /// use myospring::run_file::RunFile;
    /// let strength = |text| Ok::<_, myospring::run_file::RunFileError>(RunFile::from_text(text)?.resolve()?.strength());
    /// assert_eq!(strength("")?, "50 kPa");
    /// assert_eq!(strength("[cell]\nmodel = \"land_2017\"")?, "land_2017");
    /// # Ok::<(), myospring::run_file::RunFileError>(())
    /// ```
    pub fn strength(&self) -> String {
        if self.has_relative_tension() {
            format!("{} kPa", self.peak_tension)
        } else {
            self.cell.name().to_owned()
        }
    }

    /// Default duration of this run, ms: 550 ms after the last stimulus.
    pub(crate) fn usual_duration(&self) -> f64 {
        usual_duration(&self.protocol, &self.numerics)
    }

    /// The same run, all of whose work ends early once `interruption` asks for it, that on its picture included.
    #[must_use]
    pub fn interrupted_by(mut self, interruption: &Interruption) -> Self {
        self.interruption = interruption.clone();
        if let Some(picture) = self.shape.source.picture_mut() {
            picture.options.segmentation.interruption = interruption.clone();
        }
        self
    }

    /// Makes the simulation of this run on a meshed shape, with fibres and content of myofibrils
    /// from pictures and tables; `read` reads a file by its name as written.
    ///
    /// # Errors
    /// Fibres that cannot be read from the picture, or a file of contents or adhesions that does not fit.
    ///
    /// # Example
    /// ```
    /// use myospring::run_file::RunFile;
    /// let run = RunFile::from_text("[numerics]\nintegrator = \"quasi-static\"")?.resolve()?;
    /// let read = |file: &str| std::fs::read(file);
    /// let shaped = run.shape.mesh(&run.shape.bytes(read)?)?;
    /// let made = run.make(shaped, read)?;
    /// let outcome = made.simulation.build()?.run(|_progress| true);
    /// assert!(outcome.beats()[0].value("peak_shortening").unwrap() > 11.9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn make(
        &self,
        shaped: Shaped,
        read: impl Fn(&str) -> io::Result<Vec<u8>>,
    ) -> Result<MeshedRun, MakeError> {
        let mut shaped = shaped;
        if let Some((cells, _)) = &mut shaped.picture {
            cells.interruption = self.interruption.clone();
        }
        let fibres = self.fibres(&shaped)?;
        let Shaped { mesh, thick, mut report, outline, picture, stack } = shaped;
        report.warnings.extend(fibres.warnings.iter().cloned());
        let cells = picture.as_ref().map(|(cells, _)| cells);
        let chosen = self.shape.source.picture().map(|picture| &picture.options.selection);
        let content = match &self.myofibril_content {
            FromPlaces::Uniform => None,
            FromPlaces::Picture => {
                let (content, warning) = content::of_fibres(&fibres, &mesh)?;
                report.warnings.extend(warning);
                Some(content)
            }
            FromPlaces::File(path) => {
                let (content, warning) =
                    content::read_content(path, &mesh, cells.zip(chosen), &read)?;
                report.warnings.extend(warning);
                Some(content)
            }
        };
        let adhesion = match (&self.adhesion, self.support) {
            (Some(path), SupportKind::Gel(gel)) => {
                let gives_way = gel.adhesion_stiffness.is_some();
                let (adhesion, warnings) =
                    adhesion::read_adhesion(path, &mesh, cells.zip(chosen), gives_way, &read)?;
                report.warnings.extend(warnings);
                Some(adhesion)
            }
            _ => None,
        };
        let reference = self.sarcomere_reference.unwrap_or(f64::NAN);
        let lengths = &self.sarcomere_length;
        let stretch = sarcomeres::resting_stretch(lengths, reference, &mesh, &fibres, &read)?;
        let (resting_stretch, told) = stretch.unzip();
        report.warnings.extend(told);
        let (cell, warning) = self.driven(&read)?;
        report.warnings.extend(warning);
        report.warnings.extend(self.wave_warning(report.dimensions.length_um));
        let turned =
            thick.as_ref().and_then(|thick| fibres.in_space(thick, self.helix_angle.to_radians()));
        let mut tissue = self.coupling(report.spacing_um)?;
        let scar = self.tissue.as_ref().and_then(|tissue| tissue.conductivity.as_ref());
        if let (Some(path), Some(coupling)) = (scar, &mut tissue) {
            let (relative, warning) =
                conductivity::read_conductivity(path, &mesh, cells.zip(chosen), &read)?;
            report.warnings.extend(warning);
            coupling.conduction.relative = Some(relative);
        }
        let places = Places {
            fibres: fibres.directions.clone(),
            fibres_in_space: turned,
            myofibril_content: content,
            resting_stretch,
            adhesion,
            tissue,
        };
        let (start_state, warning) = self.start_state(&cell)?;
        report.warnings.extend(warning);
        let simulation = Simulation { cell, start_state, ..self.simulation(mesh, thick, places) };
        // The pixels of a mask give the exact area, but the outline of a cell has no steps.
        let of_mask = picture.as_ref().filter(|(cells, _)| {
            cells.segmentation().is_some_and(|found| found.modality == Modality::Mask)
        });
        let smooth = of_mask.and_then(|(_, cell)| trace_mask(&cell.mask, Edge::Smooth).ok());
        let outline = smooth.unwrap_or(outline);
        let above = stack.and_then(|stack| stack.seen.clone());
        Ok(MeshedRun { simulation, report, outline, fibres, picture, above })
    }

    /// Whether the settings say how far the fibres turn through the thickness; otherwise the slices of a stack show it.
    pub(super) fn states_turn(&self) -> bool {
        let shown =
            self.shape.slices().is_some() && matches!(self.fibre, FibreDirection::Picture(_));
        self.shape.is_thick() && !shown
    }

    /// The fibres of a cell. Those of a stack are not read from its slices if the angle is stated by which they turn.
    ///
    /// # Errors
    /// Fibres that cannot be read.
    pub fn fibres(&self, shaped: &Shaped) -> Result<Fibres, FibresError> {
        let turned = self.helix_angle != 0.0;
        let shown = shaped.shown().filter(|shown| !(turned && matches!(shown, Shown::Stack(_))));
        self.fibre.on(&shaped.mesh, shown)
    }

    /// The cell model with its published parameters.
    ///
    /// # Errors
    /// A model that is not known by its name, or a file that can no longer be read.
    pub fn published_cell(&self) -> Result<Arc<dyn CellModel>, Problem> {
        self.models.model(Models::name_of(&*self.cell), &self.from_file)
    }

    /// The cell model with calcium or tension from a table, and a warning if there is one; `read`
    /// reads a file by its name as written. Without a table, the model is unchanged.
    ///
    /// # Errors
    /// A model that computes what the table prescribes, or an invalid table.
    pub fn driven(
        &self,
        read: impl Fn(&str) -> io::Result<Vec<u8>>,
    ) -> Result<(Arc<dyn CellModel>, Option<String>), DrivenError> {
        match (&self.calcium, &self.tension) {
            (Some(path), _) => Ok(calcium::with_calcium(&self.cell, path, self.calibration, read)?),
            (None, Some(path)) => {
                let (clock, modulus) =
                    (self.tension_clock.unwrap_or_default(), self.material.young_modulus());
                Ok(tension::with_tension(&self.cell, path, clock, modulus, read)?)
            }
            (None, None) => Ok((Arc::clone(&self.cell), None)),
        }
    }

    /// The initial state of a cell model that is paced before the run, and a warning if there is
    /// one.
    ///
    /// # Errors
    /// A cell that does not become steady, or a folder for it that cannot be written.
    pub fn start_state(
        &self,
        cell: &Arc<dyn CellModel>,
    ) -> Result<(Option<Vec<f64>>, Option<String>), CacheError> {
        let Some(tolerance) = self.steady_state else { return Ok((None, None)) };
        let folder = Some(&self.steady_state_cache).filter(|folder| !folder.is_empty());
        let (protocol, settings) = (self.protocol, self.cell_settings());
        let folder = folder.map(Path::new);
        let (found, told) =
            steady::steady_state(cell, protocol, settings, tolerance, folder, &self.interruption)?;
        Ok((Some(found.state), told))
    }

    /// How the cells of a tissue are coupled on a lattice of this spacing, um; `None` for one cell.
    ///
    /// A wanted velocity is that of cells with published parameters, so that changed parameters, such as those of a drug, change it.
    ///
    /// # Errors
    /// Cells that cannot be coupled, and a velocity at which no wave goes along this lattice.
    pub fn coupling(&self, spacing: f64) -> Result<Option<Coupling>, MakeError> {
        let Some(tissue) = &self.tissue else { return Ok(None) };
        let cell = self.published_cell().map_err(MakeError::Model)?;
        Ok(Some(tissue.coupling(&cell, self.cell_settings(), spacing)?))
    }

    /// A warning if the run ends before the wave has left the cell.
    fn wave_warning(&self, length_um: f64) -> Option<String> {
        let across = length_um / self.wave_speed?;
        let Protocol { start_ms, beats, .. } = self.protocol;
        let needed = self.usual_duration() + across;
        (beats > 0 && start_ms + across + AFTER_LAST_STIMULUS > self.duration).then(|| {
            format!(
                "the wave takes {across:.0} ms along the cell and the run ends at {} ms, before its far end has \
                 relaxed; give a duration of {:.0} ms",
                self.duration,
                (needed / 50.0).ceil() * 50.0
            )
        })
    }

    /// Makes the simulation of this run on a mesh with quantities by place, without reading files;
    /// the cell model must already have its calcium ([`Run::driven`]).
    pub fn simulation(&self, mesh: Mesh, thick: Option<Arc<Thick>>, places: Places) -> Simulation {
        let Places {
            fibres,
            fibres_in_space,
            myofibril_content,
            resting_stretch,
            adhesion,
            tissue,
        } = places;
        let long_axis = long_axis(&mesh);
        Simulation {
            cell: Arc::clone(&self.cell),
            stretch_felt: self.stretch_felt,
            activation: None,
            myofibril_content,
            resting_stretch,
            wave_speed: self.wave_speed,
            tissue,
            stepper: None,
            interruption: self.interruption.clone(),
            start_state: None,
            protocol: self.protocol,
            peak_tension: self.peak_tension,
            long_axis,
            fibres,
            mesh,
            thick,
            fibres_in_space,
            material: self.material.clone(),
            active: self.active,
            support: self.support,
            adhesion,
            end_stretch: self.end_stretch,
            duration: self.duration,
            numerics: self.numerics.clone(),
        }
    }

    /// How the cell model is integrated: as is set, or as is usual for the model.
    pub fn cell_settings(&self) -> SolverSettings {
        let usual = || SolverSettings::usual(&*self.cell, self.tissue.is_some());
        self.numerics.cell.unwrap_or_else(usual)
    }

    /// The integration of the cell model, to change it. A run without its own gets the usual settings first.
    pub(crate) fn cell_settings_mut(&mut self) -> &mut SolverSettings {
        let usual = self.cell_settings();
        self.numerics.cell.get_or_insert(usual)
    }

    /// Times of the stimuli that fall within the run, ms.
    pub fn stimulus_times(&self) -> Vec<f64> {
        self.protocol.stimulus_times().take_while(|time| *time < self.duration).collect()
    }

    /// Time of the extra stimulus S2, ms, if it is within the run.
    pub fn s2_ms(&self) -> Option<f64> {
        self.protocol.s2_ms().filter(|time| *time < self.duration)
    }

    /// All warnings, the mesh's own first.
    pub fn warnings(&self, mesh: &MeshReport) -> Vec<String> {
        let mut warnings = mesh.warnings.clone();
        warnings.extend(self.assumed.iter().cloned());
        let size = &mesh.dimensions;
        let critical = self.material.buckling_tension(size.length_um, size.mean_width_um);
        let free = self.support == SupportKind::MassCentre;
        if self.active == ActiveLaw::Ends && free && self.peak_tension > critical {
            warnings.push(format!(
                "active = \"ends\" presses with {} kPa on a strip that buckles above about \
                 {critical:.1} kPa (Euler); active = \"fibre\" does not",
                self.peak_tension
            ));
        }
        if self.material.area_law == AreaLaw::Printed {
            warnings.push(format!(
                "area_law = \"printed\" contracts a resting cell and collapses it from about a \
                 third of Young's modulus on: area_modulus is {} kPa, Young's modulus {} kPa; \
                 area_law = \"gradient\" keeps the area",
                self.material.area_modulus,
                self.material.young_modulus()
            ));
        }
        let Protocol { start_ms, beats, cycle_length_ms, s2_interval_ms, .. } = self.protocol;
        let between = if beats > 1 { cycle_length_ms } else { 0.0 };
        let between = between.max(s2_interval_ms.unwrap_or(0.0));
        let (rest_ms, longest) = (start_ms.max(between), self.cell.longest_rest_ms());
        if beats > 0 && rest_ms > longest {
            warnings.push(format!(
                "the cell rests for {rest_ms} ms; after more than {longest} ms the next beat of {} is known to be \
                 wrong: weaker, where measured muscle is stronger",
                self.cell.name()
            ));
        }
        let is_prescribed = self.cell.stimulation().moves.is_empty();
        if s2_interval_ms.is_some() && is_prescribed && self.cell.given_peak().is_none() {
            warnings.push(format!(
                "the calcium of {} is prescribed and restarts at S2 with full size, however early S2 comes: \
                 S2 changes only the myofilaments; tor_ord_land computes calcium",
                self.cell.name()
            ));
        }
        if beats > 0 && start_ms >= self.duration {
            warnings.push(format!(
                "the run ends at {} ms, before the first stimulus at {start_ms} ms: the cell stays \
                 at rest",
                self.duration
            ));
        }
        warnings
    }
}

fn usual_duration(protocol: &Protocol, numerics: &Numerics) -> f64 {
    let Protocol { start_ms, beats, cycle_length_ms, s2_interval_ms, .. } = *protocol;
    let last = f64::from(beats.saturating_sub(1)) * cycle_length_ms + s2_interval_ms.unwrap_or(0.0);
    let exchange = numerics.exchange_interval;
    // The authors' stimulus is one of their steps before 50 ms; the run still lasts 600 ms.
    ((start_ms + last + AFTER_LAST_STIMULUS) / exchange).ceil() * exchange
}
