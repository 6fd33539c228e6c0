//! Cells that stimulate each other: the potential spreads from one to the next (monodomain).
//!
//! ```text
//! dV/dt = div(D grad V) + (dV/dt of the cell alone),   no flux through the rim
//! ```
//!
//! Each node of the mesh has a cell. A step is split as `strang_1968` does: half a step of spreading, a step of every cell alone, half a
//! step of spreading; it is of second order if the cell's own method is. The potential spreads over the shape at rest. Stretch may open
//! channels ([`StretchCurrent`]), whose current flows while the potential spreads; it is that of the last shape of the mesh, or foretold from
//! the last ones for cells that feel stretch. Such a cell has the mean of its triangles, and its crossbridges follow it as those of a cell alone
//! ([`super::crossbridges`]).

use super::diffusion::{Conduction, Diffusion, Room};
use super::felt::{Channels, Pull, at_nodes};
use super::local_beats::Followed;
use super::members::Members;
use super::tips::Tips;
use super::{
    Activation, ActivationBounds, ActivationError, ActivationTangent, Sites, StretchCurrent,
    StretchState,
};
use crate::cell::pacing::Protocol;
use crate::cell::solve::{SolveError, SolverSettings};
use crate::cell::{CellModel, Input, Output};
use crate::mechanics::Tension;
use crate::mesh::Mesh;
use crate::mesh::lattice::LatticeError;
use crate::recording::{LocalBeat, WaveTip};
use std::sync::Arc;

/// A cell counts as activated when its potential rises above this: -40 mV, or half of a dimensionless potential that has no
/// millivolts.
const ACTIVATED_MV: f64 = -40.0;
const ACTIVATED: f64 = 0.5;
/// Reversal potential of stretch-activated channels where the potential is dimensionless (`panfilov_2007`).
const REVERSAL: f64 = 1.0;
/// Steps end at a requested time up to this part of a step.
const SAME: f64 = 1e-6;

/// Why there is no tissue.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TissueError {
    /// A cell, its protocol or its settings.
    #[error(transparent)]
    Cell(#[from] SolveError),
    /// A conduction that is negative or not finite.
    #[error("conduction {name} the fibres is {value} um^2/ms; it must be at least 0")]
    Conduction {
        /// Along or across.
        name: &'static str,
        /// Its value, um^2/ms.
        value: f64,
    },
    /// A relative conduction that is negative or not finite.
    #[error(
        "the conduction of triangle {triangle} is {value} times the usual one; it must be at least 0"
    )]
    Relative {
        /// The triangle.
        triangle: usize,
        /// Its value.
        value: f64,
    },
    /// A model whose potential is not a state, or whose stretch acts by other ways than crossbridges.
    #[error("cells of `{model}` cannot be coupled: {why}")]
    Model {
        /// Its name.
        model: String,
        /// Why not.
        why: &'static str,
    },
    /// A lattice without waves of that velocity.
    #[error(
        "no wave with a conduction velocity of {velocity_cm_per_s:.3} cm/s goes along a lattice of {spacing} um: it would be narrower \
         than the spacing; take a lattice of about {most:.1} um, or a faster wave (across the fibres a smaller velocity ratio)"
    )]
    NoWave {
        /// The velocity, cm/s.
        velocity_cm_per_s: f64,
        /// The spacing, um.
        spacing: f64,
        /// A spacing at which there is one, um.
        most: f64,
    },
    /// A strip on which the velocity is measured.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// Protocols or fibres for another mesh.
    #[error("there are {found} {what} for {expected}")]
    Count {
        /// What.
        what: &'static str,
        /// How many.
        found: usize,
        /// How many are needed.
        expected: usize,
    },
}

/// The cells of a tissue.
#[derive(Clone)]
pub struct TissueCells<'a> {
    /// The model of all.
    pub model: Arc<dyn CellModel>,
    /// Their state at 0 ms; `None` is the model's initial one.
    pub state: Option<&'a [f64]>,
    /// The stimuli of each node.
    pub protocols: &'a [Protocol],
    /// Integration, with fixed steps ([`SolverSettings::coupled`]).
    pub settings: SolverSettings,
    /// kPa per unit of the model's tension.
    pub scale: f64,
}

/// Coupled cells, one at each node of a mesh, all of the same model; the tension of a triangle is the mean of its corners.
///
/// # Example
/// A wave along a strip of 6 mm, and its velocity:
/// ```
/// use myospring::cell::{CellModel, bueno_orovio_2008::{Variant, model}};
/// use myospring::cell::pacing::Protocol;
/// use myospring::cell::solve::{CellMethod, SolverSettings};
/// use myospring::exchange::{Activation, Conduction, Tissue, TissueCells};
/// use myospring::prelude::*;
/// use std::sync::Arc;
///
/// let mesh = lattice::rectangle(24, 2, 250.0)?;
/// let fibres = vec![[1.0, 0.0]; mesh.simplices.len()];
/// let model = model(Variant::Epi);
/// let left = |node: usize| mesh.point(node)[0] < 600.0;
/// let beat = Protocol { start_ms: 0.0, ..Protocol::once(model.default_stimulus()) };
/// let protocols: Vec<Protocol> =
///     (0..mesh.len()).map(|node| if left(node) { beat } else { Protocol::rest() }).collect();
/// let settings = SolverSettings { method: CellMethod::ForwardEuler, step_ms: 0.02, ..SolverSettings::default() };
/// let cells = TissueCells { model: Arc::new(model), state: None, protocols: &protocols, settings, scale: 50.0 };
/// let mut strip = Tissue::new(&mesh, &fibres, &Conduction::even(1.171e5), cells)?;
/// strip.reach(15.0)?;
/// let at = |x: f64| (0..mesh.len()).find(|node| mesh.point(*node) == [x, 250.0]).unwrap();
/// let beats = strip.local_beats().unwrap();
/// let [from, to] = [1500.0, 4500.0].map(|x| beats[at(x)][0].activated_ms);
/// let velocity_cm_per_s = 0.1 * 3000.0 / (to - from);
/// assert!((65.0..75.0).contains(&velocity_cm_per_s));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct Tissue {
    model: Arc<dyn CellModel>,
    /// `None` where nothing spreads.
    diffusion: Option<Arc<Diffusion>>,
    kept: Cells,
    moved: Cells,
    /// The corners of each triangle.
    corners: Arc<Vec<[u32; 3]>>,
    scale: f64,
    tension: Vec<f64>,
    strongest: ActivationBounds,
    settings: SolverSettings,
    /// The state that spreads.
    place: usize,
    /// Nodes whose potential is an output, each with its name.
    probes: Vec<(&'static str, usize)>,
    stimulus_times_ms: Vec<f64>,
    s2_ms: Option<f64>,
    channels: Option<Channels>,
    pull: Option<Pull>,
    room: Room,
}

/// The cells at one time.
#[derive(Clone)]
struct Cells {
    members: Members,
    time_ms: f64,
    followed: Followed,
    tips: Tips,
}

impl Tissue {
    /// Cells coupled by a conduction; `fibres` has a unit vector for each triangle.
    ///
    /// # Errors
    /// A conduction below 0, lists of another length, a model whose potential is not one of its states or that feels stretch by other ways than the crossbridges of `land_2017`, a protocol
    /// or settings that it cannot follow, and a method with other than fixed steps.
    pub fn new(
        mesh: &Mesh,
        fibres: &[[f64; 2]],
        conduction: &Conduction,
        cells: TissueCells<'_>,
    ) -> Result<Self, TissueError> {
        let TissueCells { model, state, protocols, settings, scale } = cells;
        check(mesh, fibres, conduction, protocols)?;
        let refused = |why| TissueError::Model { model: model.name().to_owned(), why };
        let place = model.stimulation().moves.first().map(|moved| moved.state);
        let place = place.ok_or_else(|| refused("it has no potential that could spread"))?;
        let state = state.map_or_else(|| model.initial_state(), <[f64]>::to_vec);
        let pull = model
            .feels_stretch()
            .then(|| {
                let pull = Pull::new(&*model, &state, mesh.len(), mesh.simplices.len());
                pull.ok_or_else(|| {
                    refused(
                        "it feels stretch, but not by the crossbridges of land_2017; take one that does not, such as \
                         bueno_orovio_2008_epi",
                    )
                })
            })
            .transpose()?;
        let members = Members::new(&model, &state, protocols, settings)?;
        let members = members.ok_or_else(|| {
            refused("a potential that others change needs a method with fixed steps")
        })?;
        let spreads = conduction.along > 0.0 || conduction.across > 0.0;
        let diffusion = spreads.then(|| Arc::new(Diffusion::new(mesh, fibres, conduction)));
        let level = level(&*model, place);
        let mut stimulus_times_ms: Vec<f64> =
            protocols.iter().flat_map(Protocol::stimulus_times).collect();
        stimulus_times_ms.sort_by(f64::total_cmp);
        stimulus_times_ms.dedup();
        let strongest = super::by_triangle::strongest(&model, settings, scale, 1.0)?;
        let potential = members.read(place);
        let tips = Tips::new(mesh, level, &potential);
        let followed = Followed::new(potential, state[place], level);
        let kept = Cells { members, time_ms: 0.0, followed, tips };
        let corners = mesh.simplices.iter().map(|triangle| triangle.nodes).collect();
        let mut tissue = Self {
            model,
            diffusion,
            moved: kept.clone(),
            kept,
            corners: Arc::new(corners),
            scale,
            tension: vec![0.0; mesh.simplices.len()],
            strongest,
            settings,
            place,
            probes: Vec::new(),
            stimulus_times_ms,
            s2_ms: None,
            channels: None,
            pull,
            room: Room::default(),
        };
        tissue.find_tension();
        Ok(tissue)
    }

    /// The same, with the potentials of these nodes as outputs of these names, and the time of an extra stimulus S2, ms.
    #[must_use]
    pub fn with_outputs(self, probes: Vec<(&'static str, usize)>, s2_ms: Option<f64>) -> Self {
        Self { probes, s2_ms, ..self }
    }

    /// The same, with a current through channels that stretch opens.
    #[must_use]
    pub fn with_stretch_current(self, current: StretchCurrent) -> Self {
        let StretchCurrent { conductance, reversal_mv } = current;
        let reversal = state_at(&*self.model, self.place, reversal_mv).unwrap_or(REVERSAL);
        let longer = vec![0.0; self.nodes()];
        Self { channels: Some(Channels { conductance, reversal, longer }), ..self }
    }

    /// The same with these stretches of the models in the tissue at rest, one per triangle; all other stretches are multiplied by them. Of
    /// cells that do not feel stretch nothing changes.
    ///
    /// # Errors
    /// A model that cannot beat at the largest of them.
    ///
    /// # Panics
    /// If there is not one for each triangle.
    pub fn at_resting_stretch(mut self, resting_stretch: &[f64]) -> Result<Self, SolveError> {
        assert_eq!(resting_stretch.len(), self.corners.len(), "one stretch at rest per triangle");
        if let Some(pull) = &mut self.pull {
            pull.resting_stretch =
                at_nodes(&self.corners, pull.resting_stretch.len(), resting_stretch);
            pull.stretch.clone_from(&pull.resting_stretch);
            let longest = resting_stretch.iter().copied().fold(1.0, f64::max);
            let Self { model, settings, scale, .. } = &self;
            self.strongest = super::by_triangle::strongest(model, *settings, *scale, longest)?;
            self.find_tension();
        }
        Ok(self)
    }

    /// Advances to a time (ms) and keeps it, for a tissue that is not part of a simulation.
    ///
    /// # Errors
    /// A state that is not finite.
    pub fn reach(&mut self, to_ms: f64) -> Result<(), SolveError> {
        let at_rest = vec![1.0; self.corners.len()];
        self.move_to(to_ms, &at_rest)?;
        self.keep();
        Ok(())
    }

    /// The potential of each node, in the unit of the model's state.
    pub fn potentials(&self) -> impl Iterator<Item = f64> + '_ {
        self.moved.members.read(self.place).into_iter()
    }

    fn nodes(&self) -> usize {
        self.moved.followed.nodes()
    }

    /// Moves from where it was kept to a time, ms, with this stretch of each triangle.
    fn move_to(&mut self, to_ms: f64, stretch: &[f64]) -> Result<(), SolveError> {
        let felt = self.channels.is_some() || self.pull.is_some();
        let nodes = if felt { at_nodes(&self.corners, self.nodes(), stretch) } else { Vec::new() };
        let over_ms = to_ms - self.kept.time_ms;
        // Where crossbridges are followed apart, the rest of each cell goes on but once an interval.
        if self.pull.as_ref().is_none_or(|pull| pull.reached != Some(to_ms)) {
            if let Some(channels) = &mut self.channels {
                channels.feel(&nodes);
            }
            if let Some(pull) = &mut self.pull {
                pull.foretell(over_ms, &nodes);
            }
            self.moved.clone_from(&self.kept);
            self.go(to_ms)?;
        }
        if let Some(pull) = &mut self.pull {
            pull.reached = Some(to_ms);
            pull.feel(over_ms, nodes);
        }
        self.find_tension();
        Ok(())
    }

    fn go(&mut self, to_ms: f64) -> Result<(), SolveError> {
        let mut now = self.step_end(self.moved.time_ms, to_ms);
        if let Some(now) = now {
            self.spread(0.5 * (now - self.moved.time_ms), None);
        }
        while let Some(end) = now {
            let step = end - self.moved.time_ms;
            let strain = self.pull.as_ref().map_or(&[][..], |pull| &pull.foretold);
            self.moved.members.advance_to(end, strain)?;
            self.moved.time_ms = end;
            now = self.step_end(end, to_ms);
            // The second half of this step and the first of the next.
            let over_ms = 0.5 * (step + now.map_or(0.0, |next| next - end));
            self.spread(over_ms, Some([end, step]));
        }
        self.moved.members.check_finite()?;
        self.moved.time_ms = to_ms;
        Ok(())
    }

    /// Where the step from a time ends, ms: steps end where those of the cells do, on the grid of fixed steps, and at `to_ms`. `None` at
    /// the end.
    fn step_end(&self, from_ms: f64, to_ms: f64) -> Option<f64> {
        let same = SAME * self.settings.step_ms;
        let grid_ms =
            (((from_ms + same) / self.settings.step_ms).floor() + 1.0) * self.settings.step_ms;
        let end_ms = if grid_ms > to_ms - same { to_ms } else { grid_ms };
        (to_ms - from_ms > same).then_some(end_ms)
    }

    /// Lets the potential spread, and takes note of it after a step with this end and length, ms.
    fn spread(&mut self, over_ms: f64, step: Option<[f64; 2]>) {
        let Cells { members, followed, tips, .. } = &mut self.moved;
        members.change(self.place, |potential| {
            if let Some(diffusion) = &self.diffusion {
                diffusion.spread(potential, over_ms, &mut self.room);
            }
            if let Some(channels) = &self.channels {
                channels.flow(potential, over_ms);
            }
            if let Some([end, step]) = step {
                followed.step(potential, end, step);
                tips.see(potential, end);
            }
        });
    }

    /// Computes the tension of every triangle, and how it grows with the stretch of the triangle.
    ///
    /// A cell feels the triangles around it, too; where all stretch alike, each triangle has the whole of it. So the slope is that of a
    /// tissue that stretches evenly, and equilibria with it are found in some more rounds.
    fn find_tension(&mut self) {
        let (model, members) = (&*self.model, &self.moved.members);
        let Some(pull) = &mut self.pull else {
            let nodes = members.each(|_, state| model.tension(state, &Input::REST));
            for (tension, corners) in self.tension.iter_mut().zip(&*self.corners) {
                *tension = self.scale * mean(corners, &nodes);
            }
            return;
        };
        let (mut slopes, mut own) = (Vec::new(), Vec::new());
        let nodes = members.each(|cell, state| {
            own.clear();
            own.extend_from_slice(state);
            let [tension, slope] = pull.tension(model, cell, &mut own);
            slopes.push(slope);
            tension
        });
        let most = self.strongest.per_stretch;
        let triangles = self.tension.iter_mut().zip(&mut pull.per_stretch);
        for ((tension, per_stretch), corners) in triangles.zip(&*self.corners) {
            *tension = self.scale * mean(corners, &nodes);
            *per_stretch = (self.scale * mean(corners, &slopes)).clamp(0.0, most);
        }
    }
}

/// The mean of what the corners of a triangle have.
fn mean(corners: &[u32; 3], nodes: &[f64]) -> f64 {
    corners.iter().map(|&node| nodes[node as usize]).sum::<f64>() / 3.0
}

/// Checks a conduction and the lengths of lists.
fn check(
    mesh: &Mesh,
    fibres: &[[f64; 2]],
    conduction: &Conduction,
    protocols: &[Protocol],
) -> Result<(), TissueError> {
    for (name, value) in [("along", conduction.along), ("across", conduction.across)] {
        if !(value.is_finite() && value >= 0.0) {
            return Err(TissueError::Conduction { name, value });
        }
    }
    let relative = conduction.relative.as_deref();
    let bad = relative.and_then(|all| all.iter().position(|it| !(it.is_finite() && *it >= 0.0)));
    if let (Some(triangle), Some(all)) = (bad, relative) {
        return Err(TissueError::Relative { triangle, value: all[triangle] });
    }
    let counts = [
        ("protocols", protocols.len(), mesh.len()),
        ("directions of fibres", fibres.len(), mesh.simplices.len()),
        (
            "relative conductions",
            relative.map_or(mesh.simplices.len(), <[f64]>::len),
            mesh.simplices.len(),
        ),
    ];
    if let Some((what, found, expected)) =
        counts.into_iter().find(|(_, found, expected)| found != expected)
    {
        return Err(TissueError::Count { what, found, expected });
    }
    Ok(())
}

/// The potential above which a cell is activated.
fn level(model: &dyn CellModel, place: usize) -> f64 {
    state_at(model, place, ACTIVATED_MV).unwrap_or(ACTIVATED)
}

/// The value of the state that spreads at a membrane potential, mV; `None` if the model has no millivolts. Both are proportional but for an
/// offset.
fn state_at(model: &dyn CellModel, place: usize, millivolts: f64) -> Option<f64> {
    let [zero, one] = [0.0, 1.0].map(|at| millivolts_at(model, place, at));
    let (from, to) = (zero?, one?);
    (to > from).then(|| (millivolts - from) / (to - from))
}

/// The membrane potential, mV, at a value of the state that spreads; `None` if the model has no millivolts.
fn millivolts_at(model: &dyn CellModel, place: usize, value: f64) -> Option<f64> {
    let mut state = model.initial_state();
    state[place] = value;
    model.membrane_potential_mv(&state)
}

impl Activation for Tissue {
    fn sites(&self) -> Sites {
        Sites::PerElement(self.corners.len())
    }

    fn advance(&mut self, to_ms: f64, now: StretchState<'_>) -> Result<(), ActivationError> {
        self.move_to(to_ms, now.stretch).map_err(|error| ActivationError(error.to_string()))
    }

    fn keep(&mut self) {
        self.kept.clone_from(&self.moved);
        if let Some(pull) = &mut self.pull {
            pull.keep();
        }
    }

    fn tension(&self) -> Tension<'_> {
        Tension::PerElement(&self.tension)
    }

    fn tangent(&self) -> Option<ActivationTangent<'_>> {
        let Pull { per_stretch, per_rate, .. } = self.pull.as_ref()?;
        Some(ActivationTangent { per_stretch, per_rate })
    }

    fn strongest(&self) -> ActivationBounds {
        self.strongest
    }

    fn stimulus_times_ms(&self) -> Vec<f64> {
        self.stimulus_times_ms.clone()
    }

    fn s2_ms(&self) -> Option<f64> {
        self.s2_ms
    }

    fn outputs(&self) -> Vec<Output> {
        let unit =
            self.model.membrane_potential_mv(&self.model.initial_state()).map_or("", |_| "mV");
        let output = |(name, _): &(&'static str, usize)| Output {
            name: (*name).into(),
            unit: unit.into(),
            meaning: "potential at one place of the tissue".into(),
        };
        self.probes.iter().map(output).collect()
    }

    fn output_values(&self) -> Vec<f64> {
        let value = |&(_, node): &(&str, usize)| {
            let state = self.moved.members.state(node);
            self.model.membrane_potential_mv(&state).unwrap_or(state[self.place])
        };
        self.probes.iter().map(value).collect()
    }

    fn local_beats(&self) -> Option<Vec<Vec<LocalBeat>>> {
        Some(self.moved.followed.beats())
    }

    fn potentials_mv(&self) -> Option<Vec<f64>> {
        let [zero, one] = [0.0, 1.0].map(|at| millivolts_at(&*self.model, self.place, at));
        let (offset, per_unit) = (zero?, one? - zero?);
        Some(self.potentials().map(|potential| offset + per_unit * potential).collect())
    }

    fn wave_tips(&self) -> &[WaveTip] {
        self.moved.tips.found()
    }

    fn boxed(&self) -> Box<dyn Activation> {
        Box::new(self.clone())
    }
}
