//! A cell model in each triangle, which feels the stretch there.

use super::{
    Activation, ActivationBounds, ActivationError, ActivationTangent, Sites, StretchState,
};
use crate::cell::integrator::CellIntegrator;
use crate::cell::pacing::Protocol;
use crate::cell::solve::{Settings, SolveError};
use crate::cell::{CellModel, Input, Output};
use crate::mechanics::Tension;
use std::sync::Arc;

/// Difference of stretch by which slopes are taken: far above rounding, and tension bends little over it.
const APART: f64 = 1e-6;
/// Times the steepest slope of a beat at resting length that is allowed for: a cell that is drawn out is stiffer.
const STEEPER: f64 = 2.0;

/// One cell model for each triangle, each with its stimuli: content of myofibrils, oblique fibres or a wave of
/// calcium make their stretches differ.
///
/// All have the same equations and parameters. What is recorded of them is their mean.
///
/// # Example
/// Calcium that goes along a cell at 0.1 um/ms:
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
/// let wave = ByTriangle::new(Arc::new(model), &protocols, settings, 1.0)?;
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
    /// Where each is tried, a little longer.
    longer: CellIntegrator,
    /// kPa per unit of the model's tension.
    scale: f64,
    tension: Vec<f64>,
    per_stretch: Vec<f64>,
    per_rate: Vec<f64>,
    strongest: ActivationBounds,
    /// What each feels of the cell at rest.
    resting_stretch: Vec<f64>,
    settings: Settings,
    stimulus_times_ms: Vec<f64>,
    s2_ms: Option<f64>,
}

impl ByTriangle {
    /// Cells in their initial state, one for each protocol, whose tension counts `scale` kPa per unit of the
    /// model's.
    ///
    /// Beats are measured from the stimuli of the triangle that is stimulated first.
    ///
    /// # Errors
    /// A protocol or settings that the model cannot follow.
    pub fn new(
        model: Arc<dyn CellModel>,
        protocols: &[Protocol],
        settings: Settings,
        scale: f64,
    ) -> Result<Self, SolveError> {
        Self::starting_from(model, None, protocols, settings, scale)
    }

    /// As [`ByTriangle::new`], each in this state at 0 ms.
    ///
    /// # Errors
    /// Besides, a state that is none of the model.
    pub fn starting_from(
        model: Arc<dyn CellModel>,
        state: Option<&[f64]>,
        protocols: &[Protocol],
        settings: Settings,
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
            kept.iter().map(|cell| scale * model.tension(cell.state(), &Input::REST)).collect();
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

    /// The same whose models feel these stretches in the cell at rest, one for each triangle, and in proportion else.
    ///
    /// # Errors
    /// A model that cannot beat at the longest of them.
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

/// Stretch half way through an interval: it goes evenly to its end, which is right to the second order.
fn middle(end: f64, rate: f64, interval_ms: f64) -> f64 {
    end - 0.5 * rate * interval_ms
}

/// Moves a cell on and says its tension in kPa.
fn reach(
    cell: &mut CellIntegrator,
    to_ms: f64,
    stretch: f64,
    rate: f64,
) -> Result<f64, SolveError> {
    let over = to_ms - cell.time();
    cell.advance_to(to_ms, middle(stretch, rate, over), rate)?;
    Ok(cell.model().tension(cell.state(), &Input { stretch, stretch_rate: rate, ..Input::REST }))
}

/// Of one default beat at a stretch.
fn strongest(
    model: &Arc<dyn CellModel>,
    settings: Settings,
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
        // By the stretch of the mesh, in proportion to which it feels.
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

    fn advance(&mut self, to_ms: f64, felt: StretchState<'_>) -> Result<(), ActivationError> {
        let failed = |error: SolveError| ActivationError(error.to_string());
        let feels = self.model.feels_stretch();
        for site in 0..self.kept.len() {
            let at_rest = self.resting_stretch[site];
            let [stretch, rate] = [felt.stretch[site], felt.rate[site]].map(|of| at_rest * of);
            let kept = &self.kept[site];
            let over = to_ms - kept.time();
            let moved = &mut self.moved[site];
            moved.clone_from(kept);
            let tension = reach(moved, to_ms, stretch, rate).map_err(failed)?;
            self.tension[site] = self.scale * tension;
            if !feels {
                continue;
            }
            // A longer one has been drawn out on the way: crossbridges that follow the stretch within an
            // interval are springs, not dashpots.
            self.longer.clone_from(kept);
            let apart = at_rest * APART;
            let faster = if over > 0.0 { rate + apart / over } else { rate };
            let above = reach(&mut self.longer, to_ms, stretch + apart, faster).map_err(failed)?;
            // Where it would let the cell go, or is steeper than the steps are stable for, the tangent only
            // leads there more slowly.
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
