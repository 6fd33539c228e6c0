//! What differs between a flat cell and a thick one; all else of a run is the same for any number of axes.

use super::Simulation;
use super::thickness::ThicknessMeter;
use crate::integrate::engine::{EngineError, EngineUsed, Task};
use crate::integrate::stepper::Stepper;
use crate::mechanics::active::Myofibrils;
use crate::mechanics::material::{assemble, assemble_thick};
use crate::mechanics::support::Attachment;
use crate::mechanics::{Body, System, Vectors};
use crate::mesh::Mesh;
use crate::mesh::thick::Thick;
use std::borrow::Cow;
use std::sync::Arc;

/// A motion, and the engine that makes it.
type Moved<'a, const D: usize> = (Box<dyn Stepper<D> + 'a>, EngineUsed);

/// A simulation of a cell with `D` axes, made of simplices with `N` corners.
pub(super) trait Space<const D: usize, const N: usize> {
    /// The mesh at rest.
    fn body_mesh(&self) -> &Mesh<D, N>;

    /// The long axis.
    fn axis(&self) -> [f64; D];

    /// Fibre direction in each simplex.
    fn directions(&self) -> Cow<'_, [[f64; D]]>;

    /// A number for each simplex, from one for each triangle of the cell as it is seen from above.
    fn by_simplex<'a>(&self, of_triangles: &'a [f64]) -> Cow<'a, [f64]>;

    /// The mean number in each of those triangles, from one for each simplex.
    fn by_triangle(&self, of_simplices: &[f64]) -> Vec<f64>;

    /// The body at rest and all forces on it, under this support.
    fn assemble(&self, support: Attachment<'_>, length: f64) -> (Body<D>, System<D>);

    /// A gauge of what only a thick cell has.
    fn thickness(&self) -> Option<ThicknessMeter>;

    /// Positions of the nodes of the cell as it is seen from above.
    fn seen_from_above<'a>(&self, positions: &'a Vectors<D>) -> Cow<'a, Vectors>;

    /// Forces on the nodes of the cell as it is seen from above: the sums over those above each.
    fn added_from_above(&self, forces: Vectors<D>) -> Vectors;

    /// Vectors with three axes, if there are so many.
    fn with_three_axes(&self, vectors: &Vectors<D>) -> Option<Vectors<3>>;

    /// What moves a body by the engine of the settings.
    fn moved<'a>(
        &'a self,
        system: &'a System<D>,
        body: &'a Body<D>,
        time_step: f64,
        uniform_tension: bool,
    ) -> Result<Moved<'a, D>, EngineError>;
}

impl Space<2, 3> for Simulation {
    fn body_mesh(&self) -> &Mesh {
        &self.mesh
    }

    fn axis(&self) -> [f64; 2] {
        self.long_axis
    }

    fn directions(&self) -> Cow<'_, [[f64; 2]]> {
        Cow::Borrowed(&self.fibres)
    }

    fn by_simplex<'a>(&self, of_triangles: &'a [f64]) -> Cow<'a, [f64]> {
        Cow::Borrowed(of_triangles)
    }

    fn by_triangle(&self, of_simplices: &[f64]) -> Vec<f64> {
        of_simplices.to_vec()
    }

    fn assemble(&self, support: Attachment<'_>, length: f64) -> (Body, System) {
        let content = self.myofibril_content.as_deref();
        let myofibrils = Myofibrils { directions: &self.fibres, content };
        let Self { mesh, material, active, long_axis, .. } = self;
        assemble(mesh, material, *active, myofibrils, support, *long_axis, length)
    }

    fn thickness(&self) -> Option<ThicknessMeter> {
        None
    }

    fn seen_from_above<'a>(&self, positions: &'a Vectors) -> Cow<'a, Vectors> {
        Cow::Borrowed(positions)
    }

    fn added_from_above(&self, forces: Vectors) -> Vectors {
        forces
    }

    fn with_three_axes(&self, _vectors: &Vectors) -> Option<Vectors<3>> {
        None
    }

    fn moved<'a>(
        &'a self,
        system: &'a System,
        body: &'a Body,
        time_step: f64,
        uniform_tension: bool,
    ) -> Result<Moved<'a, 2>, EngineError> {
        if let Some(make) = &self.stepper {
            return Ok((make(system, body.clone(), time_step), EngineUsed::Own));
        }
        let (form, lattice) = (self.numerics.method.in_time(), self.mesh.lattice.as_ref());
        let task = Task { system, body, lattice, form, time_step, uniform_tension };
        self.numerics.engine.stepper(&task)
    }
}

/// What the tetrahedra of a thick cell have.
#[derive(Debug, Clone, PartialEq)]
pub struct InSpace {
    /// Direction of the fibres in each, unit vectors.
    pub fibres: Vec<[f64; 3]>,
    /// Content of myofibrils in each relative to that of the cell; `None` is 1 everywhere.
    pub myofibril_content: Option<Vec<f64>>,
}

impl Simulation {
    /// What the tetrahedra of a thick cell have; `None` of a flat one.
    pub fn in_space(&self) -> Option<InSpace> {
        self.thick.as_ref()?;
        let content = self.myofibril_content.as_deref();
        Some(InSpace {
            fibres: Space::<3, 4>::directions(self).into_owned(),
            myofibril_content: content
                .map(|content| Space::<3, 4>::by_simplex(self, content).into_owned()),
        })
    }

    /// The thickness of a cell that is known to have one.
    fn thick(&self) -> &Arc<Thick> {
        self.thick.as_ref().unwrap_or_else(|| unreachable!("a flat cell has two axes"))
    }
}

impl Space<3, 4> for Simulation {
    fn body_mesh(&self) -> &Mesh<3, 4> {
        &self.thick().mesh
    }

    fn axis(&self) -> [f64; 3] {
        let [x, y] = self.long_axis;
        [x, y, 0.0]
    }

    fn directions(&self) -> Cow<'_, [[f64; 3]]> {
        match &self.fibres_in_space {
            Some(directions) => Cow::Borrowed(directions),
            None => Cow::Owned(self.thick().turned(&self.fibres, 0.0)),
        }
    }

    fn by_simplex<'a>(&self, of_triangles: &'a [f64]) -> Cow<'a, [f64]> {
        Cow::Owned(self.thick().of_triangles(of_triangles))
    }

    fn by_triangle(&self, of_simplices: &[f64]) -> Vec<f64> {
        self.thick().to_triangles(of_simplices, self.mesh.simplices.len())
    }

    fn assemble(&self, support: Attachment<'_>, length: f64) -> (Body<3>, System<3>) {
        let directions = Space::<3, 4>::directions(self);
        let content = self.myofibril_content.as_deref();
        let content = content.map(|content| Space::<3, 4>::by_simplex(self, content));
        let myofibrils = Myofibrils { directions: &directions, content: content.as_deref() };
        let (mesh, axis) = (&self.thick().mesh, Space::<3, 4>::axis(self));
        let adhesion = support.adhesion.map(|adhesion| self.thick().of_nodes(adhesion));
        let support = Attachment { adhesion: adhesion.as_deref(), ..support };
        assemble_thick(mesh, &self.material, myofibrils, support, axis, length)
    }

    fn thickness(&self) -> Option<ThicknessMeter> {
        Some(ThicknessMeter::new(self.thick(), &self.mesh, self.long_axis))
    }

    fn seen_from_above<'a>(&self, positions: &'a Vectors<3>) -> Cow<'a, Vectors> {
        Cow::Owned(self.thick().seen_from_above(positions))
    }

    fn added_from_above(&self, forces: Vectors<3>) -> Vectors {
        let columns = &self.thick().columns;
        let sum = |axis: usize, column: &Vec<u32>| {
            column.iter().map(|&node| forces[axis][node as usize]).sum::<f64>()
        };
        [0, 1].map(|axis| columns.iter().map(|column| sum(axis, column)).collect())
    }

    fn with_three_axes(&self, vectors: &Vectors<3>) -> Option<Vectors<3>> {
        Some(vectors.clone())
    }

    fn moved<'a>(
        &'a self,
        system: &'a System<3>,
        body: &'a Body<3>,
        time_step: f64,
        uniform_tension: bool,
    ) -> Result<Moved<'a, 3>, EngineError> {
        let (form, lattice) = (self.numerics.method.in_time(), self.thick().mesh.lattice.as_ref());
        let task = Task { system, body, lattice, form, time_step, uniform_tension };
        self.numerics.engine.stepper(&task)
    }
}
