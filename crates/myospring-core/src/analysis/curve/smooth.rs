//! Local parabolas: smoothing that keeps peaks and slopes.

/// Smooths values by least-squares parabolas (Savitzky and Golay 1964) through each sample and
/// `half` samples to each side; times may be uneven. With `half` 0 the values are unchanged.
pub(super) fn smooth(times: &[f64], values: &[f64], half: usize) -> Vec<f64> {
    if half == 0 || values.len() < 3 {
        return values.to_vec();
    }
    let last = values.len() - 1;
    (0..values.len())
        .map(|at| {
            let (from, to) = (at.saturating_sub(half), (at + half).min(last));
            parabola(times, values, from, to, times[at]).unwrap_or(values[at])
        })
        .collect()
}

/// Slopes of the least-squares line through each sample and `half` samples to each side.
pub(super) fn slopes(times: &[f64], values: &[f64], half: usize) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    (0..values.len())
        .map(|at| {
            let (from, to) = (at.saturating_sub(half), (at + half).min(last));
            let count = (to + 1 - from) as f64;
            let mean = |list: &[f64]| list[from..=to].iter().sum::<f64>() / count;
            let (time, value) = (mean(times), mean(values));
            let samples = || times[from..=to].iter().zip(&values[from..=to]);
            let both: f64 = samples().map(|(t, v)| (t - time) * (v - value)).sum();
            let square: f64 = samples().map(|(t, _)| (t - time).powi(2)).sum();
            if square > 0.0 { both / square } else { 0.0 }
        })
        .collect()
}

/// The value at a time of the parabola through the samples `from..=to`; `None` if they do not
/// determine it.
fn parabola(times: &[f64], values: &[f64], from: usize, to: usize, at: f64) -> Option<f64> {
    let scale = (times[to] - times[from]).max(f64::MIN_POSITIVE);
    let mut sums = [0.0; 5];
    let mut right = [0.0; 3];
    for (time, value) in times[from..=to].iter().zip(&values[from..=to]) {
        let x = (time - at) / scale;
        let mut power = 1.0;
        for (order, sum) in sums.iter_mut().enumerate() {
            *sum += power;
            if order < 3 {
                right[order] += power * (value - values[from]);
            }
            power *= x;
        }
    }
    // Cramer's rule for the constant term.
    let [s0, s1, s2, s3, s4] = sums;
    let determinant =
        s0 * (s2 * s4 - s3 * s3) - s1 * (s1 * s4 - s2 * s3) + s2 * (s1 * s3 - s2 * s2);
    let constant = right[0] * (s2 * s4 - s3 * s3) - s1 * (right[1] * s4 - s3 * right[2])
        + s2 * (right[1] * s3 - s2 * right[2]);
    Some(values[from] + constant / determinant).filter(|value| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_over_uneven_times_stays_as_it_is() {
        let times: Vec<f64> = (0..40).map(|i| f64::from(i) + 0.3 * f64::from(i % 3)).collect();
        let values: Vec<f64> = times.iter().map(|t| 3.0 - 0.2 * t + 0.05 * t * t).collect();
        for (smooth, value) in smooth(&times, &values, 4).iter().zip(&values) {
            assert!((smooth - value).abs() < 1e-9, "{smooth} {value}");
        }
    }
}
