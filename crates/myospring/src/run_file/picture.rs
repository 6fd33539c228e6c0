//! `[segmentation]`: how the cell of a picture is found.

use super::bounds::{self, Setting};
use super::error::Problem;
use super::resolve::{Checked, fail, with_ending};
use super::shape::PictureSource;
use super::{SegmentationTable, ShapeTable};
use crate::microscopy::cells::Options;
use crate::microscopy::picture::{Depth, Selection};
use crate::microscopy::segment::{Choice, Settings};

/// Endings of the pictures that are read.
pub(super) const PICTURES: &[&str] = &["png", "tif", "tiff"];

/// Endings of files of outlines; those of `shape.outline` first.
pub(super) const OUTLINES: &[&str] = &["geojson", "json", "csv", "roi", "zip", "txt"];

pub(super) fn resolve(
    path: &str,
    shape: &ShapeTable,
    table: &SegmentationTable,
) -> Checked<PictureSource> {
    let pixel_size =
        shape.pixel_size.as_ref().map(|size| bounds::PIXEL_SIZE.read(size)).transpose()?;
    let selection = Selection {
        channel: bounds::CHANNEL.read(table.channel)?,
        frame: bounds::FRAME.read(table.frame)?.unwrap_or(0),
        depth: table.z.as_ref().map(depth).transpose()?,
    };
    if let Some(value) = table.threshold.filter(|value| !value.is_finite()) {
        let key = "segmentation.threshold";
        return fail(key, Problem::NotFinite { key: key.to_owned(), value });
    }
    let default = Settings::default();
    let segmentation = Settings {
        modality: table.modality.unwrap_or_default(),
        threshold: table.threshold,
        smooth_um: table.smooth.as_ref().map(|smooth| bounds::SMOOTH.read(smooth)).transpose()?,
        ..default
    };
    let outline = table.outline.as_ref();
    Ok(PictureSource {
        path: with_ending("shape.picture", path, PICTURES)?,
        outline: outline
            .map(|path| with_ending("segmentation.outline", path, OUTLINES))
            .transpose()?,
        options: Options { selection, pixel_size_um: pixel_size, segmentation },
        choice: choice(shape, table)?,
        allow_cut: table.allow_cut.unwrap_or(false),
    })
}

fn depth(setting: &Setting) -> Checked<Depth> {
    let word = match setting {
        Setting::Number(number) => number.to_string(),
        Setting::Text(word) => word.trim().to_owned(),
    };
    word.parse().or_else(|_| {
        let known = ["max", "mean", "the number of a slice, from 0"].map(str::to_owned).to_vec();
        let key = "segmentation.z".to_owned();
        fail("segmentation.z", Problem::UnknownWord { key, word, suggestion: None, known })
    })
}

/// Which cell: by label, by place, or by number.
pub(super) fn choice(shape: &ShapeTable, table: &SegmentationTable) -> Checked<Choice> {
    let given: Vec<&'static str> = [
        ("shape.label", shape.label.is_some()),
        ("segmentation.seed", table.seed.is_some()),
        ("segmentation.cell", table.cell.is_some()),
    ]
    .into_iter()
    .filter_map(|(key, given)| given.then_some(key))
    .collect();
    if let [first, second, ..] = given[..] {
        let advice = "each chooses the cell; leave one of them out";
        return fail(second, Problem::Conflict { first, second, advice });
    }
    if let Some(label) = bounds::LABEL.read(shape.label)? {
        return Ok(Choice::Label(label));
    }
    if let Some(seed) = &table.seed {
        return place(seed);
    }
    let unknown = |word: String| {
        let known = ["largest", "a number from 1, the largest, on"].map(str::to_owned).to_vec();
        let key = "segmentation.cell".to_owned();
        fail("segmentation.cell", Problem::UnknownWord { key, word, suggestion: None, known })
    };
    match &table.cell {
        None => Ok(Choice::Largest),
        Some(Setting::Text(word)) if word.trim() == "largest" => Ok(Choice::Largest),
        Some(setting) => {
            let text = match setting {
                Setting::Number(number) => number.to_string(),
                Setting::Text(text) => text.trim().to_owned(),
            };
            match text.parse() {
                Ok(number) if number > 0 => Ok(Choice::Number(number)),
                _ => unknown(text),
            }
        }
    }
}

/// `120, 85`: column and row in pixels.
fn place(text: &str) -> Checked<Choice> {
    let numbers: Vec<Option<f64>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    match numbers[..] {
        [Some(x), Some(y)] if x.is_finite() && y.is_finite() => Ok(Choice::At([x, y])),
        _ => {
            let key = "segmentation.seed".to_owned();
            let found = format!("the text \"{text}\"");
            let wanted =
                "a column and a row in pixels from the top left, like \"120, 85\"".to_owned();
            fail("segmentation.seed", Problem::Kind { key, found, wanted })
        }
    }
}

/// The tables that give this picture again.
pub(super) fn write(source: &PictureSource, shape: &mut ShapeTable) -> SegmentationTable {
    let PictureSource { path, outline, options, choice, allow_cut } = source;
    let Options { selection, pixel_size_um, segmentation } = options;
    shape.picture = Some(path.clone());
    shape.pixel_size = pixel_size_um.map(|size| bounds::PIXEL_SIZE.write(size));
    let mut table = SegmentationTable {
        outline: outline.clone(),
        modality: Some(segmentation.modality),
        channel: selection.channel.and_then(|channel| i64::try_from(channel).ok()),
        frame: i64::try_from(selection.frame).ok(),
        z: selection.depth.map(|depth| match depth {
            Depth::Maximum => Setting::Text("max".to_owned()),
            Depth::Mean => Setting::Text("mean".to_owned()),
            Depth::Slice(slice) => Setting::Text(slice.to_string()),
        }),
        threshold: segmentation.threshold,
        smooth: segmentation.smooth_um.map(|smooth| bounds::SMOOTH.write(smooth)),
        allow_cut: Some(*allow_cut),
        ..SegmentationTable::default()
    };
    match choice {
        Choice::Largest => table.cell = Some(Setting::Text("largest".to_owned())),
        Choice::Number(number) => table.cell = Some(Setting::Text(number.to_string())),
        Choice::Label(label) => shape.label = Some(i64::from(*label)),
        Choice::At([x, y]) => table.seed = Some(format!("{x}, {y}")),
    }
    table
}
