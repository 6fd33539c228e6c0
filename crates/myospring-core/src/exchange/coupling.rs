//! How the cells of a tissue are coupled, and which of them are stimulated.

use super::Conduction;
use crate::cell::pacing::Protocol;
use crate::mesh::Mesh;
use crate::mesh::ends::END_PART;
use serde::Serialize;

/// Spacings that a stimulated place reaches at least: fewer nodes lose their charge to their neighbours before they are excited.
const FEWEST_SPACINGS: f64 = 3.0;
/// Time over which the potential spreads while a cell is excited, ms, and how often the length that it spreads in that time a stimulated
/// place reaches at least.
const EXCITED_MS: f64 = 1.0;
const SPREAD_LENGTHS: f64 = 3.0;

/// Cells that stimulate each other: how the potential spreads, and where stimuli come.
#[derive(Debug, Clone, PartialEq)]
pub struct Coupling {
    /// How the potential spreads.
    pub conduction: Conduction,
    /// Which cells the stimuli reach.
    pub stimulated: StimulusPlace,
    /// Which cells an extra stimulus S2 reaches.
    pub s2_stimulated: StimulusPlace,
    /// The current through channels that stretch opens; `None` is none.
    pub stretch_current: Option<StretchCurrent>,
}

/// A current through channels that stretch opens, in proportion to it: `I = G max(0, stretch - 1) (V - E)`, where the stretch is that
/// along the fibres (mechano-electric feedback, `panfilov_2007` and `kohl_1999`; the first has the root of the area in place of it).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StretchCurrent {
    /// Conductance G at twice the length at rest, mS/uF, which is 1/ms.
    pub conductance: f64,
    /// Reversal potential E, mV; a dimensionless potential without millivolts has 1, as in `panfilov_2007`.
    pub reversal_mv: f64,
}

/// Which part of a tissue is stimulated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum StimulusPlace {
    /// All of it.
    Everywhere,
    /// The end where the long axis starts.
    End,
    /// A disc in its middle.
    Centre,
    /// The half to the right of the long axis.
    Half,
}

impl StimulusPlace {
    /// Whether each node of a mesh with this long axis is stimulated. A place is at least so large that a wave can leave it: some
    /// spacings, and some times the length over which the potential spreads while a cell is excited.
    fn of(self, mesh: &Mesh, axis: [f64; 2], conduction: &Conduction) -> Vec<bool> {
        let along = |[x, y]: [f64; 2]| x * axis[0] + y * axis[1];
        let across = |[x, y]: [f64; 2]| y * axis[0] - x * axis[1];
        let spread = (conduction.along.max(conduction.across) * EXCITED_MS).sqrt();
        let spacing = mesh.lattice.as_ref().map_or(0.0, |lattice| lattice.spacing);
        let least = (FEWEST_SPACINGS * spacing).max(SPREAD_LENGTHS * spread);
        let points = || (0..mesh.len()).map(|node| mesh.point(node));
        let range = |place: &dyn Fn([f64; 2]) -> f64| {
            points().map(place).fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| {
                [low.min(at), high.max(at)]
            })
        };
        let ([low, high], [right, left]) = (range(&along), range(&across));
        let within = |is: &dyn Fn([f64; 2]) -> bool| points().map(is).collect();
        match self {
            Self::Everywhere => vec![true; mesh.len()],
            Self::End => {
                let reach = least.max(END_PART * (high - low));
                within(&|at| along(at) - low <= reach)
            }
            Self::Centre => {
                let middle = [f64::midpoint(low, high), f64::midpoint(right, left)];
                let reach = least.max(END_PART * (high - low));
                within(&|at| (along(at) - middle[0]).hypot(across(at) - middle[1]) <= reach)
            }
            Self::Half => {
                let middle = f64::midpoint(right, left);
                within(&|at| across(at) <= middle)
            }
        }
    }
}

impl Coupling {
    /// The protocol of each node: which of the stimuli of `protocol` reach it.
    pub(crate) fn protocols(
        &self,
        mesh: &Mesh,
        axis: [f64; 2],
        protocol: Protocol,
    ) -> Vec<Protocol> {
        let first = self.stimulated.of(mesh, axis, &self.conduction);
        let Some(s2_ms) = protocol.s2_ms() else {
            return first.iter().map(|&is| if is { protocol } else { Protocol::rest() }).collect();
        };
        let train = Protocol { s2_interval_ms: None, ..protocol };
        let s2 = Protocol { start_ms: s2_ms, beats: 1, ..train };
        let second = self.s2_stimulated.of(mesh, axis, &self.conduction);
        let of = |(first, second)| match (first, second) {
            (true, true) => protocol,
            (true, false) => train,
            (false, true) => s2,
            (false, false) => Protocol::rest(),
        };
        first.into_iter().zip(second).map(of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::pacing::Stimulus;
    use crate::mesh::lattice;

    #[test]
    fn each_place_is_where_it_says_and_large_enough_for_a_wave() {
        let mesh = lattice::rectangle(40, 10, 100.0).unwrap();
        let nodes = |place: StimulusPlace, axis, along| {
            let stimulated = place.of(&mesh, axis, &Conduction::even(along));
            let chosen = (0..mesh.len()).filter(|node| stimulated[*node]);
            chosen.map(|node| mesh.point(node)).collect::<Vec<_>>()
        };
        let x = [1.0, 0.0];
        assert_eq!(nodes(StimulusPlace::Everywhere, x, 1.0).len(), mesh.len());
        assert!(nodes(StimulusPlace::End, x, 1.0).iter().all(|[x, _]| *x <= 300.0));
        assert_eq!(nodes(StimulusPlace::End, x, 1.0).len(), 4 * 11);
        assert!(nodes(StimulusPlace::End, [-1.0, 0.0], 1.0).iter().all(|[x, _]| *x >= 3700.0));
        assert_eq!(nodes(StimulusPlace::End, x, 4e4).len(), 7 * 11);
        assert!(nodes(StimulusPlace::Half, x, 1.0).iter().all(|[_, y]| *y <= 500.0));
        let centre = nodes(StimulusPlace::Centre, x, 1.0);
        assert!(
            centre.len() > 20 && centre.iter().all(|[x, y]| (x - 2e3).hypot(y - 500.0) < 301.0)
        );
    }

    #[test]
    fn train_and_extra_stimulus_reach_their_own_places() {
        let mesh = lattice::rectangle(40, 10, 100.0).unwrap();
        let protocol = Protocol {
            beats: 2,
            s2_interval_ms: Some(300.0),
            ..Protocol::once(Stimulus::Jump { amplitude: 0.4 })
        };
        let coupling = Coupling {
            conduction: Conduction::even(1.0),
            stimulated: StimulusPlace::End,
            s2_stimulated: StimulusPlace::Half,
            stretch_current: None,
        };
        let protocols = coupling.protocols(&mesh, [1.0, 0.0], protocol);
        let times = |x: f64, y: f64| {
            let node = (0..mesh.len()).find(|node| mesh.point(*node) == [x, y]).unwrap();
            protocols[node].stimulus_times().collect::<Vec<_>>()
        };
        assert_eq!(times(0.0, 0.0), [50.0, 1050.0, 1350.0]);
        assert_eq!(times(0.0, 1000.0), [50.0, 1050.0]);
        assert_eq!(times(4000.0, 0.0), [1350.0]);
        assert!(times(4000.0, 1000.0).is_empty());
    }
}
