//! How a beat spreads over a tissue: activation times, conduction velocity, local durations.

use super::{Metric, Missing};
use crate::recording::{LocalBeat, Wave};

/// Names of the metrics.
pub const CONDUCTION_VELOCITY: &str = "conduction_velocity";
/// The time until the last place is activated.
pub const ACTIVATION_TIME: &str = "activation_time";
/// The part that is activated.
pub const ACTIVATED_PART: &str = "activated_part";

/// 1 um/ms is 0.1 cm/s.
const CM_PER_S: f64 = 0.1;
/// Places are looked at for a velocity that are activated in the middle half of the time: before, the stimulus drives the wave, and
/// after, it meets rims.
const MIDDLE: [f64; 2] = [0.25, 0.75];

/// One beat of a tissue, place by place.
#[derive(Debug, Clone, PartialEq)]
pub struct WaveMap {
    /// Activation of each node, ms after the stimulus; `None` where it was not activated.
    pub activation_ms: Vec<Option<f64>>,
    /// From there to 90 % repolarisation, ms.
    pub duration_ms: Vec<Option<f64>>,
    /// Conduction velocity in each triangle, cm/s: 1 over the gradient of the activation time; `None` where a corner was not activated
    /// or all were at once.
    pub velocity_cm_per_s: Vec<Option<f64>>,
}

impl WaveMap {
    /// The first beat of each node from one stimulus to the next, ms.
    pub fn of(wave: &Wave, [stimulus_ms, next_ms]: [f64; 2]) -> Self {
        let own = |beats: &Vec<LocalBeat>| {
            beats.iter().copied().find(|beat| (stimulus_ms..next_ms).contains(&beat.activated_ms))
        };
        let beats: Vec<_> = wave.beats.iter().map(own).collect();
        let activation_ms: Vec<Option<f64>> =
            beats.iter().map(|beat| Some(beat.as_ref()?.activated_ms - stimulus_ms)).collect();
        let duration = |beat: &LocalBeat| Some(beat.repolarised_ms? - beat.activated_ms);
        let duration_ms = beats.iter().map(|beat| duration(beat.as_ref()?)).collect();
        let velocity = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|node| node as usize);
            let place = |node: usize| [wave.points[0][node], wave.points[1][node]];
            let time = |node: usize| activation_ms[node];
            let slope = gradient([place(a), place(b), place(c)], [time(a)?, time(b)?, time(c)?]);
            Some(CM_PER_S / slope).filter(|velocity| velocity.is_finite())
        };
        let velocity_cm_per_s = wave.triangles.iter().map(velocity).collect();
        Self { activation_ms, duration_ms, velocity_cm_per_s }
    }

    /// The median conduction velocity over the triangles that are activated in the middle half of the time, cm/s.
    pub fn conduction_velocity_cm_per_s(&self, wave: &Wave) -> Option<f64> {
        let mut times: Vec<f64> = self.activation_ms.iter().flatten().copied().collect();
        times.sort_by(f64::total_cmp);
        let [first, last] = [*times.first()?, *times.last()?];
        let [from, to] = MIDDLE.map(|part| first + part * (last - first));
        let is_inside = |corners: &[u32; 3]| {
            corners.iter().all(|&node| {
                self.activation_ms[node as usize].is_some_and(|time| (from..=to).contains(&time))
            })
        };
        let inside = wave.triangles.iter().zip(&self.velocity_cm_per_s);
        let inside = inside.filter(|(corners, _)| is_inside(corners));
        let mut velocities: Vec<f64> = inside.filter_map(|(_, velocity)| *velocity).collect();
        velocities.sort_by(f64::total_cmp);
        (!velocities.is_empty()).then(|| {
            let middle = velocities.len() / 2;
            f64::midpoint(velocities[middle], velocities[(velocities.len() - 1) / 2])
        })
    }

    /// The metrics of the beat.
    pub fn metrics(&self, wave: &Wave) -> Vec<Metric> {
        let count = self.activation_ms.len() as f64;
        let activated: Vec<f64> = self.activation_ms.iter().flatten().copied().collect();
        let durations: Vec<f64> = self.duration_ms.iter().flatten().copied().collect();
        let ends = self.activation_ms.iter().zip(&self.duration_ms);
        let ends: Vec<f64> = ends.filter_map(|(start, long)| Some((*start)? + (*long)?)).collect();
        let [lowest, highest] = [f64::min, f64::max].map(|of| ends.iter().copied().reduce(of));
        let mean = |values: &[f64]| {
            (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
        };
        let without = if activated.is_empty() { Missing::NotCaptured } else { Missing::Cut };
        let row = |name, value: Option<f64>, unit, definition| {
            Metric::new(name, value.ok_or(without), unit, definition)
        };
        vec![
            row(
                CONDUCTION_VELOCITY,
                self.conduction_velocity_cm_per_s(wave),
                "cm/s",
                "median over the places that are activated in the middle half of the time, of 1 over the gradient of the activation time",
            ),
            row(
                ACTIVATION_TIME,
                activated.iter().copied().reduce(f64::max),
                "ms",
                "from the stimulus until the last place is activated",
            ),
            row(
                ACTIVATED_PART,
                (count > 0.0).then(|| 100.0 * activated.len() as f64 / count),
                "%",
                "part of the tissue that is activated",
            ),
            row(
                "local_action_potential_duration_90",
                mean(&durations),
                "ms",
                "mean over the places, from activation to 90 % repolarisation",
            ),
            row(
                "repolarisation_spread",
                highest.zip(lowest).map(|(highest, lowest)| highest - lowest),
                "ms",
                "from the first to the last place that has repolarised by 90 %",
            ),
        ]
    }
}

/// Size of the gradient of a quantity that is linear in a triangle.
fn gradient([a, b, c]: [[f64; 2]; 3], [at_a, at_b, at_c]: [f64; 3]) -> f64 {
    let ([ux, uy], [vx, vy]) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
    let (u, v, twice) = (at_b - at_a, at_c - at_a, ux * vy - uy * vx);
    ((u * vy - v * uy) / twice).hypot((v * ux - u * vx) / twice)
}

/// The metrics of one beat of a tissue, from its stimulus to the next, ms.
///
/// # Example
/// ```
/// use myospring::analysis::{value, wave};
/// use myospring::recording::{LocalBeat, Wave};
/// // A wave along x at 500 um/ms = 50 cm/s; each place is active for 300 ms.
/// let points = [vec![0.0, 1e3, 2e3, 3e3, 4e3, 0.0, 1e3, 2e3, 3e3, 4e3], [[0.0; 5], [1e3; 5]].concat()];
/// let triangles = (0..4).flat_map(|at| [[at, at + 1, at + 5], [at + 1, at + 6, at + 5]]).collect();
/// let beat = |x: &f64| vec![LocalBeat { activated_ms: 50.0 + x / 500.0, repolarised_ms: Some(350.0 + x / 500.0) }];
/// let beats = points[0].iter().map(beat).collect();
/// let metrics = wave::metrics(&Wave { points, triangles, beats, tips: Vec::new() }, [50.0, f64::INFINITY]);
/// assert!((value(&metrics, "conduction_velocity").unwrap() - 50.0).abs() < 1e-9);
/// assert!((value(&metrics, "activation_time").unwrap() - 8.0).abs() < 1e-9);
/// assert_eq!(value(&metrics, "activated_part"), Some(100.0));
/// assert!((value(&metrics, "local_action_potential_duration_90").unwrap() - 300.0).abs() < 1e-9);
/// ```
pub fn metrics(wave: &Wave, from_stimulus_to_next_ms: [f64; 2]) -> Vec<Metric> {
    WaveMap::of(wave, from_stimulus_to_next_ms).metrics(wave)
}
