//! What a cell did over time.

/// A cell's course, sampled; all columns have the length of `time_ms`.
#[derive(Debug, Clone, PartialEq)]
pub struct CellTrace {
    /// Times, ms.
    pub time_ms: Vec<f64>,
    /// Names of the state variables.
    pub state_names: &'static [&'static str],
    /// One column per state variable.
    pub states: Vec<Vec<f64>>,
    /// The potential variable, dimensionless.
    pub potential: Vec<f64>,
    /// Membrane potential, mV, where the model defines it.
    pub membrane_potential_mv: Option<Vec<f64>>,
    /// Active tension, dimensionless.
    pub tension: Vec<f64>,
}

/// A maximum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// When, ms.
    pub time_ms: f64,
    /// How high.
    pub value: f64,
}

impl CellTrace {
    /// The column of a state variable.
    pub fn variable(&self, name: &str) -> Option<&[f64]> {
        let index = self.state_names.iter().position(|known| *known == name)?;
        Some(&self.states[index])
    }

    /// The highest point of the potential variable.
    pub fn peak_potential(&self) -> Option<Peak> {
        peak(&self.time_ms, &self.potential)
    }

    /// The highest point of the tension.
    pub fn peak_tension(&self) -> Option<Peak> {
        peak(&self.time_ms, &self.tension)
    }
}

/// The highest point of an evenly sampled curve; `None` if it is empty.
///
/// Between samples the curve is the parabola through the highest sample and its two neighbours; at
/// an end it is the sample itself.
///
/// # Example
/// ```
/// use myospring::cell::trace::peak;
/// let top = peak(&[0.0, 1.0, 2.0], &[0.0, 3.0, 2.0]).unwrap();
/// assert_eq!((top.time_ms, top.value), (1.25, 3.125));
/// ```
pub fn peak(time_ms: &[f64], values: &[f64]) -> Option<Peak> {
    let at = (0..values.len().min(time_ms.len()))
        .reduce(|best, i| if values[i] > values[best] { i } else { best })?;
    let sample = Peak { time_ms: time_ms[at], value: values[at] };
    if at == 0 || at + 1 >= values.len().min(time_ms.len()) {
        return Some(sample);
    }
    let (before, after) = (values[at - 1], values[at + 1]);
    let curvature = before - 2.0 * sample.value + after;
    if curvature >= 0.0 {
        return Some(sample);
    }
    // Vertex of the parabola, in sampling intervals from the highest sample.
    let offset = (before - after) / (2.0 * curvature);
    Some(Peak {
        time_ms: sample.time_ms + offset * (time_ms[at + 1] - time_ms[at - 1]) / 2.0,
        value: sample.value - (before - after) * offset / 4.0,
    })
}

#[cfg(test)]
mod tests {
    use super::peak;

    #[test]
    fn the_peak_of_a_parabola_is_exact_to_rounding() {
        let times: Vec<f64> = (0..10).map(|i| 10.0 + 0.5 * f64::from(i)).collect();
        let values: Vec<f64> = times.iter().map(|t| 3.0 - (t - 12.2) * (t - 12.2)).collect();
        let top = peak(&times, &values).unwrap();
        assert!((top.time_ms - 12.2).abs() < 1e-13 && (top.value - 3.0).abs() < 1e-13, "{top:?}");
    }

    #[test]
    fn a_peak_at_an_end_or_on_a_plateau_is_the_sample() {
        assert_eq!(peak(&[0.0, 1.0], &[2.0, 1.0]).unwrap().value, 2.0);
        assert_eq!(peak(&[0.0, 1.0, 2.0], &[1.0, 1.0, 1.0]).unwrap().time_ms, 0.0);
        assert_eq!(peak(&[], &[]), None);
    }
}
