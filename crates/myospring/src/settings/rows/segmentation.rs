//! `[segmentation]`.

use super::super::bounds::{Bounds, Whole};
use super::super::problem::Problem;
use super::super::run::Run;
use super::super::setting::{Setting, ValueKind};
use super::super::shape::OUTLINE_ENDINGS;
use super::super::value::Value;
use super::super::words::{Word, Worded, worded};
use crate::microscopy::picture::Depth;
use crate::microscopy::segment::{Choice, Modality};
use crate::units::Dimension;

worded! { Modality {
    Modality::Auto = "auto": "Determined from the grey values.",
    Modality::Fluorescence = "fluorescence": "A bright cell on a dark ground.",
    Modality::Brightfield = "brightfield":
        "A cell visible by its edges and texture; also phase contrast.",
    Modality::Mask = "mask": "Not a picture but its segmentation: background 0.",
} }

/// Largest bound on the area of cells, um^2: a square of 10 mm.
const LARGEST_AREA_UM2: f64 = 1e8;

const DEPTH: &str = "segmentation.z";
const SEED: &str = "segmentation.seed";
const CELL: &str = "segmentation.cell";

pub(super) const ROWS: &[Setting] = &[
    Setting::new(
        "segmentation.modality",
        "How the picture was taken.",
        ValueKind::Words {
            words: Modality::WORDS,
            get: |run| {
                run.shape
                    .source
                    .picture()
                    .map(|picture| picture.options.segmentation.modality.word())
            },
            set: |run, word| {
                let modality = Modality::of_word(word)?;
                if let Some(picture) = run.shape.source.picture_mut() {
                    picture.options.segmentation.modality = modality;
                }
                Some(())
            },
        },
    )
    .otherwise("auto")
    .option("--modality", "NAME"),
    Setting::new(
        "segmentation.channel",
        "Channel of the picture, from 0.",
        ValueKind::Whole {
            bounds: Whole { minimum: 0, maximum: 10_000, example: 0 },
            get: |run| u32::try_from(run.shape.source.picture()?.options.selection.channel?).ok(),
            set: |run, channel| {
                if let Some(picture) = run.shape.source.picture_mut() {
                    picture.options.selection.channel = Some(channel as usize);
                }
            },
        },
    )
    .otherwise("the first, or the luminance of a colour picture")
    .option("--channel", "N"),
    Setting::new(
        "segmentation.frame",
        "Frame (time point) of the picture, from 0.",
        ValueKind::Whole {
            bounds: Whole { minimum: 0, maximum: 1_000_000, example: 0 },
            get: |run| u32::try_from(run.shape.source.picture()?.options.selection.frame).ok(),
            set: |run, frame| {
                if let Some(picture) = run.shape.source.picture_mut() {
                    picture.options.selection.frame = frame as usize;
                }
            },
        },
    )
    .otherwise("0")
    .option("--frame", "N"),
    Setting::new(
        DEPTH,
        "How a stack in depth is reduced: \"max\", \"mean\", or the number of a slice, from 0.",
        ValueKind::Written {
            bounds: None,
            numbers: true,
            example: "max",
            get: |run| {
                Some(match run.shape.source.picture()?.options.selection.depth? {
                    Depth::Maximum => Value::from("max"),
                    Depth::Mean => Value::from("mean"),
                    Depth::Slice(slice) => Value::from(slice.to_string()),
                })
            },
            set: set_depth,
        },
    )
    .otherwise("max")
    .option_saying(
        "--z",
        "max|mean|N",
        "How a stack in depth is reduced: max, mean, or the number of a slice, from 0",
    ),
    Setting::quantity(
        "segmentation.threshold",
        "Threshold; a lower one includes more. Fluorescence: grey value above which a pixel belongs to the cell. \
         Brightfield: least relative change of brightness per um of an edge.",
        Bounds::any(Dimension::Number, "120.5"),
        |run| run.shape.source.picture()?.options.segmentation.threshold,
        |run, threshold| {
            if let Some(picture) = run.shape.source.picture_mut() {
                picture.options.segmentation.threshold = Some(threshold);
            }
        },
    )
    .otherwise("determined from the picture, and printed")
    .option_saying(
        "--threshold",
        "NUMBER",
        "A lower one includes more. Fluorescence: grey value above which a pixel belongs to the cell; brightfield: \
         least relative change of brightness per um of an edge",
    ),
    Setting::quantity(
        "segmentation.smooth",
        "Scale of smoothing.",
        Bounds::any(Dimension::Length, "0.5 um").from(0.0).to(20.0),
        |run| run.shape.source.picture()?.options.segmentation.smooth_um,
        |run, scale| {
            if let Some(picture) = run.shape.source.picture_mut() {
                picture.options.segmentation.smooth_um = Some(scale);
            }
        },
    )
    .otherwise("\"0.5 um\" for fluorescence, \"0.8 um\" for brightfield")
    .option("--smooth", "LENGTH"),
    Setting::new(
        SEED,
        "Takes the cell at this place: column and row in pixels from the top left.",
        ValueKind::Written {
            bounds: None,
            numbers: false,
            example: "120, 85",
            get: |run| match run.shape.source.choice() {
                Some(Choice::At([x, y])) => Some(Value::from(format!("{x}, {y}"))),
                _ => None,
            },
            set: set_seed,
        },
    )
    .option_saying(
        "--seed",
        "X,Y",
        "Take the cell at this place: column and row in pixels from the top left (\"120,85\")",
    ),
    Setting::new(
        CELL,
        "Which cell: \"largest\", or its number by size, 1 being the largest.",
        ValueKind::Written {
            bounds: None,
            numbers: true,
            example: "2",
            get: |run| match (run.shape.source.choice()?, run.shape.source.picture()) {
                (Choice::Number(number), _) => Some(Value::from(number.to_string())),
                (Choice::Largest, Some(_)) => Some(Value::from("largest")),
                _ => None,
            },
            set: set_cell,
        },
    )
    .otherwise("largest; batch: all")
    .option_saying(
        "--cell",
        "all|largest|N",
        "Which cell: largest, or a number by size, 1 being the largest; segment, track and batch \
         also take all",
    ),
    Setting::quantity(
        "segmentation.min_area",
        "Smallest expected area of a cell: batch leaves out smaller ones (debris); elsewhere they are \
         errors unless any size is allowed.",
        Bounds::any(Dimension::Area, "200 um^2").from(0.0).to(LARGEST_AREA_UM2),
        |run| run.shape.source.picture().map(|picture| picture.options.areas_um2[0]),
        |run, area| {
            if let Some(picture) = run.shape.source.picture_mut() {
                picture.options.areas_um2[0] = area;
            }
        },
    )
    .otherwise("\"500 um^2\"")
    .option_saying(
        "--min-area",
        "AREA",
        "Smallest expected area of a cell: batch leaves out smaller ones (debris); elsewhere they are \
         errors unless --any-size is given",
    ),
    Setting::quantity(
        "segmentation.max_area",
        "Largest expected area of a cell: batch leaves out larger ones (sheets, clumps); elsewhere \
         they are errors unless any size is allowed.",
        Bounds::any(Dimension::Area, "40000 um^2").above(0.0).to(LARGEST_AREA_UM2),
        |run| run.shape.source.picture().map(|picture| picture.options.areas_um2[1]),
        |run, area| {
            if let Some(picture) = run.shape.source.picture_mut() {
                picture.options.areas_um2[1] = area;
            }
        },
    )
    .otherwise("\"20000 um^2\"")
    .option_saying(
        "--max-area",
        "AREA",
        "Largest expected area of a cell: batch leaves out larger ones (sheets, clumps); elsewhere they \
         are errors unless --any-size is given",
    ),
    Setting::new(
        "segmentation.allow_cut",
        "Accepts a cell although the frame of the picture cuts it.",
        ValueKind::Flag {
            get: |run| run.shape.source.picture().map(|picture| picture.allow_cut),
            set: |run, allowed| {
                if let Some(picture) = run.shape.source.picture_mut() {
                    picture.allow_cut = allowed;
                }
            },
        },
    )
    .option_saying("--allow-cut", "", "Accept a cell although the frame of the picture cuts it"),
    Setting::new(
        "segmentation.outline",
        "Outline of the cell drawn on the picture in another program, instead of segmentation: GeoJSON, \
         ImageJ's .roi or RoiSet .zip, Cellpose's _outlines.txt; relative to this file.",
        ValueKind::File {
            endings: OUTLINE_ENDINGS,
            words: &[],
            example: "cell.roi",
            get: |run| run.shape.source.picture()?.outline.clone(),
            set: |run, path| {
                if let Some(picture) = run.shape.source.picture_mut() {
                    picture.outline = Some(path);
                }
            },
        },
    )
    .option_saying(
        "--outline",
        "FILE",
        "Outline drawn on the picture in another program, instead of segmentation (.geojson, .roi, .zip, \
         Cellpose's .txt)",
    ),
];

fn set_depth(run: &mut Run, value: &Value) -> Result<(), Problem> {
    let word = value.written();
    let known = ["max", "mean", "the number of a slice, from 0"];
    let depth = word.parse().map_err(|_| Problem::unknown_word(DEPTH, &word, known))?;
    if let Some(picture) = run.shape.source.picture_mut() {
        picture.options.selection.depth = Some(depth);
    }
    Ok(())
}

/// `120, 85`: column and row in pixels.
fn set_seed(run: &mut Run, value: &Value) -> Result<(), Problem> {
    let text = value.written();
    let parts = text.split([',', ';', ' ']).filter(|part| !part.is_empty());
    let numbers: Vec<Option<f64>> = parts.map(|part| part.parse().ok()).collect();
    let [Some(x), Some(y)] = numbers[..] else { return Err(no_place(value)) };
    if !(x.is_finite() && y.is_finite()) {
        return Err(no_place(value));
    }
    if let Some(choice) = run.shape.source.choice_mut() {
        *choice = Choice::At([x, y]);
    }
    Ok(())
}

fn no_place(value: &Value) -> Problem {
    let wanted = "a column and a row in pixels from the top left, like \"120, 85\"".to_owned();
    Problem::Kind { key: SEED.to_owned(), found: value.described(), wanted }
}

fn set_cell(run: &mut Run, value: &Value) -> Result<(), Problem> {
    let word = value.written();
    let chosen = match (word.as_str(), word.parse()) {
        ("largest", _) => Choice::Largest,
        (_, Ok(number)) if number > 0 => Choice::Number(number),
        _ => {
            let known = ["largest", "a number from 1, the largest, on"];
            return Err(Problem::unknown_word(CELL, &word, known));
        }
    };
    if let Some(choice) = run.shape.source.choice_mut() {
        *choice = chosen;
    }
    Ok(())
}
