//! Sarcomeres of published pictures, ours beside those that `SarcGraph` found.
//!
//! `SarcGraph` (`zhao_2021`, version 0.3.0) draws contours around bright z-discs, pairs neighbours by a score of
//! length and angle, and takes the distance of their centres and its direction: nothing of it is like our
//! period of a local spectrum. Its findings stand in `reference/sarcgraph.csv`, made by
//! `python/sarcgraph_reference.py`; ours are made here, over the whole picture as its are, and compared at each of
//! its sarcomeres where we answer. The pictures are published data, which may be missing.

use crate::check::{Failure, Setting};
use crate::row::Row;
use myospring::analysis::order;
use myospring::mesh::pixel_size::PixelSize;
use myospring::microscopy::fibres::{Fibre, FibreSettings, Stain, fibres};
use myospring::microscopy::picture::Selection;
use myospring::microscopy::read::read_picture;
use serde::Deserialize;
use std::path::Path;

const AGAINST: &str = "SarcGraph 0.3.0";

/// Pictures of rows of z-discs in line, where both must find the same; then those where they need not, and why.
const SAME: [&str; 2] = ["sarcgraph_e1_rest.png", "sarcgraph_e2_rest.png"];
const OTHER: [(&str, &str); 2] = [
    (
        "sarcgraph_e5_fluorescence.png",
        "z-discs 7 pixels apart, blurred into dots: a pair across a z-disc that was missed is one long sarcomere",
    ),
    (
        "sarcgraph_sample_5.png",
        "made-up rows, wavy ones too: the distance of two z-discs out of line is longer than the period along the row",
    ),
];

/// A sarcomere that `SarcGraph` found.
#[derive(Debug, Clone, Deserialize)]
struct Sarcomere {
    picture: String,
    pixel_um: f64,
    column: f64,
    row: f64,
    length_um: f64,
    angle_deg: f64,
}

/// Over this distance directions are averaged, um: ours by default, and so theirs for the comparison.
const SMOOTHING_UM: f64 = 3.0;

/// How parallel their sarcomeres around a place must be for their mean to be a direction, 0 to 1.
const PARALLEL: f64 = 0.7;

/// Ours beside theirs in one picture.
struct Pair {
    /// Part of their sarcomeres where we answer.
    answered: f64,
    /// Median length over all of their sarcomeres there, ours and theirs, um.
    lengths: [f64; 2],
    /// Mean angle of theirs against ours, degrees.
    turned_deg: f64,
    /// Median angle between the two, and between one of theirs and the mean of theirs around it, degrees.
    scatter_deg: [f64; 2],
    /// Where theirs are parallel, part of their means that are more than 30 degrees off ours.
    far: f64,
}

fn median(values: Vec<f64>) -> f64 {
    order::median(values).unwrap_or(f64::NAN)
}

/// Mean of lines with their weights: angle in degrees, and how parallel they are.
fn mean_line(lines: impl Iterator<Item = (f64, f64)>) -> (f64, f64) {
    let (mut x, mut y, mut weights) = (0.0, 0.0, 0.0);
    for (angle_deg, weight) in lines {
        let (sin, cos) = (2.0 * angle_deg.to_radians()).sin_cos();
        (x, y, weights) = (x + weight * cos, y + weight * sin, weights + weight);
    }
    (0.5 * y.atan2(x).to_degrees(), x.hypot(y) / weights)
}

fn apart(a_deg: f64, b_deg: f64) -> f64 {
    let turn = (a_deg - b_deg).rem_euclid(180.0);
    turn.min(180.0 - turn)
}

fn pair(file: &Path, theirs: &[Sarcomere]) -> Result<Pair, Failure> {
    let plane = read_picture(&std::fs::read(file)?, &Selection::default())?.plane;
    let pixel_um = theirs.first().ok_or("SarcGraph found nothing in a picture")?.pixel_um;
    let inside = vec![true; plane.values().len()];
    let settings = FibreSettings { smoothing_um: SMOOTHING_UM, ..FibreSettings::of(Stain::ZDisc) };
    let field = fibres(&plane, &inside, PixelSize::new(pixel_um)?, [1.0, 0.0], &settings)?;
    let both: Vec<(&Sarcomere, Fibre, f64)> = (theirs.iter())
        .filter_map(|one| {
            // Its places are centres of pixels counted from 0, ours lengths from the lower left corner.
            let up = plane.height() as f64 - one.row - 0.5;
            let fibre = field.at([(one.column + 0.5) * pixel_um, up * pixel_um]);
            Some((one, fibre, fibre.sarcomere_um?))
        })
        .collect();
    let around = |one: &Sarcomere| {
        mean_line(theirs.iter().map(|other| {
            let distance = (other.column - one.column).hypot(other.row - one.row) * pixel_um;
            (other.angle_deg, (-0.5 * (distance / SMOOTHING_UM).powi(2)).exp())
        }))
    };
    let turns = both.iter().map(|(one, fibre, _)| (one.angle_deg - fibre.angle_deg(), 1.0));
    let parallel: Vec<bool> = (both.iter())
        .map(|(one, fibre, _)| (around(one), fibre))
        .filter(|((_, parallel), _)| *parallel > PARALLEL)
        .map(|((mean, _), fibre)| apart(mean, fibre.angle_deg()) > 30.0)
        .collect();
    Ok(Pair {
        answered: both.len() as f64 / theirs.len() as f64,
        lengths: [
            median(both.iter().map(|(_, _, ours)| *ours).collect()),
            median(both.iter().map(|(one, ..)| one.length_um).collect()),
        ],
        turned_deg: mean_line(turns).0,
        scatter_deg: [
            median(both.iter().map(|(one, at, _)| apart(one.angle_deg, at.angle_deg())).collect()),
            median(both.iter().map(|(one, ..)| apart(one.angle_deg, around(one).0)).collect()),
        ],
        far: parallel.iter().filter(|&&far| far).count() as f64 / parallel.len() as f64,
    })
}

/// Makes the rows; skipped without the pictures.
///
/// # Errors
/// A picture or the reference that cannot be read.
pub fn rows(setting: &Setting<'_>) -> Result<Vec<Row>, Failure> {
    let reference = Path::new(env!("CARGO_MANIFEST_DIR")).join("reference/sarcgraph.csv");
    let found: Vec<Sarcomere> =
        csv::Reader::from_path(reference)?.deserialize().collect::<Result<_, _>>()?;
    let mut rows = Vec::new();
    let pictures = SAME.map(|name| (name, None)).into_iter();
    for (name, why) in pictures.chain(OTHER.map(|(name, why)| (name, Some(why)))) {
        let file = setting.data.join("images").join(name);
        if !file.exists() {
            let missing = format!("published data: {} is not there", file.display());
            rows.push(Row::skipped(format!("sarcomeres of {name}"), AGAINST, &missing));
            continue;
        }
        let theirs: Vec<Sarcomere> =
            found.iter().filter(|one| one.picture == name).cloned().collect();
        let found = pair(&file, &theirs)?;
        let [ours, other] = found.lengths;
        let length = format!("median sarcomere of {name}");
        let Some(why) = why else {
            rows.extend(same(name, theirs.len(), &found));
            continue;
        };
        rows.push(Row::noted(length, AGAINST, ours, other, "um", why));
    }
    Ok(rows)
}

/// The rows of a picture in which both must find the same.
fn same(name: &str, count: usize, found: &Pair) -> Vec<Row> {
    let [ours, theirs] = found.lengths;
    let [apart, scatter] = found.scatter_deg;
    vec![
        Row::about(
            format!("median sarcomere of {name}"),
            AGAINST,
            ours,
            theirs,
            0.03 * theirs,
            "um",
            "3 %, a third of a pixel: distances of single z-discs there, means over 3 um here",
        ),
        Row::difference(
            format!("mean angle of its sarcomeres against ours, {name}"),
            AGAINST,
            found.turned_deg.abs(),
            3.0,
            "deg",
            format!("two standard errors of {count} directions that scatter by about 25 degrees"),
        ),
        Row::difference(
            format!(
                "part of its means over 3 um that differ by more than 30 degrees, where its sarcomeres are parallel, {name}"
            ),
            AGAINST,
            found.far,
            0.05,
            "",
            "where fibres part, two means need not choose the same one",
        ),
        Row::noted(
            format!("median angle between one of its sarcomeres and ours, {name}"),
            AGAINST,
            apart,
            scatter,
            "deg",
            "the second number is the angle between one of its sarcomeres and its own mean over 3 um: the line \
            between the centres of two z-discs scatters, and a pixel is 5 degrees",
        ),
        Row::about(
            format!("of {count} sarcomeres of {name}: part for which we give a value"),
            AGAINST,
            found.answered,
            1.0,
            0.3,
            "",
            "it also pairs dots outside the striped parts; we give a value where there is a clear period",
        ),
    ]
}
