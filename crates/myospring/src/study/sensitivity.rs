//! Sensitivity analysis: Sobol's indices and Morris's elementary effects.
//!
//! The rows must be those of the sampler of the same name
//! ([`Sampler::Saltelli`](super::sampling::Sampler::Saltelli),
//! [`Sampler::Morris`](super::sampling::Sampler::Morris)), in their order. The result of a failed
//! member is NaN; the base point or trajectory that contains it is skipped and counted.
//!
//! # Example
//! Ishigami's function, whose indices are known:
//! ```
//! use myospring::study::sampling::{Distribution, Sampler, sample};
//! use myospring::study::sensitivity::sobol;
//! use std::f64::consts::PI;
//!
//! let x = Distribution::Uniform { low: -PI, high: PI };
//! let rows = sample(&Sampler::Saltelli { size: 1024, pairs: false }, &[x; 3], 1)?;
//! let ishigami = |x: Vec<f64>| x[0].sin() * (1.0 + 0.1 * x[2].powi(4)) + 7.0 * x[1].sin().powi(2);
//! let answers: Vec<f64> = rows.iter().map(ishigami).collect();
//! let indices = sobol(&answers, 3, false, 1)?;
//! assert!((indices.first[0].value - 0.3139).abs() < 0.02);
//! assert!((indices.total[2].value - 0.2437).abs() < 0.02);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod error;
mod groups;
mod morris;
mod sobol;

pub use error::SensitivityError;
pub use morris::{Effect, Effects, morris};
pub use sobol::{Index, Indices, Pair, sobol};

#[cfg(test)]
mod tests {
    use super::super::sampling::{Distribution, Sampler, sample};
    use super::*;
    use serde_json::Value;
    use std::f64::consts::PI;

    /// Made by `tests/reference/sensitivity.py` with SALib.
    fn salib(design: &str, name: &str) -> Vec<f64> {
        let text = include_str!("../../tests/reference/sensitivity.json");
        let all: Value = serde_json::from_str(text).unwrap();
        all[design][name].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
    }

    fn agree(what: &str, found: impl IntoIterator<Item = f64>, expected: &[f64], tolerance: f64) {
        let found: Vec<f64> = found.into_iter().collect();
        assert_eq!(found.len(), expected.len(), "{what}");
        for (at, (found, expected)) in found.iter().zip(expected).enumerate() {
            let off = (found - expected).abs() / expected.abs().max(1e-3);
            assert!(off < tolerance, "{what} {at}: {found}, not {expected}");
        }
    }

    #[test]
    fn of_the_same_answers_sobol_indices_are_those_of_salib() {
        for (design, pairs) in [("sobol", false), ("sobol_pairs", true)] {
            let found = sobol(&salib(design, "answers"), 4, pairs, 1).unwrap();
            assert_eq!((found.used, found.left_out), (64, 0));
            for (name, indices) in [("first", &found.first), ("total", &found.total)] {
                let of = |read: fn(&Index) -> f64| indices.iter().map(read);
                agree(name, of(|index| index.value), &salib(design, name), 1e-9);
                // Another bootstrap, 200 resamples: a standard deviation known to 5 %, SALib's to 2 %.
                let confidence = salib(design, &format!("{name}_confidence"));
                agree(name, of(|index| index.confidence), &confidence, 0.2);
            }
            let found = found.pairs.iter().map(|pair| pair.index.value);
            agree("pairs", found, &if pairs { salib(design, "pairs") } else { vec![] }, 1e-9);
        }
    }

    #[test]
    fn of_the_same_trajectories_elementary_effects_are_those_of_salib() {
        let text = include_str!("../../tests/reference/sensitivity.json");
        let all: Value = serde_json::from_str(text).unwrap();
        let points: Vec<Vec<f64>> =
            serde_json::from_value(all["morris"]["points"].clone()).unwrap();
        let found = morris(&points, &salib("morris", "answers"), 4, 1).unwrap();
        let of = |read: fn(&Effect) -> f64| found.effects.iter().map(read);
        agree("mean", of(|effect| effect.mean), &salib("morris", "mean"), 1e-9);
        agree("mean size", of(|effect| effect.mean_size), &salib("morris", "mean_size"), 1e-9);
        agree("spread", of(|effect| effect.spread), &salib("morris", "spread"), 1e-9);
        agree("confidence", of(|effect| effect.confidence), &salib("morris", "confidence"), 0.2);
    }

    /// Ishigami and Homma (1990) with a = 7, b = 0.1.
    fn ishigami(x: &[f64]) -> f64 {
        x[0].sin() * (1.0 + 0.1 * x[2].powi(4)) + 7.0 * x[1].sin().powi(2)
    }

    #[test]
    fn the_indices_of_ishigamis_function_come_out_within_their_confidence() {
        let (a, b) = (7.0_f64, 0.1_f64);
        let one = 0.5 * (1.0 + b * PI.powi(4) / 5.0).powi(2);
        let two = a * a / 8.0;
        let both = b * b * PI.powi(8) * (1.0 / 18.0 - 1.0 / 50.0);
        let all = one + two + both;
        let first = [one / all, two / all, 0.0];
        let total = [(one + both) / all, two / all, both / all];
        let x = Distribution::Uniform { low: -PI, high: PI };
        let mut before = f64::INFINITY;
        for size in [256, 1024, 4096] {
            let rows = sample(&Sampler::Saltelli { size, pairs: true }, &[x; 3], 1).unwrap();
            let answers: Vec<f64> = rows.iter().map(|row| ishigami(&row)).collect();
            let found = sobol(&answers, 3, true, 1).unwrap();
            let mut worst = 0.0_f64;
            for (found, exact) in
                found.first.iter().chain(&found.total).zip(first.iter().chain(&total))
            {
                let off = (found.value - exact).abs();
                assert!(off <= found.confidence + 1e-9, "{size}: {found:?}, exact {exact}");
                worst = worst.max(off);
            }
            assert!(worst < before);
            before = worst;
            let [_, interaction, _] = &found.pairs[..] else { panic!("{:?}", found.pairs) };
            assert_eq!(interaction.of, [0, 2]);
            let off = (interaction.index.value - both / all).abs();
            assert!(off <= interaction.index.confidence, "{interaction:?}");
        }
        assert!(before < 0.01, "{before}");
    }

    #[test]
    fn members_that_failed_are_left_out_with_their_base_point_and_counted() {
        let x = Distribution::Uniform { low: -PI, high: PI };
        let sampler = Sampler::Saltelli { size: 256, pairs: false };
        let rows = sample(&sampler, &[x; 3], 1).unwrap();
        let mut answers: Vec<f64> = rows.iter().map(|row| ishigami(&row)).collect();
        let fewer = sobol(&answers[5..], 3, false, 1).unwrap();
        answers[2] = f64::NAN;
        let found = sobol(&answers, 3, false, 1).unwrap();
        assert_eq!((found.used, found.left_out), (255, 1));
        assert_eq!((found.first, found.total), (fewer.first, fewer.total));
        let error = |answers: &[f64]| sobol(answers, 3, false, 1).unwrap_err().to_string();
        assert!(error(&answers[1..]).contains("1279 answers are not a multiple of 5"));
        assert!(error(&[f64::NAN; 10]).contains("only 0 of 2 base points"));
        assert!(error(&[3.0; 20]).contains("all answers are 3"));
    }

    #[test]
    fn a_step_of_morris_over_a_straight_line_gives_its_slope() {
        let sampler = Sampler::Morris { trajectories: 10, levels: 4 };
        let points: Vec<_> = sampler.unit_cube(3, 9).unwrap().iter().collect();
        let answers: Vec<f64> = points.iter().map(|x| 2.0 * x[0] - 3.0 * x[2]).collect();
        let found = morris(&points, &answers, 3, 1).unwrap();
        for (effect, slope) in found.effects.iter().zip([2.0_f64, 0.0, -3.0]) {
            assert!((effect.mean - slope).abs() < 1e-12 && effect.spread < 1e-12, "{effect:?}");
            assert!((effect.mean_size - slope.abs()).abs() < 1e-12);
        }
    }
}
