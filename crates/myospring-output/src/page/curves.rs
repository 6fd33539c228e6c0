//! The curves of a run, with no more samples than a screen shows.

use super::band::Band;
use myospring_core::analysis::beat;
use myospring_core::recording::{Recording, STEEPEST_RISE, Sample};
use serde::Serialize;

/// Samples of a curve beyond which it is thinned.
const MOST: usize = 4000;
/// Significant digits.
const DIGITS: i32 = 6;

#[derive(Debug, Serialize)]
pub(super) struct Curves {
    t_ms: Vec<f64>,
    list: Vec<Curve>,
}

#[derive(Debug, Serialize)]
struct Curve {
    key: String,
    name: String,
    unit: String,
    values: Vec<f64>,
    band: Option<Band>,
}

type Read = fn(&Sample) -> Option<f64>;

/// Potential, where there is one, tension, shortening and whatever else the cell model tells.
pub(super) fn of(recording: &Recording) -> Curves {
    let samples = &recording.samples;
    let curve = |key: &str, name: &str, unit: &str, values: Vec<f64>| Curve {
        key: key.to_owned(),
        name: name.to_owned(),
        unit: unit.to_owned(),
        values,
        band: None,
    };
    let potentials: [(&str, Read); 2] = [("mV", |sample| sample.vm_mv), ("", |sample| sample.u)];
    let known = |(_, read): &(_, Read)| samples.iter().any(|sample| read(sample).is_some());
    let mut list: Vec<Curve> = Vec::new();
    list.extend(potentials.into_iter().find(known).map(|(unit, read)| {
        let values = samples.iter().map(|sample| read(sample).unwrap_or(f64::NAN));
        curve("potential", "Action potential", unit, values.collect())
    }));
    list.extend([
        curve("tension", "Active tension", "kPa", samples.iter().map(|s| s.ta_kpa).collect()),
        Curve {
            band: beat::band("peak_shortening").map(Band::of),
            ..curve(
                "shortening",
                "Shortening",
                "%",
                samples.iter().map(|s| s.shortening_pct).collect(),
            )
        },
    ]);
    // What only grows from beat to beat is a number and no curve.
    let signals = recording.signals.iter().filter(|signal| !signal.is(STEEPEST_RISE));
    list.extend(
        signals
            .map(|it| curve(&format!("signal {}", it.name), &it.name, &it.unit, it.values.clone())),
    );
    let kept = kept(samples.len(), &list);
    for curve in &mut list {
        curve.values = kept.iter().map(|&at| rounded(curve.values[at])).collect();
    }
    Curves { t_ms: kept.iter().map(|&at| rounded(samples[at].t_ms)).collect(), list }
}

/// Which samples to keep: all, or the first, last, least and greatest of each curve in each of many stretches.
fn kept(samples: usize, curves: &[Curve]) -> Vec<usize> {
    if samples <= MOST {
        return (0..samples).collect();
    }
    let stretches = MOST / (2 * curves.len() + 2);
    let mut kept = Vec::new();
    for stretch in 0..stretches {
        let (start, end) = (stretch * samples / stretches, (stretch + 1) * samples / stretches);
        kept.extend([start, end - 1]);
        for curve in curves {
            let by_value = |a: &usize, b: &usize| curve.values[*a].total_cmp(&curve.values[*b]);
            kept.extend((start..end).min_by(by_value));
            kept.extend((start..end).max_by(by_value));
        }
    }
    kept.sort_unstable();
    kept.dedup();
    kept
}

/// A number with as many digits as anybody reads.
pub(super) fn rounded(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    let text = format!("{value:.*e}", (DIGITS - 1) as usize);
    text.parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_curves_keep_their_peaks() {
        let values: Vec<f64> = (0..100_000)
            .map(|i| if i == 54_321 { 9.0 } else { (f64::from(i) * 0.01).sin() })
            .collect();
        let curve = Curve {
            key: String::new(),
            name: String::new(),
            unit: String::new(),
            values,
            band: None,
        };
        let kept = kept(100_000, &[curve]);
        assert!(kept.len() <= MOST && kept.contains(&54_321), "{}", kept.len());
        assert_eq!((kept[0], kept[kept.len() - 1]), (0, 99_999));
        assert!(kept.is_sorted());
    }

    #[test]
    fn numbers_keep_six_digits() {
        assert_eq!(
            [rounded(12.345_678_9), rounded(-1.0 / 3.0), rounded(0.0)],
            [12.3457, -0.333_333, 0.0]
        );
    }
}
