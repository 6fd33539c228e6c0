//! The tutorials do what they say: each command is run as written, and prints the numbers that the page shows below it.

use super::skipped::{left_to_full, shared_data};
use super::{myospring, stderr, stdout};
use std::path::Path;

/// The numbers of a line, as they are written.
fn numbers(line: &str) -> Vec<&str> {
    let parts = line.split(|c: char| !(c.is_ascii_digit() || c == '.'));
    parts.map(|part| part.trim_matches('.')).filter(|part| !part.is_empty()).collect()
}

/// Whether two numbers are the same but for one in the last digit, which another processor may round otherwise.
fn same(shown: &str, printed: &str) -> bool {
    let decimals = shown.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let [shown, printed] = [shown, printed].map(|number| number.parse::<f64>().unwrap_or(f64::NAN));
    let last = if decimals == 0 { 0.0 } else { 1.01 * 0.1_f64.powf(decimals as f64) };
    (shown - printed).abs() <= last
}

fn shows(printed: &str, line: &str) -> bool {
    let shown = numbers(line);
    printed
        .lines()
        .map(numbers)
        .any(|found| found.len() == shown.len() && shown.iter().zip(found).all(|(a, b)| same(a, b)))
}

/// The words of a command line, of which those with blanks are in quotes.
fn words<'a>(line: &'a str) -> Vec<&'a str> {
    let parts = line.split('"').enumerate();
    let words = |(place, part): (usize, &'a str)| match place % 2 {
        0 => part.split_whitespace().collect(),
        _ => vec![part],
    };
    parts.flat_map(words).collect()
}

/// Runs the commands of a page in a folder with the project's examples; how many lines with numbers it shows.
fn follow(page: &str) -> usize {
    let folder = tempfile::tempdir().unwrap();
    follow_in(page, folder.path())
}

fn follow_in(page: &str, folder: &Path) -> usize {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let text = std::fs::read_to_string(root.join("docs/tutorials").join(page)).unwrap();
    for below in ["tutorial", "studies"] {
        let [from, to] = [root.as_path(), folder].map(|root| root.join("examples").join(below));
        std::fs::create_dir_all(&to).unwrap();
        for file in std::fs::read_dir(from).unwrap().map(|entry| entry.unwrap().path()) {
            std::fs::copy(&file, to.join(file.file_name().unwrap())).unwrap();
        }
    }
    let (mut printed, mut seen) = (String::new(), 0);
    for block in text.split("```").skip(1).step_by(2) {
        let (language, lines) = block.split_once('\n').unwrap();
        for line in lines.lines().filter(|line| language == "sh" || !numbers(line).is_empty()) {
            match language {
                // What is downloaded lies in the folder.
                "sh" if line.starts_with("curl ") => {}
                "sh" => {
                    let output = myospring(folder, &words(line)[1..]);
                    assert!(output.status.success(), "{page}: {line}\n{}", stderr(&output));
                    printed = stdout(&output) + &stderr(&output);
                }
                "text" => {
                    assert!(shows(&printed, line), "{page} shows: {line}\nprinted is:\n{printed}");
                    seen += 1;
                }
                _ => {}
            }
        }
    }
    seen
}

#[test]
#[ignore = "slow"]
fn from_beads_in_a_gel_to_tension_in_kpa() {
    if left_to_full() {
        return;
    }
    assert!(follow("beads-to-kpa.md") > 10);
}

#[test]
#[ignore = "slow"]
fn from_a_picture_to_its_fitted_beat() {
    assert!(follow("picture-to-fit.md") > 10);
}

#[test]
#[ignore = "slow"]
fn from_a_film_of_a_tissue_on_posts_to_its_force() {
    if left_to_full() {
        return;
    }
    assert!(follow("tissue-on-posts.md") > 8);
}

#[test]
fn a_population_of_cells() {
    assert!(follow("population.md") > 2);
}

#[test]
#[ignore = "slow"]
fn a_published_model_beats_the_cell_of_a_picture() {
    if left_to_full() {
        return;
    }
    let Some(model) = shared_data("cell-models/mmt/ohara-2011.mmt") else { return };
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(model, folder.path().join("ohara-2011.mmt")).unwrap();
    assert!(follow_in("published-model.md", folder.path()) > 4);
}
