//! A run: everything checked, in internal units, every default filled in.

use super::bounds::{self, Setting};
use super::shape::{Shape, Shaped, Source};
use super::{
    CellTable, IntegratorName, MaterialTable, MechanicsTable, NumericsTable, RunFile, RunTable,
    SegmentationTable, ShapeTable, StimulusKind, StimulusTable, SupportName, picture,
};
use crate::cell::pacing::{Protocol, Stimulus};
use crate::cell::{self, CellModel};
use crate::integrate::Method;
use crate::integrate::verlet::Integrator;
use crate::mechanics::active::ActiveLaw;
use crate::mechanics::area::AreaLaw;
use crate::mechanics::material::{Material, Stiffness};
use crate::mechanics::support::SupportKind;
use crate::mesh::Mesh;
use crate::mesh::quality::{MeshReport, long_axis};
use crate::microscopy::fibres::{FibreError, FibreField, FibreSettings};
use crate::microscopy::segment::Choice;
use crate::simulation::{Numerics, Simulation, TensionScale};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Direction of the fibres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fibre {
    /// Along the cell's long axis.
    LongAxis,
    /// At an angle counter-clockwise from x, degrees.
    Angle(f64),
    /// As the picture shows it; along the long axis where it shows nothing.
    Picture(FibreSettings),
}

/// A run ready to be meshed and simulated.
pub struct Run {
    /// Title, for people; may be empty.
    pub title: String,
    /// The cell model with its parameters.
    pub cell: Arc<dyn CellModel>,
    /// Peak of the active tension, kPa.
    pub peak_tension: f64,
    /// Whose peak is scaled to it.
    pub tension_scale: TensionScale,
    /// Stimuli.
    pub protocol: Protocol,
    /// The cell's shape.
    pub shape: Shape,
    /// What the cell is made of.
    pub material: Material,
    /// How the tension acts.
    pub active: ActiveLaw,
    /// Direction of the fibres.
    pub fibre: Fibre,
    /// What holds the cell.
    pub support: SupportKind,
    /// Numerical settings.
    pub numerics: Numerics,
    /// Time simulated, ms.
    pub duration: f64,
}

impl Run {
    /// The direction of the fibres in a picture, if that is where this run takes them from.
    ///
    /// # Errors
    /// A picture in which no myofibrils can be seen: its pixels are too coarse.
    pub fn fibre_field(&self, shaped: &Shaped) -> Result<Option<FibreField>, FibreError> {
        match (self.fibre, &shaped.picture) {
            (Fibre::Picture(settings), Some((cells, cell))) => {
                cells.fibres(cell, long_axis(&shaped.mesh), &settings).map(Some)
            }
            _ => Ok(None),
        }
    }

    /// The direction of the fibres in each triangle of a mesh, unit vectors: from the picture where it gave them.
    pub fn fibres(&self, mesh: &Mesh, field: Option<&FibreField>) -> Vec<[f64; 2]> {
        let everywhere = match (field, self.fibre) {
            (Some(field), _) => return field.on_mesh(mesh),
            (None, Fibre::Angle(degrees)) => {
                let (sine, cosine) = degrees.to_radians().sin_cos();
                [cosine, sine]
            }
            (None, Fibre::LongAxis | Fibre::Picture(_)) => long_axis(mesh),
        };
        vec![everywhere; mesh.simplices.len()]
    }

    /// The simulation of this run on a mesh, with the direction of its fibres where a picture gave it.
    ///
    /// # Errors
    /// None that a resolved run can cause: the cell model is made from parameters that were checked.
    pub fn simulation(
        &self,
        mesh: Mesh,
        field: Option<&FibreField>,
    ) -> Result<Simulation, crate::cell::ModelError> {
        let (long_axis, fibres) = (long_axis(&mesh), self.fibres(&mesh, field));
        Ok(Simulation {
            cell: self.cell.with_parameters(self.cell.parameters().clone())?,
            activation: None,
            myofibril_content: None,
            stepper: None,
            protocol: self.protocol,
            peak_tension: self.peak_tension,
            tension_scale: self.tension_scale,
            long_axis,
            fibres,
            mesh,
            material: self.material.clone(),
            active: self.active,
            support: self.support,
            duration: self.duration,
            numerics: self.numerics.clone(),
        })
    }

    /// Times of the stimuli that fall within the run, ms.
    pub fn stimulus_times(&self) -> Vec<f64> {
        self.protocol.stimulus_times().take_while(|time| *time < self.duration).collect()
    }

    /// What a person should look at, the mesh's own warnings first.
    pub fn warnings(&self, mesh: &MeshReport) -> Vec<String> {
        let mut warnings = mesh.warnings.clone();
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
                "area_law = \"printed\" pulls a resting cell together and collapses it from about a \
                 third of Young's modulus on: area_modulus is {} kPa, Young's modulus {} kPa; \
                 area_law = \"gradient\" keeps the area",
                self.material.area_modulus,
                self.material.young_modulus()
            ));
        }
        let Protocol { start_ms, beats, .. } = self.protocol;
        if beats > 0 && start_ms >= self.duration {
            warnings.push(format!(
                "the run ends at {} ms, before the first stimulus at {start_ms} ms: the cell stays \
                 at rest",
                self.duration
            ));
        }
        if self.material.slowest_period > 2.0 && self.numerics.method != Method::QuasiStatic {
            warnings.push(format!(
                "slowest_period = {} ms is above 2 ms: inertia may be seen in the contraction",
                self.material.slowest_period
            ));
        }
        warnings
    }

    /// The run file of this run with every default written out.
    ///
    /// Spacing and time step stay absent where the shape and the stability limit decide them.
    pub fn to_run_file(&self) -> RunFile {
        let (shape, segmentation) = self.shape_tables();
        RunFile {
            title: Some(self.title.clone()),
            cell: CellTable {
                model: Some(self.cell.name().to_owned()),
                peak_tension: Some(bounds::PEAK_TENSION.write(self.peak_tension)),
                tension_scale: Some(self.tension_scale),
                authors_step: None,
                method: Some(self.numerics.cell.method),
                step: Some(bounds::CELL_STEP.write(self.numerics.cell.step_ms)),
                parameters: self.changed_parameters(),
            },
            stimulus: self.stimulus_table(),
            shape,
            segmentation,
            material: self.material_table(),
            mechanics: self.mechanics_table(),
            numerics: self.numerics_table(),
            run: RunTable { duration: Some(bounds::DURATION.write(self.duration)) },
        }
    }

    /// The run file that repeats this run, with the spacing (um) and time step (ms) that it took;
    /// a quasi-static run takes none.
    pub fn settled(&self, spacing: f64, time_step: Option<f64>) -> RunFile {
        let mut file = self.to_run_file();
        file.shape.spacing = Some(bounds::SPACING.write(spacing));
        file.numerics.time_step = time_step.map(|step| bounds::TIME_STEP.write(step));
        file
    }

    /// Parameters that differ from the published ones, each in its own unit.
    fn changed_parameters(&self) -> BTreeMap<String, Setting> {
        let Ok(published) = cell::model(self.cell.name()) else { return BTreeMap::new() };
        let rows = self.cell.parameters().rows().iter();
        rows.filter(|row| published.parameters().get(&row.name) != Some(row.value))
            .map(|row| (row.name.to_string(), Setting::Number(row.value)))
            .collect()
    }

    fn stimulus_table(&self) -> StimulusTable {
        let (kind, amplitude, duration) = match self.protocol.stimulus {
            Stimulus::Jump { amplitude } => {
                (StimulusKind::Jump, bounds::JUMP.write(amplitude), None)
            }
            Stimulus::Pulse { amplitude, duration_ms } => (
                StimulusKind::Pulse,
                bounds::PULSE.write(amplitude),
                Some(bounds::PULSE_DURATION.write(duration_ms)),
            ),
        };
        StimulusTable {
            kind: Some(kind),
            amplitude: Some(amplitude),
            duration,
            start: Some(bounds::START.write(self.protocol.start_ms)),
            beats: Some(i64::from(self.protocol.beats)),
            cycle_length: Some(bounds::CYCLE_LENGTH.write(self.protocol.cycle_length_ms)),
        }
    }

    fn shape_tables(&self) -> (ShapeTable, SegmentationTable) {
        let Shape { source, rotate, spacing } = &self.shape;
        let mut table = ShapeTable {
            spacing: spacing.map(|spacing| bounds::SPACING.write(spacing)),
            ..ShapeTable::default()
        };
        let mut segmentation = SegmentationTable::default();
        if !matches!(source, Source::Picture { .. }) {
            table.rotate = Some(bounds::ROTATE.write(*rotate));
        }
        match source {
            Source::BuiltIn(cell) => table.built_in = Some(cell.name.to_owned()),
            Source::Outline { path, pixel_size, choice } => {
                table.outline = Some(path.clone());
                table.pixel_size = pixel_size.map(|size| bounds::PIXEL_SIZE.write(size));
                match choice {
                    Choice::Number(number) => {
                        segmentation.cell = Some(Setting::Text(number.to_string()));
                    }
                    Choice::Label(label) => table.label = Some(i64::from(*label)),
                    Choice::Largest | Choice::At(_) => {}
                }
            }
            Source::Picture(source) => segmentation = picture::write(source, &mut table),
        }
        (table, segmentation)
    }

    fn material_table(&self) -> MaterialTable {
        let Material {
            stiffness,
            thickness,
            area_law,
            area_modulus,
            damping_ratio,
            slowest_period,
            drag_ratio,
        } = self.material;
        let (young_modulus, spring_stiffness) = match stiffness {
            Stiffness::YoungModulus(value) => (Some(bounds::YOUNG_MODULUS.write(value)), None),
            Stiffness::Spring(value) => (None, Some(bounds::SPRING_STIFFNESS.write(value))),
        };
        MaterialTable {
            young_modulus,
            spring_stiffness,
            thickness: Some(bounds::THICKNESS.write(thickness)),
            area_law: Some(area_law),
            area_modulus: Some(bounds::AREA_MODULUS.write(area_modulus)),
            damping_ratio: Some(bounds::DAMPING_RATIO.write(damping_ratio)),
            slowest_period: Some(bounds::SLOWEST_PERIOD.write(slowest_period)),
            drag_ratio: Some(bounds::DRAG_RATIO.write(drag_ratio)),
        }
    }

    fn mechanics_table(&self) -> MechanicsTable {
        let (support, end_stiffness, bed_stiffness) = match self.support {
            SupportKind::MassCentre => (SupportName::MassCentre, None, None),
            SupportKind::ClampedEnd => (SupportName::ClampedEnd, None, None),
            SupportKind::ClampedEnds => (SupportName::ClampedEnds, None, None),
            SupportKind::SpringHeldEnds { stiffness } => {
                let stiffness = bounds::END_STIFFNESS.write(stiffness);
                (SupportName::SpringHeldEnds, Some(stiffness), None)
            }
            SupportKind::ElasticBed { stiffness } => {
                let stiffness = bounds::BED_STIFFNESS.write(stiffness);
                (SupportName::ElasticBed, None, Some(stiffness))
            }
        };
        let (stain, fibre_smoothing) = match self.fibre {
            Fibre::Picture(FibreSettings { stain, smoothing_um, .. }) => {
                (Some(stain), Some(bounds::FIBRE_SMOOTHING.write(smoothing_um)))
            }
            _ => (None, None),
        };
        MechanicsTable {
            active: Some(self.active),
            fibre: Some(match self.fibre {
                Fibre::LongAxis => Setting::Text("long axis".to_owned()),
                Fibre::Angle(degrees) => bounds::FIBRE.write(degrees),
                Fibre::Picture(_) => Setting::Text("picture".to_owned()),
            }),
            stain,
            fibre_smoothing,
            support: Some(support),
            end_stiffness,
            bed_stiffness,
        }
    }

    fn numerics_table(&self) -> NumericsTable {
        let numerics = &self.numerics;
        NumericsTable {
            integrator: Some(match numerics.method {
                Method::Verlet(Integrator::StoermerVerlet) => IntegratorName::Verlet,
                Method::Verlet(Integrator::VelocityVerlet) => IntegratorName::VelocityVerlet,
                Method::QuasiStatic => IntegratorName::QuasiStatic,
            }),
            time_step: numerics.time_step.map(|step| bounds::TIME_STEP.write(step)),
            exchange_interval: Some(bounds::EXCHANGE_INTERVAL.write(numerics.exchange_interval)),
            output_interval: Some(bounds::OUTPUT_INTERVAL.write(numerics.output_interval)),
            frame_interval: Some(bounds::FRAME_INTERVAL.write(numerics.frame_interval)),
        }
    }
}
