//! A cell model in each triangle, which depends on the stretch of the triangle.

use super::{
    Activation, ActivationBounds, ActivationError, ActivationTangent, Sites, StretchState,
};
use crate::cell::integrator::CellIntegrator;
use crate::cell::pacing::Protocol;
use crate::cell::solve::{SolveError, SolverSettings};
use crate::cell::{CellModel, Input, Output};
use crate::mechanics::Tension;
use std::sync::Arc;

/// Difference of stretch for finite differences: far above rounding, and small enough for the
/// tension to be linear over it.
const APART: f64 = 1e-6;
/// Safety factor on the steepest slope of a beat at resting length: a stretched cell is stiffer.
const STEEPER: f64 = 2.0;

/// One cell model per triangle, each with its stimuli; for cells whose stretch differs between
/// triangles because of myofibril content, oblique fibres or a wave of calcium.
///
/// All have the same equations and parameters. The recording contains their mean.
///
/// # Example
/// A wave of calcium along a cell at 0.1 um/ms:
/// ```
/// use myospring::cell::land_2017::Land2017;
/// use myospring::cell::{CellModel, pacing::Protocol};
/// use myospring::exchange::ByTriangle;
/// use myospring::prelude::*;
/// use std::sync::Arc;
///
/// let mesh = lattice::rectangle(8, 2, 5.0)?;
/// let model = Land2017::published();
/// let protocol = |triangle| Protocol {
///     start_ms: mesh.centre(triangle)[0] / 0.1,
///     ..Protocol::once(model.default_stimulus())
/// };
/// let protocols: Vec<Protocol> = mesh.simplices.iter().map(protocol).collect();
/// let settings = model.usual_settings();
/// let wave = ByTriangle::new(Arc::new(model), None, &protocols, settings, 1.0)?;
/// let mut simulation = Simulation {
///     activation: Some(Box::new(wave)),
///     duration: 50.0,
///     ..Simulation::new(mesh)
/// };
/// simulation.numerics.method = Method::QuasiStatic;
/// let outcome = simulation.build()?.run(|_progress| true);
/// assert!(outcome.stop.is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct ByTriangle {
    model: Arc<dyn CellModel>,
    kept: Vec<CellIntegrator>,
    moved: Vec<CellIntegrator>,
    /// Copy of each cell at a slightly larger stretch, for finite differences.
    longer: CellIntegrator,
    /// kPa per unit of the model's tension.
    scale: f64,
    tension: Vec<f64>,
    per_stretch: Vec<f64>,
    per_rate: Vec<f64>,
    strongest: ActivationBounds,
    /// Stretch of each model in the cell at rest.
    resting_stretch: Vec<f64>,
    settings: SolverSettings,
    stimulus_times_ms: Vec<f64>,
    s2_ms: Option<f64>,
}

impl ByTriangle {
    /// Creates cells in this state at 0 ms, by default the initial one, one per protocol; `scale` is in kPa per unit
    /// of the model's tension.
    ///
    /// Beats are measured from the stimuli of the triangle that is stimulated first.
    ///
    /// # Errors
    /// A protocol or settings that the model cannot follow, and a state that does not fit it.
    pub fn new(
        model: Arc<dyn CellModel>,
        state: Option<&[f64]>,
        protocols: &[Protocol],
        settings: SolverSettings,
        scale: f64,
    ) -> Result<Self, SolveError> {
        let state = state.map_or_else(|| model.initial_state(), <[f64]>::to_vec);
        let one = |protocol: Protocol| {
            CellIntegrator::starting_from(Arc::clone(&model), &state, protocol, settings)
        };
        let longer = one(Protocol::rest())?;
        let kept: Vec<CellIntegrator> =
            protocols.iter().map(|protocol| one(*protocol)).collect::<Result<_, _>>()?;
        let count = kept.len();
        let tension =
            kept.iter().map(|cell| scale * model.tension(cell.state(), &cell.input())).collect();
        let first = protocols.iter().min_by(|a, b| a.start_ms.total_cmp(&b.start_ms));
        let stimulus_times_ms = first.map_or_else(Vec::new, |it| it.stimulus_times().collect());
        let s2_ms = first.and_then(Protocol::s2_ms);
        let strongest = strongest(&model, settings, scale, 1.0)?;
        Ok(Self {
            moved: kept.clone(),
            kept,
            longer,
            scale,
            tension,
            per_stretch: vec![0.0; count],
            per_rate: vec![0.0; count],
            strongest,
            resting_stretch: vec![1.0; count],
            settings,
            stimulus_times_ms,
            s2_ms,
            model,
        })
    }

    /// Returns the same with these stretches of the models in the cell at rest, one per triangle;
    /// all other stretches are multiplied by them.
    ///
    /// # Errors
    /// A model that cannot beat at the largest of them.
    ///
    /// # Panics
    /// If there is not one for each triangle.
    pub fn at_resting_stretch(mut self, resting_stretch: &[f64]) -> Result<Self, SolveError> {
        assert_eq!(resting_stretch.len(), self.kept.len(), "one stretch at rest per triangle");
        resting_stretch.clone_into(&mut self.resting_stretch);
        let longest = resting_stretch.iter().copied().fold(1.0, f64::max);
        self.strongest = strongest(&self.model, self.settings, self.scale, longest)?;
        Ok(self)
    }
}

/// Returns the stretch in the middle of an interval; a linear course is accurate to second order.
fn middle(end: f64, rate: f64, interval_ms: f64) -> f64 {
    end - 0.5 * rate * interval_ms
}

/// Advances a cell and returns its tension in kPa.
fn reach(
    cell: &mut CellIntegrator,
    to_ms: f64,
    stretch: f64,
    rate: f64,
) -> Result<f64, SolveError> {
    let over = to_ms - cell.time();
    cell.advance_to(to_ms, middle(stretch, rate, over), rate)?;
    Ok(cell.model().tension(cell.state(), &Input { stretch, stretch_rate: rate, ..cell.input() }))
}

/// Returns the bounds of one default beat at a stretch.
pub(super) fn strongest(
    model: &Arc<dyn CellModel>,
    settings: SolverSettings,
    scale: f64,
    stretch: f64,
) -> Result<ActivationBounds, SolveError> {
    const INTERVAL_MS: f64 = 1.0;
    let protocol = Protocol { start_ms: 0.0, ..Protocol::once(model.default_stimulus()) };
    let mut cell = CellIntegrator::new(Arc::clone(model), protocol, settings)?;
    let mut most = ActivationBounds::default();
    for ms in 1..=600 {
        let time = f64::from(ms) * INTERVAL_MS;
        let mut longer = cell.clone();
        let tension = reach(&mut cell, time, stretch, 0.0)?;
        // The derivative is with respect to the stretch of the mesh, to which the model's stretch
        // is proportional.
        let apart = stretch * APART;
        let above = reach(&mut longer, time, stretch + apart, apart / INTERVAL_MS)?;
        most.tension = most.tension.max(scale * tension);
        most.per_stretch = most.per_stretch.max(scale * STEEPER * (above - tension) / APART);
    }
    Ok(most)
}

impl Activation for ByTriangle {
    fn sites(&self) -> Sites {
        Sites::PerElement(self.kept.len())
    }

    fn advance(&mut self, to_ms: f64, now: StretchState<'_>) -> Result<(), ActivationError> {
        let failed = |error: SolveError| ActivationError(error.to_string());
        let feels = self.model.feels_stretch();
        for site in 0..self.kept.len() {
            let at_rest = self.resting_stretch[site];
            let [stretch, rate] = [now.stretch[site], now.rate[site]].map(|of| at_rest * of);
            let kept = &self.kept[site];
            let over = to_ms - kept.time();
            let moved = &mut self.moved[site];
            moved.clone_from(kept);
            let tension = reach(moved, to_ms, stretch, rate).map_err(failed)?;
            self.tension[site] = self.scale * tension;
            if !feels {
                continue;
            }
            // The longer copy was stretched during the interval: crossbridges that follow the
            // stretch within an interval act as springs, not dashpots.
            self.longer.clone_from(kept);
            let apart = at_rest * APART;
            let faster = if over > 0.0 { rate + apart / over } else { rate };
            let above = reach(&mut self.longer, to_ms, stretch + apart, faster).map_err(failed)?;
            // A slope below 0, or steeper than the time step allows, is limited: then the iteration
            // only converges more slowly.
            let slope = self.scale * (above - tension) / APART;
            self.per_stretch[site] = slope.clamp(0.0, self.strongest.per_stretch);
        }
        Ok(())
    }

    fn keep(&mut self) {
        for (kept, moved) in self.kept.iter_mut().zip(&self.moved) {
            kept.clone_from(moved);
        }
    }

    fn tension(&self) -> Tension<'_> {
        Tension::PerElement(&self.tension)
    }

    fn tangent(&self) -> Option<ActivationTangent<'_>> {
        let Self { per_stretch, per_rate, .. } = self;
        self.model.feels_stretch().then_some(ActivationTangent { per_stretch, per_rate })
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
        super::whole_cell::told_by(&*self.model)
    }

    fn output_values(&self) -> Vec<f64> {
        let mut sum = vec![0.0; self.outputs().len()];
        for cell in &self.moved {
            for (sum, value) in sum.iter_mut().zip(super::whole_cell::told(cell, cell.state())) {
                *sum += value;
            }
        }
        let count = self.moved.len().max(1) as f64;
        sum.into_iter().map(|sum| sum / count).collect()
    }

    fn boxed(&self) -> Box<dyn Activation> {
        Box::new(self.clone())
    }
}
