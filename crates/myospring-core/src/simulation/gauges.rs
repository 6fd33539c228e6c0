//! What is measured where something outside holds the cell, the force at held ends, the tractions on a gel; and of a thick cell.

use super::thickness::ThicknessMeter;
use crate::cell::Output;
use crate::mechanics::{Configuration, System, Vectors, product, zeros};
use crate::recording::{AXIAL_FORCE, CONTRACTILE_MOMENT, END_FORCE, GEL_ENERGY, TRACTION_FORCE};
use std::sync::Arc;

/// Largest number of values.
pub(super) const GAUGES: usize = 8;

/// The gauges of a cell.
#[derive(Debug, Clone)]
pub(super) struct Gauges {
    /// Of a thick cell.
    pub(super) thickness: Option<Arc<ThicknessMeter>>,
    /// The nodes at its upper end, if both ends are held.
    pub(super) end: Option<Vec<usize>>,
    /// Whether it adheres to an elastic body.
    pub(super) adheres: bool,
    /// Its long axis.
    pub(super) axis: [f64; 2],
}

impl Gauges {
    /// Names, units and meanings of what they tell.
    fn told(&self) -> impl Iterator<Item = [&'static str; 3]> {
        let end = [END_FORCE, "nN", "force with which the cell draws its ends inward"];
        let gel = [
            [
                TRACTION_FORCE,
                "nN",
                "sum of the absolute tractions of the cell on the gel, in its plane",
            ],
            [
                AXIAL_FORCE,
                "nN",
                "force along the long axis with which the halves of the cell draw the gel together",
            ],
            [
                CONTRACTILE_MOMENT,
                "fJ",
                "minus the sum of traction times place at rest, above 0 where the cell pulls inward",
            ],
            [GEL_ENERGY, "fJ", "elastic energy of the gel"],
        ];
        let end = self.end.iter().map(move |_| end);
        let gel = gel.into_iter().filter(|_| self.adheres);
        end.chain(gel).chain(self.thickness.iter().flat_map(|_| ThicknessMeter::TOLD))
    }

    /// What they tell.
    pub(super) fn outputs(&self) -> Vec<Output> {
        let output = |[name, unit, meaning]: [&'static str; 3]| Output {
            name: name.into(),
            unit: unit.into(),
            meaning: meaning.into(),
        };
        self.told().map(output).collect()
    }

    /// The place of a gauge among them.
    pub(super) fn place(&self, name: &str) -> Option<usize> {
        self.told().position(|[known, ..]| known == name)
    }

    /// Their values; `pulls` are the forces of the cell on what it adheres to, nN, `area` its area seen from above, um^2.
    pub(super) fn read<const D: usize>(
        &self,
        system: &System<D>,
        at: &Configuration<'_, D>,
        pulls: Option<&Vectors<D>>,
        area: f64,
    ) -> Vec<f64> {
        let mut values = Vec::new();
        values.extend(self.end.as_ref().map(|nodes| self.end_force(nodes, system, at)));
        if let (Some(gel), Some(pulls)) = (system.compliance(), pulls) {
            let moved = gel.displacements(at.positions);
            let along = |[x, y]: [f64; 2]| x * self.axis[0] + y * self.axis[1];
            let rest = |place: usize, node: usize| {
                [0, 1].map(|axis: usize| at.positions[axis][node] - moved[axis][place])
            };
            let places = || gel.nodes().iter().copied().enumerate();
            let middle = places().map(|(place, node)| along(rest(place, node))).sum::<f64>()
                / gel.nodes().len() as f64;
            let (mut total, mut axial, mut moment) = (0.0, 0.0, 0.0);
            for (place, node) in places() {
                let pull = [0, 1].map(|axis: usize| pulls[axis][place]);
                let rest = rest(place, node);
                total += pull[0].hypot(pull[1]);
                // Linear in the tractions, so that noise of measured ones does not raise it.
                axial -= 0.5 * along(pull) * (along(rest) - middle).signum();
                moment -= pull[0] * rest[0] + pull[1] * rest[1];
            }
            let energy = 0.5 * product(pulls, &moved);
            values.extend([total, axial, moment, energy]);
        }
        values.extend(self.thickness.iter().flat_map(|meter| meter.read(at.positions, area)));
        values
    }

    /// As [`Gauges::read`], where the forces on what the cell adheres to are not known yet.
    pub(super) fn read_now<const D: usize>(
        &self,
        system: &System<D>,
        at: &Configuration<'_, D>,
        area: f64,
    ) -> Vec<f64> {
        let pulls = system.compliance().map(|gel| gel.forces(&gel.displacements(at.positions)));
        self.read(system, at, pulls.as_ref(), area)
    }

    /// Force with which the upper end is drawn inward, nN; negative where it is pushed out.
    fn end_force<const D: usize>(
        &self,
        nodes: &[usize],
        system: &System<D>,
        at: &Configuration<'_, D>,
    ) -> f64 {
        let mut forces = zeros(at.positions[0].len());
        for force in system.forces().filter(|force| force.is_internal()) {
            force.add_forces(at, &mut forces);
        }
        let along = |&node: &usize| forces[0][node] * self.axis[0] + forces[1][node] * self.axis[1];
        -nodes.iter().map(along).sum::<f64>()
    }
}
