//! The common start of every run: assembled forces, an activation in its first state, a meter.

use super::check::check_strongest;
use super::fault::projected_area;
use super::gauges::Gauges;
use super::shared_cell::SharedCell;
use super::space::Space;
use super::{SetupError, Simulation};
use crate::analysis::shape::{self, Extent, ShapeMeter};
use crate::cell::pacing::Protocol;
use crate::cell::solve::SolveError;
use crate::cell::{self, TensionKind};
use crate::exchange::{
    Activation, ActivationBounds, ByTriangle, Coupling, Sites, Tissue, TissueCells, WholeCell,
};
use crate::integrate::quasi_static::{Path, PathError, Tolerance};
use crate::mechanics::active::FibreStretch;
use crate::mechanics::loaded_end::LoadedEnd;
use crate::mechanics::material::default_material;
use crate::mechanics::support::{Attachment, Support, SupportKind};
use crate::mechanics::{Body, Following, System, Tension, Vectors, add_scaled};
use crate::mesh::ends::{end_nodes, end_zones};
use crate::mesh::simplex::measure_at;
use crate::mesh::{Mesh, Simplex, SpringKind};
use std::sync::Arc;

/// The common start of every run.
pub(super) struct Setup<const D: usize = 2, const N: usize = 3> {
    pub(super) simulation: Simulation,
    pub(super) activation: Box<dyn Activation>,
    pub(super) assembly: Arc<Assembly<D>>,
    /// Bounds of the activation.
    pub(super) strongest: ActivationBounds,
    /// Tension of a default beat relative to that of the parameters that are scaled to the peak tension.
    pub(super) strength: f64,
    /// The stretch of sites in the triangles.
    pub(super) fibre_stretch: Option<FibreStretch<D, N>>,
    /// Resting volume of each triangle times its content of myofibrils, up to the thickness, um^2; of a tetrahedron um^3.
    pub(super) volumes: Vec<f64>,
}

/// How strong a cell model is.
struct Strength {
    /// kPa per unit of its tension.
    scale: f64,
    /// The highest tension of a default beat, kPa.
    strongest: f64,
    /// That, relative to the parameters that are scaled to the peak tension.
    relative: f64,
}

/// The shape before the cell pulls. `solve` finds it in a number of steps: first in one, then in 4 and in 16 if that fails.
pub(super) fn in_steps<T>(solve: impl Fn(u32) -> Result<T, SetupError>) -> Result<T, SetupError> {
    let mut found = solve(1);
    for steps in [4, 16] {
        if !matches!(found, Err(SetupError::NoPath(PathError::AtRest { .. }))) {
            break;
        }
        found = solve(steps);
    }
    found
}

/// The mesh with its forces and meter.
pub(super) struct Assembly<const D: usize = 2> {
    pub(super) body: Body<D>,
    pub(super) system: System<D>,
    pub(super) meter: ShapeMeter,
    pub(super) resting_length: f64,
    /// Length before the first beat, um: the resting one unless the ends are held stretched.
    pub(super) held_length: f64,
    /// The length within clamps, which neither stretches nor shortens, um.
    gripped_length: f64,
    pub(super) gauges: Gauges,
}

impl<const D: usize> Assembly<D> {
    /// Mean stretch of the cell between the clamps, at this length (um).
    pub(super) fn stretch(&self, length: f64) -> f64 {
        (length - self.gripped_length) / (self.resting_length - self.gripped_length)
    }

    /// Area of a body seen from above, um^2; `mesh` is that of a flat one.
    pub(super) fn area(&self, mesh: &Mesh, positions: &Vectors<D>) -> f64 {
        match &self.gauges.thickness {
            Some(meter) => meter.area(positions),
            None => projected_area(mesh, plane(positions)),
        }
    }

    /// Length along and width across the long axis, um, of a body seen from above.
    pub(super) fn measure(&self, positions: &Vectors<D>) -> Extent {
        self.meter.measure(plane(positions))
    }
}

/// Positions along the first two axes.
fn plane<const D: usize>(positions: &Vectors<D>) -> &Vectors {
    let plane = positions.first_chunk();
    plane.unwrap_or_else(|| unreachable!("a body has two axes or more"))
}

impl Simulation {
    /// Checks all settings and prepares the forces and the activation.
    pub(super) fn set_up<const D: usize, const N: usize>(&self) -> Result<Setup<D, N>, SetupError>
    where
        Self: Space<D, N>,
    {
        self.check()?;
        self.interruption.check()?;
        let assembly = Arc::new(self.assembled_at_rest()?);
        self.set_up_on(assembly, &SharedCell::of(self))
    }

    /// As [`Simulation::set_up`], after its checks, on forces that are already assembled, with what is known of the cell.
    pub(super) fn set_up_on<const D: usize, const N: usize>(
        &self,
        assembly: Arc<Assembly<D>>,
        known: &SharedCell,
    ) -> Result<Setup<D, N>, SetupError>
    where
        Self: Space<D, N>,
    {
        self.interruption.check()?;
        let volumes = self.volumes::<D, N>();
        let (activation, strength) = self.activation::<D, N>(known, &volumes)?;
        let strongest = activation.strongest();
        check_strongest(strongest)?;
        let field = matches!(activation.sites(), Sites::PerElement(_));
        Ok(Setup {
            activation,
            assembly,
            strongest,
            strength,
            fibre_stretch: field.then(|| FibreStretch::new(self.body_mesh(), &self.directions())),
            volumes,
            simulation: self.clone(),
        })
    }

    /// The activation, and its strength relative to that which is scaled to the peak tension.
    pub(super) fn activation<const D: usize, const N: usize>(
        &self,
        known: &SharedCell,
        volumes: &[f64],
    ) -> Result<(Box<dyn Activation>, f64), SetupError>
    where
        Self: Space<D, N>,
    {
        if let Some(activation) = &self.activation {
            return Ok((activation.boxed(), 1.0));
        }
        let failed = |error: SolveError| SetupError::CellModel {
            model: self.cell.name().to_owned(),
            cause: error.to_string(),
        };
        let Strength { scale, strongest, relative } = self.strength(known).map_err(failed)?;
        let strongest = ActivationBounds { tension: strongest, ..ActivationBounds::default() };
        let model = self.cell.clone();
        let settings = self.cell_settings();
        let start = self.start_state.as_deref();
        if let Some(coupling) = &self.tissue {
            return Ok((Box::new(self.coupled(coupling, scale)?), relative));
        }
        let resting = self.resting_stretch.as_deref().map(|stretch| self.by_simplex(stretch));
        if self.has_sites_in_triangles() {
            let protocols = self.protocols::<D, N>();
            let cells = ByTriangle::new(model, start, &protocols, settings, scale);
            let cells = cells.map_err(failed)?;
            let cells = match resting {
                Some(stretch) => cells.at_resting_stretch(&stretch).map_err(failed)?,
                None => cells,
            };
            return Ok((Box::new(cells), relative));
        }
        // The mean over the volume of the myofibrils.
        let resting = resting.map_or(1.0, |stretch| {
            let sum: f64 =
                stretch.iter().zip(volumes).map(|(stretch, volume)| stretch * volume).sum();
            sum / volumes.iter().sum::<f64>()
        });
        let cell = WholeCell::new(model, start, self.protocol, settings, scale, strongest);
        let cell = cell.map_err(failed)?.at_resting_stretch(resting);
        Ok((Box::new(cell.along(&known.course)), relative))
    }

    /// The cells of a tissue, whose potentials at both ends and in the middle of the long axis are outputs.
    fn coupled(&self, coupling: &Coupling, scale: f64) -> Result<Tissue, SetupError> {
        let Self { mesh, long_axis, fibres, .. } = self;
        let protocols = coupling.protocols(mesh, *long_axis, self.protocol);
        let cells = TissueCells {
            model: self.cell.clone(),
            state: self.start_state.as_deref(),
            protocols: &protocols,
            settings: self.cell_settings(),
            scale,
        };
        let refused =
            |cause: String| SetupError::CellModel { model: self.cell.name().to_owned(), cause };
        let failed = |error: SolveError| refused(error.to_string());
        let tissue = Tissue::new(mesh, fibres, &coupling.conduction, cells);
        let tissue = tissue.map_err(|error| refused(error.to_string()))?;
        let middle = [0, 1].map(|axis: usize| {
            let points = &mesh.points[axis];
            points.iter().sum::<f64>() / points.len() as f64
        });
        let along = |node: usize| {
            let [x, y] = mesh.point(node);
            (x - middle[0]) * long_axis[0] + (y - middle[1]) * long_axis[1]
        };
        let beside = |node: usize| {
            let [x, y] = mesh.point(node);
            ((y - middle[1]) * long_axis[0] - (x - middle[0]) * long_axis[1]).abs()
        };
        let [low, high] = (0..mesh.len())
            .map(along)
            .fold([0.0_f64; 2], |[low, high], at| [low.min(at), high.max(at)]);
        let nearest = |to: f64| {
            let away = |node: &usize| (along(*node) - to).hypot(beside(*node));
            (0..mesh.len()).min_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or_default()
        };
        let probes = [("potential_start", low), ("potential_middle", 0.0), ("potential_end", high)];
        let probes = probes.map(|(name, place)| (name, nearest(place))).to_vec();
        let tissue = tissue.with_outputs(probes, self.protocol.s2_ms());
        let tissue = match &self.resting_stretch {
            Some(stretch) => tissue.at_resting_stretch(stretch).map_err(failed)?,
            None => tissue,
        };
        Ok(match coupling.stretch_current {
            Some(current) => tissue.with_stretch_current(current),
            None => tissue,
        })
    }

    /// The protocol of each triangle: if the stimulus travels, it starts when it arrives.
    fn protocols<const D: usize, const N: usize>(&self) -> Vec<Protocol>
    where
        Self: Space<D, N>,
    {
        let mesh = self.body_mesh();
        let Some(speed) = self.wave_speed else {
            return vec![self.protocol; mesh.simplices.len()];
        };
        let along = |point: [f64; D]| point[0] * self.long_axis[0] + point[1] * self.long_axis[1];
        let points = (0..mesh.len()).map(|node| along(mesh.point(node)));
        let start = points.fold(f64::INFINITY, f64::min);
        let triangles = mesh.simplices.iter().map(|triangle| mesh.centre(triangle));
        let delay = |centre| (along(centre) - start) / speed;
        let delayed =
            |centre| Protocol { start_ms: self.protocol.start_ms + delay(centre), ..self.protocol };
        triangles.map(delayed).collect()
    }

    /// Mean stretch at rest over the volume of the myofibrils.
    pub(super) fn mean_resting_stretch(&self) -> f64 {
        let Some(stretch) = &self.resting_stretch else { return 1.0 };
        let volumes = self.volumes::<2, 3>();
        let sum: f64 = stretch.iter().zip(&volumes).map(|(stretch, volume)| stretch * volume).sum();
        sum / volumes.iter().sum::<f64>()
    }

    /// Resting volume of each triangle times its content of myofibrils, up to the thickness, um^2; of a tetrahedron um^3.
    pub(super) fn volumes<const D: usize, const N: usize>(&self) -> Vec<f64>
    where
        Self: Space<D, N>,
    {
        let mesh = self.body_mesh();
        let content = self.myofibril_content.as_deref().map(|content| self.by_simplex(content));
        let content = |element: usize| content.as_ref().map_or(1.0, |it| it[element]);
        let volume = |(element, simplex): (usize, &Simplex<N>)| {
            simplex.weight * measure_at(&mesh.points, simplex.nodes) * content(element)
        };
        mesh.simplices.iter().enumerate().map(volume).collect()
    }

    /// How strong the cell model is. With published parameters this needs no beat; tension in kPa
    /// is not scaled.
    fn strength(&self, known: &SharedCell) -> Result<Strength, SolveError> {
        let scaled = |peak: f64, highest: f64| Strength {
            scale: self.peak_tension / peak,
            strongest: self.peak_tension * (highest / peak).max(1.0),
            relative: highest / peak,
        };
        Ok(match self.cell.tension_kind() {
            TensionKind::Kilopascal => {
                let strongest = self.cell.given_peak().map_or_else(|| known.peak(), Ok)?;
                Strength { scale: 1.0, strongest, relative: 1.0 }
            }
            TensionKind::None => {
                return Err(SolveError::NoTension { model: self.cell.name().to_owned() });
            }
            TensionKind::Relative { published_peak } if cell::is_as_published(&*self.cell) => {
                scaled(published_peak, published_peak)
            }
            TensionKind::Relative { published_peak } => scaled(published_peak, known.peak()?),
        })
    }

    /// As [`Simulation::assembled`], in equilibrium with the held ends.
    pub(super) fn assembled_at_rest<const D: usize, const N: usize>(
        &self,
    ) -> Result<Assembly<D>, SetupError>
    where
        Self: Space<D, N>,
    {
        let mut assembly = self.assembled();
        if self.end_stretch == 1.0 {
            return Ok(assembly);
        }
        let rest = in_steps(|steps| self.stretched(&assembly, steps))?;
        assembly.held_length = assembly.measure(&rest).length;
        assembly.body.positions = rest;
        Ok(assembly)
    }

    /// Positions in equilibrium with the held ends, which are moved apart in steps, um.
    fn stretched<const D: usize, const N: usize>(
        &self,
        unstretched: &Assembly<D>,
        steps: u32,
    ) -> Result<Vectors<D>, SetupError>
    where
        Self: Space<D, N>,
    {
        let mut body = unstretched.body.clone();
        let mut drawn = body.positions.clone();
        for step in 1..=steps {
            let part = f64::from(step) / f64::from(steps);
            let before = drawn;
            drawn = self.drawn_out(1.0 + (self.end_stretch - 1.0) * part);
            if step == 1 {
                body.positions.clone_from(&drawn);
            } else {
                add_scaled(&mut body.positions, 1.0, &drawn);
                add_scaled(&mut body.positions, -1.0, &before);
            }
            let tolerance = Tolerance { longest_delay: f64::INFINITY, ..Tolerance::default() };
            let path = Path::start(&unstretched.system, &body, tolerance, &self.interruption)?;
            if let Some(rest) = path.positions(0.0) {
                body.positions = rest;
            }
        }
        Ok(body.positions)
    }

    /// Tolerances with any delay where no more than the usual damping causes it, which is numerical: no equilibrium depends on it.
    pub(super) fn accepting(&self, tolerance: Tolerance) -> Tolerance {
        let (own, usual) = (&self.material, default_material());
        let numerical = own.slowest_period.is_none()
            && own.damping_ratio <= usual.damping_ratio
            && own.drag_ratio <= usual.drag_ratio;
        Tolerance {
            longest_delay: if numerical { f64::INFINITY } else { tolerance.longest_delay },
            ..tolerance
        }
    }

    /// Resting positions with the rigid ends moved apart and the cell between them stretched
    /// uniformly, um.
    pub(super) fn drawn_out<const D: usize, const N: usize>(&self, stretch: f64) -> Vectors<D>
    where
        Self: Space<D, N>,
    {
        let (axis, mesh) = (self.axis(), self.body_mesh());
        let points = &mesh.points;
        let along: Vec<f64> =
            points[0].iter().zip(&points[1]).map(|(x, y)| x * axis[0] + y * axis[1]).collect();
        let [[_, low], [high, _]] = end_zones(mesh, axis);
        let apart = (stretch - 1.0) * shape::extent(plane(points), self.long_axis);
        let shift = |s: f64| apart * (((s - low) / (high - low)).clamp(0.0, 1.0) - 0.5);
        let moved =
            |k: usize| points[k].iter().zip(&along).map(|(x, s)| x + shift(*s) * axis[k]).collect();
        std::array::from_fn(moved)
    }

    /// The cell that has left its stop under this part of the load of an afterloaded contraction; `held` is it before.
    pub(super) fn loaded<const D: usize, const N: usize>(
        &self,
        held: &Assembly<D>,
        part: f64,
    ) -> Option<Assembly<D>>
    where
        Self: Space<D, N>,
    {
        let SupportKind::AfterloadedEnds { load } = self.support else { return None };
        let Assembly { meter, resting_length, held_length, gripped_length, gauges, .. } = held;
        let (mut body, mut system) =
            Space::assemble(self, SupportKind::ClampedEnd.into(), *resting_length);
        body.positions.clone_from(&held.body.positions);
        let spring = self.material.spring_stiffness(SpringKind::Axial);
        let load = part * load;
        let grip = LoadedEnd::new(self.body_mesh(), self.axis(), &body.positions, spring, load);
        system.passive.push(Box::new(grip));
        let (meter, gauges) = (meter.clone(), gauges.clone());
        Some(Assembly {
            body,
            system,
            meter,
            resting_length: *resting_length,
            held_length: *held_length,
            gripped_length: *gripped_length,
            gauges,
        })
    }

    /// The body at rest and all forces on it, for direct use; of a thick cell as if it were flat.
    pub fn mechanics(&self) -> (Body, System) {
        let Assembly { body, system, .. } = self.assembled::<2, 3>();
        (body, system)
    }

    pub(super) fn assembled<const D: usize, const N: usize>(&self) -> Assembly<D>
    where
        Self: Space<D, N>,
    {
        let mesh = self.body_mesh();
        let resting_length = shape::extent(plane(&mesh.points), self.long_axis);
        let attachment = Attachment { support: self.support, adhesion: self.adhesion.as_deref() };
        let (body, system) = Space::assemble(self, attachment, resting_length);
        // A free cell rotates with its mass; a cell with both ends clamped cannot rotate. A cell
        // clamped at one end swings aside as a whole.
        let areas = &mesh.areas;
        let meter = ShapeMeter::new(plane(&mesh.points).clone(), self.long_axis, areas);
        let depths = end_zones(mesh, self.axis()).map(|[from, to]| to - from);
        let gripped = match self.support {
            SupportKind::ClampedEnd => [depths[0], 0.0],
            SupportKind::ClampedEnds | SupportKind::AfterloadedEnds { .. } => depths,
            _ => [0.0; 2],
        };
        let meter = match &system.support {
            Support::Clamped(nodes) => {
                let mut held = vec![0.0; areas.len()];
                for &node in nodes {
                    held[node] = 1.0;
                }
                let meter = meter.turned_by(&held).gripped(gripped);
                if self.support == SupportKind::ClampedEnd {
                    meter.width_turned_by(areas)
                } else {
                    meter
                }
            }
            _ => meter,
        };
        let end = self.support.holds_both_ends().then(|| {
            let [_, nodes] = end_nodes(mesh, self.axis());
            nodes
        });
        let adheres = system.compliance().is_some();
        let thickness = self.thickness().map(Arc::new);
        let gauges = Gauges { thickness, end, adheres, axis: self.long_axis };
        let gripped_length = gripped[0] + gripped[1];
        let held_length = resting_length;
        Assembly { body, system, meter, resting_length, held_length, gripped_length, gauges }
    }
}

impl<const D: usize, const N: usize> Setup<D, N> {
    /// The sites of the activation.
    pub(super) fn sites(&self) -> Sites {
        self.activation.sites()
    }

    /// Calls a function with the strongest expected tension, in the form that the forces need.
    pub(super) fn under_strongest<T>(&self, what: impl FnOnce(Tension<'_>) -> T) -> T {
        let ActivationBounds { tension, per_stretch, per_rate } = self.strongest;
        match self.sites() {
            Sites::Whole => what(tension.into()),
            Sites::PerElement(count) => {
                let list = |value: f64| vec![value; count];
                let [tension, per_stretch, per_rate] = [tension, per_stretch, per_rate].map(list);
                what(Tension::Following(Following {
                    tension: &tension,
                    per_stretch: &per_stretch,
                    per_rate: &per_rate,
                    stretch: &list(1.0),
                    rate: &list(0.0),
                }))
            }
        }
    }
}
