//! How far the material may be strained before its law says nothing about cells.

use super::{Outcome, Ready, Simulation};
use crate::mechanics::active::FibreStretch;
use crate::mesh::simplex::content_at;
use crate::recording::Frame;

/// Largest strain along the fibre, either way, for which the material's law was made.
///
/// Springs and area law are linear and were fitted at 12 % shortening. Unloaded cells shorten by 7 to 12 %, and a
/// sarcomere of 1.85 um at rest that is shortened by a fifth has 1.48 um, less than its thick filaments of 1.6 um
/// (`gordon_1966`), which a cell resists and a spring does not; stretched by a fifth it has 2.2 um, the end of what a
/// resting cell is found at, where it stiffens.
pub const MOST_STRAIN: f64 = 0.2;

/// Share of the cell beyond [`MOST_STRAIN`] that needs no remark: corners, and rims of what holds the cell.
const FEW: f64 = 0.05;

impl Ready {
    /// What a person should know of what came of this run: that it went beyond what the material's law was made for.
    ///
    /// Looks at the shape at the highest tension and the one at the largest change of length.
    ///
    /// # Example
    /// ```
    /// use myospring::prelude::*;
    /// let mut simulation = Simulation::new(lattice::rectangle(20, 4, 5.0)?);
    /// simulation.numerics.method = Method::QuasiStatic;
    /// let warnings = |simulation: &Simulation| -> Result<_, SetupError> {
    ///     let ready = simulation.build()?;
    ///     Ok(ready.warnings_after(&ready.run(|_progress| true)))
    /// };
    /// assert!(warnings(&simulation)?.is_empty());
    /// simulation.peak_tension = 200.0;
    /// assert!(warnings(&simulation)?[0].contains("more than 20 %"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn warnings_after(&self, outcome: &Outcome) -> Vec<String> {
        let simulation = &self.setup().simulation;
        let frames = &outcome.recording.frames;
        let samples = outcome.recording.samples.iter();
        let changed =
            samples.max_by(|a, b| a.shortening_pct.abs().total_cmp(&b.shortening_pct.abs()));
        let at_change = changed.and_then(|sample| {
            let away = |frame: &&Frame| (frame.t_ms - sample.t_ms).abs();
            frames.iter().min_by(|a, b| away(a).total_cmp(&away(b)))
        });
        let at_tension = frames.iter().max_by(|a, b| a.ta_kpa.total_cmp(&b.ta_kpa));
        let strained = [at_tension, at_change].into_iter().flatten();
        let strained = strained.map(|frame| (frame, simulation.share_beyond(frame)));
        let Some((frame, share)) = strained.max_by(|a, b| a.1.total_cmp(&b.1)) else {
            return Vec::new();
        };
        if share <= FEW {
            return Vec::new();
        }
        let shortening = changed.map_or(0.0, |sample| sample.shortening_pct);
        let way = if shortening < 0.0 { "longer" } else { "shorter" };
        vec![format!(
            "{:.0} % of the cell is strained by more than {:.0} % along its fibres (at {} ms under {:.1} kPa; the \
             cell becomes {:.0} % {way}): the material law was not made for that. It is linear and fitted at 12 % \
             shortening; unloaded cells shorten by 7 to 12 %, and sarcomeres of 1.85 um at rest would be shorter than \
             their thick filaments of 1.6 um. Lower the tension, or raise Young's modulus",
            100.0 * share,
            100.0 * MOST_STRAIN,
            frame.t_ms,
            frame.ta_kpa,
            shortening.abs()
        )]
    }
}

impl Simulation {
    /// Share of the resting cell that is strained by more than [`MOST_STRAIN`] along its fibres.
    fn share_beyond(&self, frame: &Frame) -> f64 {
        let stretches = FibreStretch::new(&self.mesh, &self.fibres).stretches(&frame.positions);
        let (mut beyond, mut all) = (0.0, 0.0);
        for (simplex, stretch) in self.mesh.simplices.iter().zip(stretches) {
            let area = simplex.weight * content_at(&self.mesh.points, simplex.nodes);
            all += area;
            if (stretch - 1.0).abs() > MOST_STRAIN {
                beyond += area;
            }
        }
        beyond / all
    }
}
