//! Reading outlines of any format, with limits and checks of their position.

use std::collections::{BTreeMap, BTreeSet};

use super::{
    CoordinateUnit, GivenOutlines, MOST_HOLES, MOST_OUTLINES, MOST_POINTS, MOST_POINTS_IN_FILE,
    NamedOutline, OutlineFileError, OutlineFormat, PixelFrame, Placement, Raw, ReadOptions,
    cellpose, geojson, ring, roi, roi_set,
};
use myospring_core::mesh::outline::Outline;

/// Reads a file of outlines in any of the formats that [`super`] lists; `file_name` is used in
/// errors and as the name of an outline without one.
///
/// Lines and points in a RoiSet or GeoJSON that also contains cells are left out with a note. So
/// are outlines that [`Outline::new`] rejects, if others are valid.
///
/// # Errors
/// Bytes of no known format, damaged or too large ones; kinds of ROI that enclose no area; an
/// outline that lies outside the picture, or only outlines that [`Outline::new`] rejects (the error
/// names the first).
///
/// # Example
/// ```
/// use myospring::mesh::pixel_size::PixelSize;
/// use myospring::microscopy::outlines::{PixelFrame, Placement, ReadOptions, read_outlines};
/// let frame = PixelFrame::new(64, 48, PixelSize::new(0.5)?)?;
/// let options = ReadOptions { placement: Placement::Picture(frame), silent_unit: Default::default() };
/// let corners = br#"{"type": "Feature", "properties": {"unit": "pixel", "name": "left cell"},
///     "geometry": {"type": "Polygon", "coordinates": [[[2,8], [22,8], [22,18], [2,18], [2,8]]]}}"#;
/// let given = read_outlines(corners, "cells.geojson", &options)?;
/// assert_eq!(given.outlines[0].name, "left cell");
/// // Row 8 to 18 of 48 rows of half a micrometre is 15 to 20 um above the lower side.
/// assert_eq!(given.outlines[0].outline.bounds(), [[1.0, 15.0], [11.0, 20.0]]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_outlines(
    bytes: &[u8],
    file_name: &str,
    options: &ReadOptions,
) -> Result<GivenOutlines, OutlineFileError> {
    let format = OutlineFormat::of(bytes);
    let read = match format {
        Some(format) => read_outlines_as(format, bytes, file_name, options),
        None => Err(OutlineFileError::unknown(bytes)),
    };
    // A file with ImageJ's ending and unreadable content is a damaged one.
    let ending = file_name.rsplit_once('.').map(|(_, ending)| ending.to_lowercase());
    let kind = match ending.as_deref() {
        Some("roi") => "ImageJ ROI",
        Some("zip") => "RoiSet zip",
        _ => return read,
    };
    let of_imagej = matches!(format, Some(OutlineFormat::ImageJRoi | OutlineFormat::ImageJRoiSet));
    read.map_err(|error| {
        if of_imagej {
            return error;
        }
        OutlineFileError::NotOfImageJ { name: file_name.to_owned(), kind }
    })
}

/// As [`read_outlines`], for bytes whose format is known.
///
/// # Errors
/// As [`read_outlines`].
///
/// # Example
/// ```
/// use myospring::mesh::pixel_size::PixelSize;
/// use myospring::microscopy::outlines::{
///     OutlineFormat, Placement, ReadOptions, read_outlines_as,
/// };
/// let placement = Placement::Bounds { pixel_size: PixelSize::new(1.0)? };
/// let options = ReadOptions { placement, silent_unit: Default::default() };
/// let error = read_outlines_as(OutlineFormat::ImageJRoi, b"12,30", "a.roi", &options).unwrap_err();
/// assert_eq!(error.to_string(), "a.roi is no ImageJ ROI: it does not start with `Iout`");
/// # Ok::<(), myospring::mesh::pixel_size::PixelSizeError>(())
/// ```
pub fn read_outlines_as(
    format: OutlineFormat,
    bytes: &[u8],
    file_name: &str,
    options: &ReadOptions,
) -> Result<GivenOutlines, OutlineFileError> {
    let mut notes = Vec::new();
    let mut raw = match format {
        OutlineFormat::ImageJRoi => roi::read(bytes, file_name)?,
        OutlineFormat::ImageJRoiSet => roi_set::read(bytes, &mut notes)?,
        OutlineFormat::GeoJson => geojson::read(bytes, options.silent_unit, &mut notes)?,
        OutlineFormat::CellposeText => cellpose::read(bytes)?,
    };
    if raw.is_empty() {
        return Err(OutlineFileError::Empty { notes });
    }
    check_counts(&raw)?;
    settle_names(&mut raw, &mut notes);
    let frame = frame_of(&raw, options.placement, &mut notes)?;
    let mut outlines = Vec::with_capacity(raw.len());
    let mut first = None;
    for raw in raw {
        match place(raw, &frame, options) {
            Ok(outline) => outlines.push(outline),
            // An invalid outline does not affect the others.
            Err(error @ OutlineFileError::Outline { .. }) => {
                notes.push(format!("left out: {error}"));
                first.get_or_insert(error);
            }
            Err(error) => return Err(error),
        }
    }
    if let (Some(error), true) = (first, outlines.is_empty()) {
        return Err(error);
    }
    Ok(GivenOutlines { outlines, notes })
}

/// Most letters of a name: those of files in a zip and of columns have bounds, too.
const LONGEST_NAME: usize = 200;

/// Gives outlines without a name their number, and cuts names that are too long, with a note, so that names that differed still do.
fn settle_names(outlines: &mut [Raw], notes: &mut Vec<String>) {
    for (raw, number) in outlines.iter_mut().zip(1..) {
        raw.name = match raw.name.trim() {
            "" => number.to_string(),
            name => name.to_owned(),
        };
    }
    let (whole, long): (Vec<&mut Raw>, Vec<&mut Raw>) =
        outlines.iter_mut().partition(|raw| raw.name.chars().count() <= LONGEST_NAME);
    let count = long.len();
    let mut taken: BTreeSet<String> = whole.into_iter().map(|raw| raw.name.clone()).collect();
    let mut cut = BTreeMap::new();
    for raw in long {
        let short = cut.entry(raw.name.clone()).or_insert_with_key(|long: &String| {
            let first = |letters: usize| long.chars().take(letters).collect::<String>();
            let mut short = first(LONGEST_NAME).trim().to_owned();
            let mut number = 2;
            while !taken.insert(short.clone()) {
                short = format!("{}-{number}", first(LONGEST_NAME - 8).trim());
                number += 1;
            }
            short
        });
        raw.name.clone_from(short);
    }
    if let Some(name) = cut.into_values().next() {
        notes.push(format!(
            "names of more than {LONGEST_NAME} letters were cut, {count} in all, such as `{name}`"
        ));
    }
}

fn check_counts(raw: &[Raw]) -> Result<(), OutlineFileError> {
    let too_many = |what, found, bound| Err(OutlineFileError::TooMany { what, found, bound });
    if raw.len() > MOST_OUTLINES {
        return too_many("outlines", raw.len(), MOST_OUTLINES);
    }
    let mut all = 0;
    for Raw { rings, .. } in raw {
        let points: usize = rings.iter().map(Vec::len).sum();
        if points > MOST_POINTS {
            return too_many("points in one outline", points, MOST_POINTS);
        }
        if rings.len() > MOST_HOLES + 1 {
            return too_many("holes in one outline", rings.len() - 1, MOST_HOLES);
        }
        all += points;
    }
    if all > MOST_POINTS_IN_FILE {
        return too_many("points in all outlines", all, MOST_POINTS_IN_FILE);
    }
    Ok(())
}

/// The frame of the picture, or one that ends where the outlines do.
fn frame_of(
    raw: &[Raw],
    placement: Placement,
    notes: &mut Vec<String>,
) -> Result<PixelFrame, OutlineFileError> {
    let pixel_size = match placement {
        Placement::Picture(frame) => return Ok(frame),
        Placement::Bounds { pixel_size } => pixel_size,
    };
    let in_pixels = || raw.iter().filter(|raw| raw.unit == CoordinateUnit::Pixel);
    let side = |axis: usize| {
        let points = in_pixels().flat_map(|raw| raw.rings.iter().flatten());
        let largest = points.map(|point| point[axis]).filter(|x| x.is_finite()).fold(1.0, f64::max);
        largest.ceil() as usize
    };
    let frame = PixelFrame::new(side(0), side(1), pixel_size)?;
    if in_pixels().next().is_some() {
        notes.push(format!(
            "the size of the picture is not known: it is assumed to end with the outlines, at {} x {} \
             pixels",
            frame.width(),
            frame.height()
        ));
    }
    Ok(frame)
}

/// Converts a file's polygon to um.
fn place(
    mut raw: Raw,
    frame: &PixelFrame,
    options: &ReadOptions,
) -> Result<NamedOutline, OutlineFileError> {
    if matches!(options.placement, Placement::Picture(_)) {
        check_within(&raw, frame)?;
    }
    if raw.unit == CoordinateUnit::Pixel {
        ring::part_touching(&mut raw.rings, ring::CUT);
        for point in raw.rings.iter_mut().flatten() {
            *point = frame.to_um(*point);
        }
    } else {
        ring::part_touching(&mut raw.rings, ring::CUT * frame.pixel_size().um());
    }
    let mut rings = raw.rings.into_iter();
    let exterior = rings.next().unwrap_or_default();
    match Outline::new(exterior, rings.collect()) {
        Ok(outline) => Ok(NamedOutline { name: raw.name, outline }),
        Err(error) => Err(OutlineFileError::Outline { name: raw.name, error }),
    }
}

/// Coordinates may lie outside the picture by up to a pixel (drawing, rounding); anything more is
/// another picture or another unit.
fn check_within(raw: &Raw, frame: &PixelFrame) -> Result<(), OutlineFileError> {
    const SLACK: f64 = 1.0;
    let within = |[x, y]: [f64; 2]| {
        (-SLACK..=frame.width() as f64 + SLACK).contains(&x)
            && (-SLACK..=frame.height() as f64 + SLACK).contains(&y)
    };
    let in_pixels = |&point: &[f64; 2]| match raw.unit {
        CoordinateUnit::Pixel => point,
        CoordinateUnit::Micrometre => frame.to_pixels(point),
    };
    let outside = raw
        .rings
        .iter()
        .flatten()
        .map(in_pixels)
        .find(|&point| point.iter().all(|value| value.is_finite()) && !within(point));
    match outside {
        None => Ok(()),
        Some([x, y]) => Err(OutlineFileError::Outside {
            name: raw.name.clone(),
            x: (x * 100.0).round() / 100.0,
            y: (y * 100.0).round() / 100.0,
            width: frame.width(),
            height: frame.height(),
        }),
    }
}
