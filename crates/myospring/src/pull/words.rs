//! What a reader of a map must know.

use super::TensionMap;
use crate::mechanics::support::SupportKind;
use crate::simulation::Simulation;

/// Part of the cell that is held at no tension from which on it is said.
const MUCH: f64 = 0.05;
/// Standard deviation of a place over the mean tension, from which on it is said.
const UNSURE: f64 = 0.5;
/// Part of the misfit of an even tension that a map may leave without a word.
const LEFT: f64 = 0.7;

impl TensionMap {
    /// The size of what can be told in the middle one of all triangles, um.
    pub fn resolution_um(&self) -> f64 {
        middle(&self.resolutions_um, 0.5)
    }

    /// Tension, kPa, below which a part of the triangles lies.
    pub fn quantile_kpa(&self, part: f64) -> f64 {
        middle(&self.tensions_kpa, part)
    }

    /// What a reader must know of a map of this cell, in order of weight.
    pub fn verdicts(&self, simulation: &Simulation) -> Vec<String> {
        let chance = self.chance_even;
        let mut words = Vec::new();
        if self.is_uneven() {
            words.push(format!(
                "the tension differs from place to place (an even one would look so in {:.1} % of such films); parts \
                 smaller than {:.0} um run together",
                100.0 * chance,
                self.resolution_um()
            ));
        } else {
            words.push(format!(
                "no unevenness can be told from this film: an even tension would look so in {:.0} % of such films",
                100.0 * chance
            ));
        }
        if self.is_uneven() && self.misfit_um > LEFT * self.even_misfit_um {
            words.push(format!(
                "the map explains little of the motion: it leaves {:.3} um where an even tension leaves {:.3} um, so the \
                 cell moves unlike its model (stiffness, support, fibres)",
                self.misfit_um, self.even_misfit_um
            ));
        }
        let unsure = middle(&self.deviations_kpa, 0.5);
        if self.is_uneven() && unsure > UNSURE * self.mean_kpa {
            words.push(format!(
                "single places are hardly known: {unsure:.1} kPa is the usual standard deviation, {:.1} kPa the mean tension",
                self.mean_kpa
            ));
        }
        let none = self.tensions_kpa.iter().filter(|tension| **tension <= 0.0).count() as f64;
        let none = none / self.tensions_kpa.len().max(1) as f64;
        if none > MUCH {
            words.push(format!(
                "{:.0} % of the cell has no tension: it gives way or is drawn out there, or moves unlike its model",
                100.0 * none
            ));
        }
        if self.held_at_cut > 0 {
            words.push(format!(
                "the frame cuts the cell: {} points at the cut are held where they were seen, which makes up for what pulls \
                 beyond it",
                self.held_at_cut
            ));
        }
        let modulus = simulation.material.young_modulus();
        words.push(match simulation.support {
            SupportKind::ElasticBed { stiffness } => format!(
                "the tensions are in proportion to the stiffness that was taken, {modulus} kPa of the cell and \
                 {stiffness} kPa/um of its bed"
            ),
            _ => format!(
                "the tensions are in proportion to the stiffness that was taken, {modulus} kPa"
            ),
        });
        words
    }
}

/// The value below which a part of all lies.
fn middle(values: &[f64], part: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(((sorted.len().max(1) - 1) as f64 * part) as usize).copied().unwrap_or(f64::NAN)
}
