//! The diffusion with which a wave has a wanted conduction velocity.

use super::{
    Activation as _, Conduction, Coupling, StimulusPlace, Tissue, TissueCells, TissueError,
};
use crate::cell::CellModel;
use crate::cell::pacing::Protocol;
use crate::cell::solve::{CellMethod, SolverSettings};
use crate::mesh::lattice;
use std::sync::Arc;

/// Where the search begins: diffusion, um^2/ms, and velocity, um/ms, of human ventricles with the minimal models (`bueno_orovio_2008`).
const HUMAN: [f64; 2] = [1.171e5, 700.0];
/// Relative error of the velocity that ends the search, and the most rounds.
const CLOSE: f64 = 1e-4;
const ROUNDS: usize = 40;
/// Length of the strip on which the velocity is measured, in lengths over which the potential spreads in 1 ms; its fewest spacings; and
/// spacings within such a length from which on more change no velocity by 0.1 %.
const SPREAD_LENGTHS: f64 = 20.0;
const FEWEST: f64 = 60.0;
const ENOUGH: f64 = 40.0;
/// The parts of the strip between which the wave is timed, and the time that the stimulus and a slow start may take, ms.
const BETWEEN: [f64; 2] = [0.5, 0.75];
const PATIENCE_MS: f64 = 50.0;
/// Largest step of coupled cells, ms.
const STEP_MS: f64 = 0.02;

impl SolverSettings {
    /// Settings for coupled cells of this model, whose steps must be fixed: 0.02 ms, with which conduction velocities of the minimal
    /// models are right to 0.5 %; gates by their exact solution where the model names them.
    pub fn coupled(model: &dyn CellModel) -> Self {
        let method = if model.gates().is_empty() {
            CellMethod::ForwardEuler
        } else {
            CellMethod::RushLarsen
        };
        Self { step_ms: STEP_MS, ..Self::of(method) }
    }

    /// How a cell model is usually integrated, in a tissue or not.
    pub fn usual(model: &dyn CellModel, in_tissue: bool) -> Self {
        if in_tissue { Self::coupled(model) } else { model.usual_settings() }
    }
}

impl Conduction {
    /// The diffusion, um^2/ms, with which a plane wave of these cells has this velocity, um/ms, on a lattice of this spacing, um.
    ///
    /// It is sought with waves along a strip of that spacing: a coarse lattice slows a wave, so that the diffusion for a velocity depends
    /// on it.
    ///
    /// # Errors
    /// Cells that cannot be coupled, and a velocity at which no wave goes along this lattice.
    ///
    /// # Example
    /// ```
    /// use myospring::cell::bueno_orovio_2008::{Variant, model};
    /// use myospring::cell::{CellModel, solve::SolverSettings};
    /// use myospring::exchange::Conduction;
    /// use std::sync::Arc;
    /// let cell: Arc<dyn CellModel> = Arc::new(model(Variant::Epi));
    /// let settings = SolverSettings::coupled(&*cell);
    /// let diffusion = Conduction::diffusion_of(&cell, settings, 710.0, 250.0)?;
    /// assert!((diffusion / 1.171e5 - 1.0).abs() < 0.02);
    /// # Ok::<(), myospring::exchange::TissueError>(())
    /// ```
    pub fn diffusion_of(
        model: &Arc<dyn CellModel>,
        settings: SolverSettings,
        velocity: f64,
        spacing: f64,
    ) -> Result<f64, TissueError> {
        let mut diffusion = HUMAN[0] * (velocity / HUMAN[1]).powi(2);
        // The largest diffusion known to be too small, by which a wave is blocked or too slow, and the smallest known to be too large.
        let (mut least, mut most) = (0.0, f64::INFINITY);
        let mut slowest = f64::INFINITY;
        for _ in 0..ROUNDS {
            let cable = Cable { model, settings, spacing };
            let found = cable.velocity(diffusion, velocity)?;
            let mut next = 2.0 * diffusion;
            if let Some(found) = found {
                if (found / velocity - 1.0).abs() < CLOSE {
                    return Ok(diffusion);
                }
                slowest = slowest.min(found);
                // The velocity grows with the square root of the diffusion.
                next = diffusion * (velocity / found).powi(2);
            }
            if found.is_some_and(|found| found > velocity) {
                most = diffusion;
            } else {
                least = diffusion;
            }
            // Near the least velocity of a lattice it changes far more than that.
            if next <= least || next >= most {
                next = if most.is_finite() { f64::midpoint(least, most) } else { 2.0 * least };
            }
            diffusion = next;
        }
        // Waves are alike if velocity and spacing change by the same factor.
        let most = spacing * (velocity / slowest).min(1.0);
        Err(TissueError::NoWave { velocity_cm_per_s: 0.1 * velocity, spacing, most })
    }
}

/// A strip along which a wave is timed.
struct Cable<'a> {
    model: &'a Arc<dyn CellModel>,
    settings: SolverSettings,
    spacing: f64,
}

impl Cable<'_> {
    /// The velocity of a wave, um/ms; `None` if it does not arrive.
    fn velocity(&self, diffusion: f64, expected: f64) -> Result<Option<f64>, TissueError> {
        let spread = diffusion.sqrt();
        let spacing = self.spacing.max(spread / ENOUGH);
        let columns = (SPREAD_LENGTHS * spread / spacing).max(FEWEST).ceil() as usize;
        let mesh = lattice::rectangle(columns, 1, spacing)?;
        let coupling = Coupling {
            conduction: Conduction::even(diffusion),
            stimulated: StimulusPlace::End,
            s2_stimulated: StimulusPlace::End,
            stretch_current: None,
        };
        let beat = Protocol { start_ms: 0.0, ..Protocol::once(self.model.default_stimulus()) };
        let axis = [1.0, 0.0];
        let protocols = coupling.protocols(&mesh, axis, beat);
        let fibres = vec![axis; mesh.simplices.len()];
        let cells = TissueCells {
            model: Arc::clone(self.model),
            state: None,
            protocols: &protocols,
            settings: self.settings,
            scale: 1.0,
        };
        let mut strip = Tissue::new(&mesh, &fibres, &coupling.conduction, cells)?;
        let places = BETWEEN.map(|part| (part * columns as f64).round() * spacing);
        let nodes = places.map(|place| {
            let away = |node: &usize| (mesh.point(*node)[0] - place).abs();
            (0..mesh.len()).min_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or_default()
        });
        let end_ms = places[1] / expected + PATIENCE_MS;
        let arrived = |strip: &Tissue| {
            let beats = strip.local_beats().unwrap_or_default();
            let [from, to] = nodes.map(|node| Some(beats[node].first()?.activated_ms));
            from.zip(to)
        };
        let mut now_ms = 0.0;
        while now_ms < end_ms && arrived(&strip).is_none() {
            now_ms += 1.0;
            strip.reach(now_ms)?;
        }
        let velocity = |(from, to): (f64, f64)| (places[1] - places[0]) / (to - from);
        Ok(arrived(&strip).map(velocity).filter(|velocity| velocity.is_finite()))
    }
}
