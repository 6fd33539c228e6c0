//! What must not be measured: values that no curve of a kind has, metrics across missing frames, times before a stimulus.

use super::{exponential, frames, half_sine, triangle};
use crate::noise::Noise;
use myospring::analysis::curve::{Analysis, CurveError, CurveOptions, State, analyse};
use myospring::analysis::kind::Kind;
use myospring::analysis::{Missing, value};

/// Six beats, a beat each second, above a rest, with noise of a part of their height.
fn beats(rest: f64, height: f64, noise: f64) -> (Vec<f64>, Vec<f64>) {
    let times = frames(250.0, 6.0);
    let mut random = Noise::new(7);
    let value = |t: &f64| {
        rest + height * (half_sine((t - 250.0).rem_euclid(1000.0)) + noise * random.normal())
    };
    let values = times.iter().map(value).collect();
    (times, values)
}

fn analysed(
    times: &[f64],
    values: &[f64],
    kind: Kind,
    unit: &'static str,
) -> Result<Analysis, CurveError> {
    analyse(times, values, kind, unit, &CurveOptions::default())
}

#[test]
fn values_that_no_curve_of_a_kind_has_are_refused_with_frame_value_and_what_they_seem_to_be() {
    for noise in [0.0, 0.01, 0.05] {
        for (kind, unit, rest, height, part) in [
            (
                Kind::Length,
                "um",
                0.0,
                -9.6,
                "a length is above 0; it seems to be a change of length",
            ),
            (
                Kind::Length,
                "um",
                -30.0,
                -9.6,
                "a length is above 0; it seems to be a change of length",
            ),
            (
                Kind::Length,
                "um",
                5.0,
                -9.6,
                "a length is above 0; it seems to be a change of length",
            ),
            (Kind::Length, "px", 0.0, -40.0, "a length is above 0"),
            (Kind::SarcomereLength, "um", 0.0, -0.2, "a length is above 0"),
            (Kind::SarcomereLength, "um", 1800.0, -180.0, "--unit nm"),
            (Kind::NormalisedLength, "", 0.0, -0.1, "a length is above 0"),
            (Kind::Shortening, "%", 0.0, 111.0, "no cell shortens by more than 100 %"),
            (Kind::Calcium, "uM", -0.3, 0.2, "it is not below 0"),
            (Kind::CalciumRatio, "", -1.0, 0.5, "it is not below 0"),
        ] {
            let (times, values) = beats(rest, height, noise);
            let error = analysed(&times, &values, kind, unit).unwrap_err();
            assert!(error.frame().is_some_and(|frame| frame <= values.len()), "{error}");
            let error = error.to_string();
            assert!(error.contains(part), "{kind} at {rest}, noise {noise}: {error}");
        }
    }
}

#[test]
fn noise_around_zero_and_single_wild_frames_refuse_no_curve() {
    for noise in [0.0, 0.01, 0.05] {
        for (kind, unit, rest, height) in [
            (Kind::Length, "um", 120.0, -9.6),
            (Kind::SarcomereLength, "um", 1.8, -0.18),
            (Kind::NormalisedLength, "", 1.0, -0.1),
            (Kind::Shortening, "%", 0.0, 9.0),
            (Kind::Calcium, "uM", 0.0, 0.5),
            (Kind::Calcium, "uM", -0.01, 0.5),
            (Kind::CalciumRatio, "", 0.9, 0.5),
            (Kind::Fluorescence, "a.u.", -0.3, 0.2),
            (Kind::Contraction, "um", 0.0, -9.6),
            (Kind::Force, "nN", -3.0, 2.0),
        ] {
            let (times, clean) = beats(rest, height, noise);
            let mut wild = clean.clone();
            wild[700] = -3.0 * rest.abs().max(height.abs());
            // A camera that lost the cell.
            let mut lost = clean.clone();
            lost[610..650].fill(0.0);
            for values in [clean, wild, lost] {
                let found = analysed(&times, &values, kind, unit);
                assert!(found.is_ok(), "{kind} at {rest}, noise {noise}: {:?}", found.err());
            }
        }
    }
}

/// The frames of a recording without those after `from` and before `to`, ms.
fn without(times: &[f64], values: &[f64], from: f64, to: f64) -> (Vec<f64>, Vec<f64>) {
    times.iter().zip(values).filter(|(t, _)| **t <= from || **t >= to).unzip()
}

/// Holes of 3 to 60 frames at ten places of a beat: what is still read is as without the hole.
#[test]
fn no_metric_is_read_across_missing_frames() {
    for pulse in [triangle as fn(f64) -> f64, half_sine, exponential] {
        let times = frames(250.0, 6.0);
        let height = |t: &f64| pulse((t - 250.0).rem_euclid(1000.0));
        let values: Vec<f64> = times.iter().map(|t| 120.0 - 9.6 * height(t)).collect();
        let whole = analysed(&times, &values, Kind::Length, "um").unwrap();
        for missing in [2, 3, 8, 25, 60] {
            for place in 0..10 {
                let from = 2160.0 + 80.0 * f64::from(place);
                let (t, v) = without(&times, &values, from, from + 4.0 * f64::from(missing + 1));
                let found = analysed(&t, &v, Kind::Length, "um").unwrap();
                let what = format!("{missing} frames from {from} ms");
                assert_eq!(found.treatment.holes.len(), 1, "{what}");
                let said = format!("frames are missing from {from} to");
                assert!(found.remarks.iter().any(|remark| remark.contains(&said)), "{what}");
                for beat in &found.beats {
                    let torn = beat.state == State::Interrupted;
                    for metric in &beat.metrics {
                        assert_eq!(metric.value.is_none(), metric.missing.is_some(), "{what}");
                    }
                    assert!(!torn || value(&beat.metrics, "peak_shortening").is_none(), "{what}");
                }
                for name in ["peak_shortening", "relaxation_time_50", "contraction_duration_10"] {
                    let [own, all] = [&found, &whole].map(|it| it.mean(name).unwrap());
                    // The beats differ from each other by less, in frames of 4 ms.
                    assert!((own / all - 1.0).abs() < 0.005, "{what}: {name}: {own}, not {all}");
                }
            }
        }
        // A single lost frame is no hole.
        let (t, v) = without(&times, &values, 2300.0, 2308.0);
        assert!(analysed(&t, &v, Kind::Length, "um").unwrap().treatment.holes.is_empty());
    }
}

/// Noise and drift of up to a beat each second: whatever is found, a time counts forward, and no number is infinite.
#[test]
fn a_metric_is_a_finite_value_or_a_reason_and_no_time_counts_backward() {
    let mut reasons = 0;
    for seed in 0..60 {
        let frame_rate = if seed % 2 == 0 { 30.0 } else { 250.0 };
        let times = frames(frame_rate, 8.0);
        let mut random = Noise::new(seed);
        let (drift, noise) = (random.normal(), 0.05 * f64::from(seed as u32 % 6));
        let mut walk = 0.0;
        let value_at = |t: &f64| {
            walk += 0.3 * noise * random.normal();
            let beat = triangle((t - 250.0).rem_euclid(400.0 + 10.0 * seed as f64));
            10.0 * (beat + drift * t * 1e-3 + noise * random.normal() + walk)
        };
        let values: Vec<f64> = times.iter().map(value_at).collect();
        let stimuli_ms = if seed % 3 == 0 { vec![300.0, 1300.0, 2300.0] } else { Vec::new() };
        let options = CurveOptions { stimuli_ms, ..CurveOptions::default() };
        for kind in [Kind::Contraction, Kind::Force, Kind::Fluorescence, Kind::Potential] {
            let Ok(found) = analyse(&times, &values, kind, "a.u.", &options) else { continue };
            for metric in found.beats.iter().flat_map(|beat| &beat.metrics) {
                assert_eq!(metric.value.is_some(), metric.missing.is_none(), "{metric:?}");
                reasons += usize::from(metric.missing.is_some());
                let Some(value) = metric.value else { continue };
                assert!(value.is_finite(), "{seed}, {kind}: {metric:?}");
                let duration = metric.unit == "ms" && !metric.name.starts_with("time_of_");
                assert!(!duration || value >= 0.0, "{seed}, {kind}: {metric:?}");
                // A beat has a tenth of the height that it was found with, which it cannot gain within a frame; drift and
                // walk add to its slope.
                let most = 20.0 * frame_rate;
                assert!(
                    metric.name != "shortening_rate_over_peak" || value < most,
                    "{seed}, {kind}: {metric:?}"
                );
            }
        }
    }
    assert!(reasons > 0);
}

#[test]
fn a_stimulus_whose_beat_may_lie_in_a_hole_says_so() {
    let times = frames(250.0, 6.0);
    let height = |t: &f64| half_sine((t - 250.0).rem_euclid(1000.0));
    let values: Vec<f64> = times.iter().map(height).collect();
    let (t, v) = without(&times, &values, 2200.0, 2700.0);
    let stimuli_ms = (0..6).map(|beat| 240.0 + 1000.0 * f64::from(beat)).collect();
    let options = CurveOptions { stimuli_ms, ..CurveOptions::default() };
    let found = analyse(&t, &v, Kind::Force, "nN", &options).unwrap();
    assert_eq!(found.beats[2].state, State::Missed);
    assert!(
        found.beats[2].remarks[0].contains("the gap in the times from 2200 to 2700 ms may hide it")
    );
    let free = analyse(&t, &v, Kind::Force, "nN", &CurveOptions::default()).unwrap();
    assert_eq!(free.beats.len(), 5);
    let interval = free.beats[2].metrics.iter().find(|row| row.name == "interval").unwrap();
    assert_eq!(interval.missing, Some(Missing::Hidden));
}
