//! What libtest says, added up over all test binaries, and which tests had to skip.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

/// Tests by their outcome.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    passed: usize,
    failed: usize,
    /// Name of a test, and why it did not do its work, or not all of it.
    skipped: Vec<(String, String)>,
}

impl Tally {
    /// Adds what one run of `cargo test` has printed, and what its tests left in the file that
    /// `MYOSPRING_SKIPPED_TESTS` named: a test and what it lacks in each line.
    ///
    /// libtest counts a test that returns early as passed; here it counts as skipped.
    pub(crate) fn add(&mut self, output: &str, notes: &str) {
        let mut failed = BTreeSet::new();
        for line in output.lines() {
            if let Some(rest) = line.strip_prefix("test result:") {
                self.passed += count(rest, "passed");
                self.failed += count(rest, "failed");
            } else if let Some((name, outcome)) =
                line.strip_prefix("test ").and_then(|line| line.rsplit_once(" ... "))
            {
                if outcome.starts_with("FAILED") {
                    failed.insert(name);
                } else if outcome.starts_with("ignored") {
                    self.skipped.push((name.to_owned(), outcome.to_owned()));
                }
            }
        }
        let mut lacking: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
        for (test, missing) in notes.lines().filter_map(|line| line.split_once('\t')) {
            lacking.entry(test).or_default().insert(missing);
        }
        for (test, missing) in lacking {
            let name = test.split_once("::").map_or(test, |(_, name)| name);
            if !failed.contains(name) {
                self.passed = self.passed.saturating_sub(1);
                let missing: Vec<&str> = missing.into_iter().collect();
                self.skipped.push((test.to_owned(), format!("lacks {}", missing.join(", "))));
            }
        }
    }

    /// The skipped tests by name, and how many there are; empty if there are none.
    pub(crate) fn skipped(&self) -> String {
        if self.skipped.is_empty() {
            return String::new();
        }
        let mut text = format!("\n{} tests skipped, whole or in part:\n", self.skipped.len());
        for (test, why) in &self.skipped {
            _ = writeln!(text, "   {test}: {why}");
        }
        text
    }

    /// The last line: all tests by their outcome.
    pub(crate) fn line(&self) -> String {
        format!("{} passed, {} failed, {} skipped", self.passed, self.failed, self.skipped.len())
    }
}

/// The number before a word, as in `12 passed;`.
fn count(line: &str, word: &str) -> usize {
    let words: Vec<&str> = line.split([' ', ';', '.']).filter(|word| !word.is_empty()).collect();
    let at = words.iter().position(|found| *found == word);
    at.and_then(|at| words.get(at.checked_sub(1)?)?.parse().ok()).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const OUTPUT: &str = "\
running 4 tests
test beat::a_beat ... ok
test cells::two ... ignored, takes an hour
test masks::a_mask ... ok
test masks::broken ... FAILED

test result: FAILED. 2 passed; 1 failed; 1 ignored; 0 measured; 0 filtered out; finished in 0.01s

running 1 test
test crates/myospring/src/units.rs - units::parse (line 12) ... ok

test result: ok. 1 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.00s
";

    #[test]
    fn outcomes_are_added_up_over_all_binaries() {
        let mut tally = Tally::default();
        tally.add(OUTPUT, "");
        tally
            .add("test result: ok. 40 passed; 0 failed; 0 ignored; 0 measured; 2 filtered out", "");
        assert_eq!(tally.line(), "43 passed, 1 failed, 1 skipped");
        assert!(tally.skipped().contains("   cells::two: ignored, takes an hour\n"));
    }

    #[test]
    fn a_test_that_returned_without_its_data_is_skipped_and_not_passed() {
        let mut tally = Tally::default();
        let notes =
            "core::masks::a_mask\ta.png\ncore::masks::a_mask\tb.png\ncore::masks::broken\ta.png\n";
        tally.add(OUTPUT, notes);
        assert_eq!(tally.line(), "2 passed, 1 failed, 2 skipped");
        let text = tally.skipped();
        assert!(text.starts_with("\n2 tests skipped"), "{text}");
        assert!(text.contains("   core::masks::a_mask: lacks a.png, b.png\n"), "{text}");
        assert!(!text.contains("broken"), "{text}");
    }
}
