//! Checks whether several curves of one recording have the same beats.

use super::answer::{Analysis, CurveBeat};

/// Largest difference between the peaks of one beat in two curves, as a part of the interval
/// between beats.
const TOGETHER: f64 = 0.25;

/// Largest relative difference between the mean interval of a curve and that of the others.
const RHYTHM: f64 = 0.15;

/// Adds a remark to each curve whose rhythm contradicts that of the others. The curves, each with
/// its name, belong to one recording and have one clock. There is no remark unless at least two,
/// and more than half of them, have the same beats; the others may be other cells.
pub fn compare(curves: &mut [(&str, &mut Analysis)]) {
    let peaks: Vec<Vec<f64>> = curves.iter().map(|(_, of)| peaks(&of.beats)).collect();
    let group = |of: &Vec<f64>| -> Vec<usize> {
        (0..peaks.len()).filter(|&other| same(of, &peaks[other])).collect()
    };
    let Some(agreed) = peaks.iter().map(group).max_by_key(Vec::len) else { return };
    if agreed.len() < 2 || 2 * agreed.len() <= curves.len() {
        return;
    }
    let names: Vec<&str> = agreed.iter().take(3).map(|&at| curves[at].0).collect();
    let names = match agreed.len() - names.len() {
        0 => names.join(", "),
        more => format!("{} and {more} more", names.join(", ")),
    };
    let beats = peaks[agreed[0]].len();
    for (at, (_, analysis)) in curves.iter_mut().enumerate() {
        // Other cells may beat at another phase of the same rhythm.
        let usual = cycle(&peaks[agreed[0]]);
        if (cycle(&peaks[at]) - usual).abs() > RHYTHM * usual {
            analysis.remarks.push(format!(
                "its {} beats differ from those of the other columns ({names}: {beats} beats at the same times): which of them \
                 are beats is uncertain; look at the figure",
                peaks[at].len()
            ));
        }
    }
}

/// Times of the peaks, ms.
fn peaks(beats: &[CurveBeat]) -> Vec<f64> {
    let peak = |beat: &CurveBeat| beat.marks.iter().find(|mark| mark.name == "peak").copied();
    beats.iter().filter_map(peak).map(|mark| mark.point.time).collect()
}

/// The mean interval between peaks, ms; `None` for a single one.
fn cycle(peaks: &[f64]) -> f64 {
    match peaks {
        [first, .., last] => (last - first) / (peaks.len() - 1) as f64,
        _ => f64::NAN,
    }
}

/// Whether all beats of two curves peak together, except one cut off by the start or end of the
/// recording.
fn same(one: &[f64], other: &[f64]) -> bool {
    let count = one.len().min(other.len());
    let near = TOGETHER * cycle(one).min(cycle(other));
    let together =
        one.iter().filter(|peak| other.iter().any(|there| (there - **peak).abs() <= near)).count();
    count >= 2 && together == count && one.len().max(other.len()) - count <= 1
}

#[cfg(test)]
mod tests {
    use super::super::{CurveOptions, analyse};
    use super::*;
    use crate::analysis::kind::Kind;

    fn beating(onsets: &[f64]) -> Analysis {
        let times: Vec<f64> = (0..600).map(|frame| 10.0 * f64::from(frame)).collect();
        let pulse = |t: f64| (1.0 - (t / 150.0 - 1.0).abs()).max(0.0);
        let height = |t: f64| onsets.iter().map(|onset| pulse(t - onset)).fold(0.0, f64::max);
        let values: Vec<f64> = times.iter().map(|t| 1.0 - 0.1 * height(*t)).collect();
        analyse(&times, &values, Kind::NormalisedLength, "", &CurveOptions::default()).unwrap()
    }

    #[test]
    fn a_column_that_contradicts_the_others_says_so_and_other_cells_do_not() {
        let three = [400.0, 2000.0, 3600.0];
        let late = [420.0, 2030.0, 3650.0];
        let six = [400.0, 1100.0, 2400.0, 2900.0, 4300.0, 5200.0];
        let other = [900.0, 1900.0, 2900.0, 3900.0];
        let said = |columns: &[&[f64]]| -> Vec<bool> {
            let mut all: Vec<Analysis> = columns.iter().map(|onsets| beating(onsets)).collect();
            let mut named: Vec<(&str, &mut Analysis)> =
                all.iter_mut().map(|analysis| ("column", analysis)).collect();
            compare(&mut named);
            let says = |it: &Analysis| it.remarks.iter().any(|it| it.contains("other columns"));
            all.iter().map(says).collect()
        };
        assert_eq!(said(&[&three, &six, &late]), [false, true, false]);
        assert_eq!(said(&[&three, &late]), [false, false]);
        assert_eq!(said(&[&three, &six, &other]), [false, false, false]);
        assert_eq!(said(&[&three, &late, &six, &other]), [false, false, false, false]);
        assert_eq!(said(&[&six]), [false]);
        let shifted = [1200.0, 2800.0, 4400.0];
        assert_eq!(said(&[&three, &shifted, &late]), [false, false, false]);
    }
}
