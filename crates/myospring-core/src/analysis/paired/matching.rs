//! Which beat of one curve is which beat of the other.

use crate::analysis::curve::{Analysis, CurveBeat, State};
use crate::analysis::order::median;

/// The beats of two curves that begin within a time, in order; each with its place in both lists, as far as both have it.
pub(super) fn beats(
    one: &Analysis,
    other: &Analysis,
    [from, to]: [f64; 2],
) -> Vec<[Option<usize>; 2]> {
    let sides = [one, other].map(|analysis| {
        let begun = analysis.beats.iter().enumerate().filter_map(|(at, beat)| {
            let onset = beat.onset_ms.filter(|_| beat.state != State::Missed)?;
            (from..=to).contains(&onset).then_some(Begun { at, onset, beat })
        });
        begun.collect::<Vec<_>>()
    });
    let reach = reach(&sides);
    let [one, other] = &sides;
    let mut matched: Vec<(f64, [Option<usize>; 2])> = Vec::new();
    let mut taken = vec![false; other.len()];
    for begun in one {
        let partner = nearest(begun, other, reach).filter(|&place| {
            // In both directions: no other beat is nearer to the partner.
            nearest(&other[place], one, reach).is_some_and(|back| one[back].at == begun.at)
        });
        if let Some(place) = partner {
            taken[place] = true;
        }
        matched.push((begun.onset, [Some(begun.at), partner.map(|place| other[place].at)]));
    }
    let alone = other.iter().zip(taken).filter(|(_, taken)| !taken);
    matched.extend(alone.map(|(begun, _)| (begun.onset, [None, Some(begun.at)])));
    matched.sort_by(|a, b| a.0.total_cmp(&b.0));
    matched.into_iter().map(|(_, places)| places).collect()
}

/// A beat, its place in its list, and its onset, ms.
struct Begun<'a> {
    at: usize,
    onset: f64,
    beat: &'a CurveBeat,
}

/// The beat after the same stimulus or, if a stimulus is not known, that with the nearest onset within reach.
fn nearest(begun: &Begun, others: &[Begun], reach: f64) -> Option<usize> {
    let both_paced = |other: &Begun| begun.beat.stimulus_ms.zip(other.beat.stimulus_ms);
    let distance = |other: &Begun| match both_paced(other) {
        // Stimuli are the same numbers in both curves.
        Some((own, its)) if (own - its).abs() > 1e-6 => f64::INFINITY,
        _ => (other.onset - begun.onset).abs(),
    };
    let near = others.iter().enumerate().map(|(place, other)| (place, distance(other)));
    let (place, distance) = near.min_by(|a, b| a.1.total_cmp(&b.1))?;
    (distance < reach).then_some(place)
}

/// Largest distance between the onsets of one beat, ms: half of the shorter interval between beats; if neither curve has
/// two beats, the longer beat.
fn reach(sides: &[Vec<Begun>; 2]) -> f64 {
    let intervals = sides
        .iter()
        .filter_map(|side| median(side.windows(2).map(|pair| pair[1].onset - pair[0].onset)));
    let shorter = intervals.reduce(f64::min).map(|interval| 0.5 * interval);
    shorter.unwrap_or_else(|| {
        let over = |begun: &Begun| {
            let mut marks = begun.beat.marks.iter().rev();
            let back = marks.find(|mark| mark.name.ends_with("down"));
            back.map_or(0.0, |mark| mark.point.time - begun.onset)
        };
        sides.iter().flatten().map(over).fold(0.0, f64::max)
    })
}
