//! Runs of frames.

/// Runs of marked frames, first and last.
pub(super) fn runs(bad: &[bool]) -> Vec<[usize; 2]> {
    let mut runs: Vec<[usize; 2]> = Vec::new();
    for (at, _) in bad.iter().enumerate().filter(|(_, bad)| **bad) {
        match runs.last_mut() {
            Some(run) if run[1] + 1 == at => run[1] = at,
            _ => runs.push([at, at]),
        }
    }
    runs
}
