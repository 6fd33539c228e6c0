//! The beat of a film that is shown frame by frame.

use crate::analysis::curve::{CurveOptions, State, analyse};
use crate::analysis::kind::Kind;
use crate::microscopy::motion::CellMotion;
use crate::output::figure;

/// One beat of a film.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FilmBeat {
    /// Its number, from 1, and how many beats the film has; `None` where none is found, and all of the film is shown.
    number: Option<[usize; 2]>,
    /// Its frames, by their places in the lists of the motion.
    pub(super) frames: Vec<usize>,
    /// Its characteristic frames with their names: rest, rise, peak, fall, end.
    pub(super) moments: Vec<(usize, &'static str)>,
}

impl FilmBeat {
    /// The first whole beat of which all frames are among `shown`; otherwise the first with as many of them as possible.
    /// `None` if there is no such frame.
    pub(super) fn of(motion: &CellMotion, shown: &[usize]) -> Option<Self> {
        let stretches = motion.stretches();
        let stretches: Vec<f64> = stretches.iter().map(|stretches| stretches.smaller).collect();
        Self::among((&motion.times_ms, &stretches), &motion.frames_with_cell(), shown)
    }

    /// Of the frames that show the cell, `seen`, those that are `shown`, both ascending, by times and stretches of all frames.
    fn among(
        (times_ms, stretches): (&[f64], &[f64]),
        seen: &[usize],
        shown: &[usize],
    ) -> Option<Self> {
        let times: Vec<f64> = seen.iter().map(|&at| times_ms[at]).collect();
        let values: Vec<f64> = seen.iter().map(|&at| stretches[at]).collect();
        let options = CurveOptions::default();
        let found = analyse(&times, &values, Kind::NormalisedLength, "", &options);
        let beats: Vec<(f64, bool)> = found
            .iter()
            .flat_map(|analysis| &analysis.beats)
            .filter_map(|beat| Some((beat.onset_ms?, beat.state == State::Whole)))
            .collect();
        // A beat begins with the last frame at rest, and ends before that of the next.
        let start = |onset: f64| times.partition_point(|time| *time <= onset).saturating_sub(1);
        let mut bounds: Vec<usize> = beats.iter().map(|(onset, _)| start(*onset)).collect();
        bounds.push(seen.len());
        let of = |frames: &[usize]| -> Vec<usize> {
            frames.iter().copied().filter(|at| shown.binary_search(at).is_ok()).collect()
        };
        let each = bounds.windows(2).zip(&beats).map(|(ends, (_, is_whole))| {
            let all = &seen[ends[0].min(ends[1])..ends[1]];
            let frames = of(all);
            let is_covered = *is_whole && frames.len() == all.len();
            (is_covered, frames)
        });
        let each: Vec<(bool, Vec<usize>)> = each.collect();
        let most = each.iter().map(|(_, frames)| frames.len()).max().unwrap_or(0);
        let best = each.iter().position(|(is_covered, _)| *is_covered);
        let best = best.or_else(|| each.iter().position(|(_, frames)| frames.len() == most));
        let (number, frames) = match best.filter(|_| most > 0) {
            Some(best) => (Some([best + 1, each.len()]), each[best].1.clone()),
            None => (None, of(seen)),
        };
        if frames.is_empty() {
            return None;
        }
        let contraction: Vec<f64> = frames.iter().map(|&at| 1.0 - stretches[at]).collect();
        let mut moments = figure::moments(&contraction);
        let last = frames.len() - 1;
        if moments.last().is_some_and(|(at, _)| *at < last) {
            moments.push((last, "end of the beat"));
        }
        let moments = moments.into_iter().map(|(at, name)| (frames[at], name)).collect();
        Some(Self { number, frames, moments })
    }

    /// The frame of its peak.
    pub(super) fn peak(&self) -> usize {
        let peak = self.moments.iter().find(|(_, name)| ["peak", "end of record"].contains(name));
        peak.or(self.moments.first()).map_or(0, |(at, _)| *at)
    }

    /// Which it is: `beat 2 of the 3 in the film`.
    pub(super) fn words(&self) -> String {
        match self.number {
            None => "the film".to_owned(),
            Some([_, 1]) => "the beat of the film".to_owned(),
            Some([number, all]) => format!("beat {number} of the {all} in the film"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Three beats a second apart, from 400 ms on, at 25 frames a second.
    fn film(frames: usize) -> (Vec<f64>, Vec<f64>) {
        let times: Vec<f64> = (0..frames).map(|frame| 40.0 * frame as f64).collect();
        let stretch = |time: &f64| {
            let since = (time - 400.0).rem_euclid(1000.0);
            let part =
                if *time > 400.0 && since < 400.0 { (PI * since / 400.0).sin() } else { 0.0 };
            1.0 - 0.1 * part
        };
        let stretches = times.iter().map(stretch).collect();
        (times, stretches)
    }

    fn names(beat: &FilmBeat) -> Vec<&str> {
        beat.moments.iter().map(|(_, name)| *name).collect()
    }

    #[test]
    fn the_first_whole_beat_is_shown_from_rest_to_the_rest_before_the_next() {
        let (times, stretches) = film(85);
        let all: Vec<usize> = (0..85).collect();
        let beat = FilmBeat::among((&times, &stretches), &all, &all).unwrap();
        assert_eq!(beat.words(), "beat 1 of the 3 in the film");
        assert_eq!(names(&beat), ["at rest", "contracting", "peak", "relaxing", "end of the beat"]);
        let time = |at: usize| times[beat.moments[at].0];
        // A frame is 40 ms.
        assert!((320.0..=440.0).contains(&time(0)) && times[beat.peak()] == 600.0, "{beat:?}");
        assert!((stretches[beat.moments[1].0] - 0.95).abs() < 0.02, "{beat:?}");
        assert!((1280.0..=1440.0).contains(&time(4)), "{beat:?}");
    }

    #[test]
    fn a_beat_that_is_reached_only_in_part_gives_way_to_the_next() {
        let (times, stretches) = film(85);
        let all: Vec<usize> = (0..85).collect();
        let beat = FilmBeat::among((&times, &stretches), &all, &all[14..]).unwrap();
        assert_eq!(beat.words(), "beat 2 of the 3 in the film");
        let few = FilmBeat::among((&times, &stretches), &all, &all[12..16]).unwrap();
        assert_eq!((few.words().as_str(), few.frames.len()), ("beat 1 of the 3 in the film", 4));
        assert_eq!(FilmBeat::among((&times, &stretches), &all, &[]), None);
    }

    #[test]
    fn a_film_without_a_beat_is_shown_as_a_whole() {
        let times: Vec<f64> = (0..30).map(|frame| 40.0 * f64::from(frame)).collect();
        let all: Vec<usize> = (0..30).collect();
        let beat = FilmBeat::among((&times, &[1.0; 30]), &all, &all).unwrap();
        assert_eq!((beat.words().as_str(), beat.frames.len()), ("the film", 30));
        assert_eq!(names(&beat), ["at rest", "end of the beat"]);
    }
}
