//! Verdicts on a map.

use super::TensionMap;
use crate::mechanics::gel::Gel;
use crate::mechanics::support::SupportKind;
use crate::simulation::Simulation;

/// Smallest part of the cell that is doubtful, or has no tension, that is reported.
const MUCH: f64 = 0.05;
/// Standard deviation over tension above which a place is doubtful, and the part of the cell that
/// may be doubtful before no map is shown.
const DOUBTFUL: f64 = 0.5;
const MOST: f64 = 0.5;
/// Part of the mean tension that stands for the tension of places with less.
const OF_MEAN: f64 = 0.5;
/// Misfit of a map, as a part of that of a uniform tension, above which there is a warning.
const LEFT: f64 = 0.7;

impl TensionMap {
    /// Median of the resolutions of all triangles, um.
    pub fn resolution_um(&self) -> f64 {
        middle(&self.resolutions_um, 0.5)
    }

    /// Tension, kPa, below which a part of the triangles lies.
    pub fn quantile_kpa(&self, part: f64) -> f64 {
        middle(&self.tensions_kpa, part)
    }

    /// Standard deviation of each triangle over its tension, or over half of the cell's mean where that is more: 1 at most. So
    /// a place with little tension that is known to be little is not doubtful.
    pub fn doubts(&self) -> Vec<f64> {
        let both = self.deviations_kpa.iter().zip(&self.tensions_kpa);
        let enough = |tension: f64| tension.max(OF_MEAN * self.mean_kpa);
        both.map(|(deviation, tension)| (deviation / enough(*tension)).min(1.0)).collect()
    }

    /// Part of the triangles whose standard deviation is above half of their tension, and above a quarter of the mean.
    pub fn doubtful_part(&self) -> f64 {
        let doubts = self.doubts();
        let doubtful = doubts.iter().filter(|doubt| **doubt > DOUBTFUL).count();
        doubtful as f64 / doubts.len().max(1) as f64
    }

    /// Whether the tension is known in most of the cell; otherwise no map is shown, and
    /// [`TensionMap::why_not_known`] says why.
    pub fn is_known(&self) -> bool {
        self.doubtful_part() <= MOST
    }

    /// The text that replaces a map that is not known.
    pub fn why_not_known(&self) -> String {
        format!(
            "This film does not show where the cell pulls: in {:.0} % of the cell the standard deviation is above \
            half of the tension and a quarter of its mean. The uniform tension that fits the film best is {:.1} kPa, the mean of a map would \
            be {:.1} kPa. Try smoother fibres (--fibre-smoothing \"12 um\"), larger subsets, a sharper film, one that shows \
            the whole cell, or the true support of the cell.",
            100.0 * self.doubtful_part(),
            self.even_kpa,
            self.mean_kpa
        )
    }

    /// Verdicts on a map of this cell, the most important first.
    pub fn verdicts(&self, simulation: &Simulation) -> Vec<String> {
        let chance = self.chance_even;
        let mut words = Vec::new();
        if self.is_uneven() {
            words.push(format!(
                "the tension differs from place to place (a uniform one would look as uneven in {:.1} % of such \
                films); parts smaller than {:.0} um are not resolved",
                100.0 * chance,
                self.resolution_um()
            ));
        } else {
            words.push(format!(
                "this film shows no difference between places: a uniform tension would look as uneven in {:.0} % of \
                such films",
                100.0 * chance
            ));
        }
        if self.is_uneven() && self.misfit_um > LEFT * self.even_misfit_um {
            words.push(format!(
                "the map explains little of the motion: its residual is {:.3} um, that of a uniform tension {:.3} \
                um. The model of the cell does not fit (stiffness, support, fibres)",
                self.misfit_um, self.even_misfit_um
            ));
        }
        let doubtful = self.doubtful_part();
        if !self.is_known() {
            words[0] = self.why_not_known();
        } else if doubtful > MUCH {
            words.push(format!(
                "in {:.0} % of the cell, hatched in the figure, the standard deviation is above half of the \
                tension and a quarter of its mean: the tension of these places is not known, and not drawn",
                100.0 * doubtful
            ));
        }
        let none = self.tensions_kpa.iter().filter(|tension| **tension <= 0.0).count() as f64;
        let none = none / self.tensions_kpa.len().max(1) as f64;
        if none > MUCH && self.is_known() {
            words.push(format!(
                "{:.0} % of the cell has no tension: it yields or is stretched there, or the model does not fit it",
                100.0 * none
            ));
        }
        if self.held_at_cut > 0 {
            words.push(format!(
                "the frame cuts the cell: {} points at the cut are held at their measured positions, to replace the \
                forces from beyond the cut",
                self.held_at_cut
            ));
        }
        let modulus = simulation.material.young_modulus();
        words.push(match simulation.support {
            SupportKind::ElasticBed { stiffness } => format!(
                "the tensions are proportional to the assumed stiffness, {modulus} kPa of the cell and {stiffness} \
                kPa/um of its bed"
            ),
            SupportKind::Gel(Gel { modulus: gel, .. }) => format!(
                "the tensions are proportional to the assumed stiffness, {modulus} kPa of the cell and {gel} kPa of \
                its gel"
            ),
            _ => format!(
                "the tensions are proportional to the assumed stiffness, {modulus} kPa"
            ),
        });
        words
    }
}

/// A quantile of the values.
fn middle(values: &[f64], part: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(((sorted.len().max(1) - 1) as f64 * part) as usize).copied().unwrap_or(f64::NAN)
}
