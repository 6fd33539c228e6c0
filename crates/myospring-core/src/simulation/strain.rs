//! Warnings about results that a real cell would not show: strain beyond the range of the
//! material's law, or lengthening.

use super::capture::rhythm;
use super::{Outcome, Ready, Simulation};
use crate::mechanics::active::FibreStretch;
use crate::mesh::simplex::measure_at;
use crate::recording::{Frame, Sample};

/// Largest strain along the fibre, of either sign, for which the material's law is valid.
///
/// Springs and area law are linear and were fitted at 12 % shortening. Unloaded cells shorten by 7
/// to 12 %, and a sarcomere of 1.85 um at rest that is shortened by a fifth has 1.48 um, less than
/// its thick filaments of 1.6 um (`gordon_1966`), which a cell resists and a spring does not.
/// Stretched by a fifth it has 2.2 um, the longest found in resting cells, where it stiffens.
pub const MOST_STRAIN: f64 = 0.2;

/// Share of the cell beyond [`MOST_STRAIN`] without a warning: corners, and edges of the support.
const FEW: f64 = 0.05;

/// Lengthening without a warning, per cent: the rest of a swing, or of an isometric contraction.
const LITTLE_LONGER_PCT: f64 = 0.1;

impl Ready {
    /// Warnings about the outcome of this run: strain beyond the range of the material's law, a
    /// cell that became longer instead of shorter, a rate that neither measured cells nor its
    /// model's published beat have ([`Simulation::pace`]), stimuli that raised no action potential,
    /// or alternating beats.
    ///
    /// Strain is checked in the shape at the highest tension and in that at the largest change of
    /// length.
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
        let all = [self.lengthened(outcome), self.strained(outcome), self.out_of_pace(outcome)];
        all.into_iter().flatten().chain(rhythm(outcome)).collect()
    }

    fn lengthened(&self, outcome: &Outcome) -> Option<String> {
        let samples = &outcome.recording.samples;
        let by_change = |a: &&Sample, b: &&Sample| a.shortening_pct.total_cmp(&b.shortening_pct);
        let (longest, shortest) =
            (samples.iter().min_by(by_change)?, samples.iter().max_by(by_change)?);
        let longer = -longest.shortening_pct;
        if longer < LITTLE_LONGER_PCT || longer < shortest.shortening_pct {
            return None;
        }
        let angle = self.simulation().mean_angle_to_axis().abs().to_degrees();
        let why = if angle > 35.0 {
            format!(
                "its fibres lie {angle:.0} degrees from its long axis on average, and what contracts across a cell \
                 makes it longer. Look at their direction in the overlay; fibre = \"long axis\" takes that instead"
            )
        } else {
            "look at what holds it and at where its tension is".to_owned()
        };
        Some(format!(
            "the cell becomes longer: by {longer:.1} % at {} ms, and shorter by {:.1} % at most: {why}",
            longest.t_ms,
            shortest.shortening_pct.max(0.0)
        ))
    }

    fn strained(&self, outcome: &Outcome) -> Option<String> {
        let simulation = self.simulation();
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
        let (frame, share) = strained.max_by(|a, b| a.1.total_cmp(&b.1))?;
        if share <= FEW {
            return None;
        }
        let shortening = changed.map_or(0.0, |sample| sample.shortening_pct);
        let way = if shortening < 0.0 { "longer" } else { "shorter" };
        Some(format!(
            "{:.0} % of the cell is strained by more than {:.0} % along its fibres (at {} ms under {:.1} kPa; the \
             cell becomes {:.0} % {way}): the material law was not made for that. It is linear and fitted at 12 % \
             shortening; unloaded cells shorten by 7 to 12 %, and sarcomeres of 1.85 um at rest would be shorter than \
             their thick filaments of 1.6 um. Lower the tension, or raise Young's modulus",
            100.0 * share,
            100.0 * MOST_STRAIN,
            frame.t_ms,
            frame.ta_kpa,
            shortening.abs()
        ))
    }
}

impl Simulation {
    /// Mean direction of the fibres against the long axis, radians from -pi/2 to pi/2: half the angle of the mean
    /// vector at twice the angle, since fibres have no sense.
    fn mean_angle_to_axis(&self) -> f64 {
        let [along_x, along_y] = self.long_axis;
        let mut sum = [0.0; 2];
        for (simplex, [x, y]) in self.mesh.simplices.iter().zip(&self.fibres) {
            let area = simplex.weight * measure_at(&self.mesh.points, simplex.nodes);
            let (along, across) = (x * along_x + y * along_y, y * along_x - x * along_y);
            sum[0] += area * (along * along - across * across);
            sum[1] += area * 2.0 * along * across;
        }
        0.5 * sum[1].atan2(sum[0])
    }

    /// Share of the resting cell that is strained by more than [`MOST_STRAIN`] along its fibres.
    fn share_beyond(&self, frame: &Frame) -> f64 {
        let stretches = FibreStretch::new(&self.mesh, &self.fibres).stretches(&frame.positions);
        let (mut beyond, mut all) = (0.0, 0.0);
        for (simplex, stretch) in self.mesh.simplices.iter().zip(stretches) {
            let area = simplex.weight * measure_at(&self.mesh.points, simplex.nodes);
            all += area;
            if (stretch - 1.0).abs() > MOST_STRAIN {
                beyond += area;
            }
        }
        beyond / all
    }
}
