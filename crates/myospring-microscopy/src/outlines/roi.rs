//! One ImageJ ROI, read.
//!
//! The layout is that of ImageJ's `ij/io/RoiDecoder.java` (<https://github.com/imagej/ImageJ>, public
//! domain); all numbers are big endian:
//!
//! | bytes | what |
//! |---|---|
//! | 0..4 | `Iout` |
//! | 4..6 | version |
//! | 6 | kind: 0 polygon, 1 rectangle, 2 oval, 7 freehand, 8 traced; others enclose no area |
//! | 8..16 | top, left, bottom, right |
//! | 16..18 | number of points; if 0, four bytes at 18 |
//! | 18..34 | four floats: x, y, width, height of a sub-pixel rectangle; the axis of an ellipse |
//! | 36..40 | number of floats of a composite, 0 for others |
//! | 48..50 | subtype: 1 text, 2 arrow, 3 ellipse, 4 image, 5 rotated rectangle |
//! | 50..52 | options: 1 spline, 128 sub-pixel coordinates |
//! | 52..56 | float: ratio of an ellipse's axes, width of a rotated rectangle |
//! | 54..56 | corner diameter of a rounded rectangle |
//! | 60..64 | offset of header 2; at its byte 16 offset and length of the name (UTF-16) |
//! | 64.. | all x then all y as shorts from left and top; then as floats, with option 128 |
//!
//! Coordinates are pixel corners: pixel (0, 0) lies between the points (0, 0) and (1, 1).

use std::f64::consts::TAU;

use super::{CoordinateUnit, MOST_HOLES, MOST_POINTS, OutlineFileError, Raw, ring};

const HEADER: usize = 64;
const SPLINE: u16 = 1;
const SUB_PIXEL: u16 = 128;

/// Sides of the polygon that approximates an ellipse; its area is 0.005 % too small.
const ELLIPSE_SIDES: usize = 360;

/// Reads one ROI; a composite may give several polygons. `file` is its file or entry in the zip.
pub(super) fn read(bytes: &[u8], file: &str) -> Result<Vec<Raw>, OutlineFileError> {
    let roi = Roi::new(bytes, file)?;
    let polygons = roi.polygons()?;
    let name = roi.name().unwrap_or_else(|| stem(file).to_owned());
    let several = polygons.len() > 1;
    let named = polygons.into_iter().enumerate().map(|(index, rings)| Raw {
        name: if several { format!("{name}-{}", index + 1) } else { name.clone() },
        unit: CoordinateUnit::Pixel,
        rings,
    });
    Ok(named.collect())
}

/// A file's name without folders and extension.
fn stem(file: &str) -> &str {
    let name = file.rsplit(['/', '\\']).next().unwrap_or(file);
    match name.rsplit_once('.') {
        Some((stem, _)) if !stem.is_empty() => stem,
        _ => name,
    }
}

struct Roi<'a> {
    bytes: &'a [u8],
    file: &'a str,
}

impl<'a> Roi<'a> {
    fn new(bytes: &'a [u8], file: &'a str) -> Result<Self, OutlineFileError> {
        if !bytes.starts_with(b"Iout") {
            return Err(OutlineFileError::NotARoi { name: file.to_owned() });
        }
        let roi = Self { bytes, file };
        roi.need(HEADER)?;
        Ok(roi)
    }

    fn need(&self, needed: usize) -> Result<(), OutlineFileError> {
        let (name, found) = (self.file.to_owned(), self.bytes.len());
        if found < needed {
            return Err(OutlineFileError::Truncated { name, needed, found });
        }
        Ok(())
    }

    fn array<const N: usize>(&self, at: usize) -> Result<[u8; N], OutlineFileError> {
        let end = at.saturating_add(N);
        match self.bytes.get(at..).and_then(|rest| rest.first_chunk()) {
            Some(array) => Ok(*array),
            None => Err(OutlineFileError::Truncated {
                name: self.file.to_owned(),
                needed: end,
                found: self.bytes.len(),
            }),
        }
    }

    fn word(&self, at: usize) -> Result<u16, OutlineFileError> {
        self.array(at).map(u16::from_be_bytes)
    }

    /// A coordinate in two bytes; values below -5000 are read as unsigned, as in ImageJ.
    fn short(&self, at: usize) -> Result<f64, OutlineFileError> {
        let word = self.word(at)?;
        let signed = word.cast_signed();
        Ok(if signed < -5000 { f64::from(word) } else { f64::from(signed) })
    }

    fn int(&self, at: usize) -> Result<i32, OutlineFileError> {
        self.array(at).map(i32::from_be_bytes)
    }

    fn float(&self, at: usize) -> Result<f64, OutlineFileError> {
        let value = f64::from(f32::from_be_bytes(self.array(at)?));
        if value.is_finite() {
            return Ok(value);
        }
        Err(self.damaged(format!("the coordinate at byte {at} is {value}")))
    }

    fn damaged(&self, reason: String) -> OutlineFileError {
        OutlineFileError::DamagedRoi { name: self.file.to_owned(), reason }
    }

    fn kind(&self, kind: impl Into<String>, mend: &'static str) -> OutlineFileError {
        OutlineFileError::RoiKind { name: self.file.to_owned(), kind: kind.into(), mend }
    }

    /// Name in the second header, if there is one.
    fn name(&self) -> Option<String> {
        let header = usize::try_from(self.int(60).ok()?).ok().filter(|&at| at > 0)?;
        let start = usize::try_from(self.int(header + 16).ok()?).ok()?;
        let length = usize::try_from(self.int(header + 20).ok()?).ok()?;
        let end = start.checked_add(length.checked_mul(2)?)?;
        let text = self.bytes.get(start..end)?;
        let units: Vec<u16> =
            text.chunks_exact(2).map(|pair| u16::from_be_bytes([pair[0], pair[1]])).collect();
        let name = String::from_utf16_lossy(&units).trim().to_owned();
        (!name.is_empty()).then_some(name)
    }

    /// All polygons that the ROI encloses, pixels.
    fn polygons(&self) -> Result<Vec<Vec<Vec<[f64; 2]>>>, OutlineFileError> {
        const OUTLINE: &str = "draw round the cell with a polygon, freehand or brush tool";
        const MASK: &str =
            "in Fiji: Edit > Selection > Create Mask, Edit > Selection > Create Selection";
        let (options, subtype) = (self.word(50)?, self.word(48)?);
        if self.int(36)? > 0 {
            return self.composite();
        }
        let kind = self.bytes[6];
        let ring = match (kind, subtype) {
            (_, 1) => return Err(self.kind("text", OUTLINE)),
            (_, 4) => return Err(self.kind("image", OUTLINE)),
            (0 | 7 | 8, _) if options & SPLINE != 0 => {
                return Err(self.kind("spline-fitted", MASK));
            }
            (7, 3) => self.ellipse()?,
            (7, 5) => self.rotated_rectangle()?,
            (0 | 7 | 8, _) => self.points(options)?,
            (1, _) if self.word(54)? > 0 => return Err(self.kind("rounded rectangle", MASK)),
            (1, _) => {
                let [x, y, width, height] = self.rectangle(options)?;
                vec![[x, y], [x + width, y], [x + width, y + height], [x, y + height]]
            }
            (2, _) => {
                let [x, y, width, height] = self.rectangle(options)?;
                let (a, b) = (width / 2.0, height / 2.0);
                ellipse([x + a, y + b], [a, 0.0], [0.0, b])
            }
            (3, 2) => return Err(self.kind("arrow", OUTLINE)),
            (3, _) => return Err(self.kind("line", OUTLINE)),
            (4, _) => return Err(self.kind("freehand line", OUTLINE)),
            (5, _) => return Err(self.kind("segmented line", OUTLINE)),
            (6, _) => return Err(self.kind("empty", OUTLINE)),
            (9, _) => return Err(self.kind("angle", OUTLINE)),
            (10, _) => return Err(self.kind("point", OUTLINE)),
            (other, _) => return Err(self.damaged(format!("{other} is not a kind of ROI"))),
        };
        Ok(vec![vec![ring]])
    }

    /// x, y, width and height.
    fn rectangle(&self, options: u16) -> Result<[f64; 4], OutlineFileError> {
        const FIRST_SUB_PIXEL_RECTANGLES: u16 = 223;
        if options & SUB_PIXEL != 0 && self.word(4)? >= FIRST_SUB_PIXEL_RECTANGLES {
            return Ok([self.float(18)?, self.float(22)?, self.float(26)?, self.float(30)?]);
        }
        let [top, left] = [self.short(8)?, self.short(10)?];
        Ok([left, top, self.short(14)? - left, self.short(12)? - top])
    }

    fn points(&self, options: u16) -> Result<Vec<[f64; 2]>, OutlineFileError> {
        const FIRST_SUB_PIXEL: u16 = 222;
        let mut count = usize::from(self.word(16)?);
        if count == 0 {
            count = usize::try_from(self.int(18)?).unwrap_or(0);
        }
        if count == 0 {
            return Err(self.damaged("it has no points".to_owned()));
        }
        if count > MOST_POINTS {
            let what = "points in one outline";
            return Err(OutlineFileError::TooMany { what, found: count, bound: MOST_POINTS });
        }
        let fine = options & SUB_PIXEL != 0 && self.word(4)? >= FIRST_SUB_PIXEL;
        self.need(HEADER + count * if fine { 12 } else { 4 })?;
        if fine {
            let start = HEADER + 4 * count;
            let point = |i| Ok([self.float(start + 4 * i)?, self.float(start + 4 * (count + i))?]);
            return (0..count).map(point).collect();
        }
        let [top, left] = [self.short(8)?, self.short(10)?];
        let offset = |at| self.short(at).map(|value| value.max(0.0));
        let point =
            |i| Ok([left + offset(HEADER + 2 * i)?, top + offset(HEADER + 2 * (count + i))?]);
        (0..count).map(point).collect()
    }

    /// An ellipse from the ends of its major axis and the ratio of the axes.
    fn ellipse(&self) -> Result<Vec<[f64; 2]>, OutlineFileError> {
        let [x1, y1, x2, y2] = [self.float(18)?, self.float(22)?, self.float(26)?, self.float(30)?];
        let ratio = self.float(52)?;
        let half = [(x2 - x1) / 2.0, (y2 - y1) / 2.0];
        let across = [-half[1] * ratio, half[0] * ratio];
        Ok(ellipse([x1 + half[0], y1 + half[1]], half, across))
    }

    /// A rectangle from the ends of its middle line and its width.
    fn rotated_rectangle(&self) -> Result<Vec<[f64; 2]>, OutlineFileError> {
        let [x1, y1, x2, y2] = [self.float(18)?, self.float(22)?, self.float(26)?, self.float(30)?];
        let (width, length) = (self.float(52)?, (x2 - x1).hypot(y2 - y1));
        if length == 0.0 {
            return Err(self.damaged("its middle line has no length".to_owned()));
        }
        let half = 0.5 * width / length;
        let [dx, dy] = [-(y2 - y1) * half, (x2 - x1) * half];
        Ok(vec![[x1 + dx, y1 + dy], [x2 + dx, y2 + dy], [x2 - dx, y2 - dy], [x1 - dx, y1 - dy]])
    }

    /// A composite: a path of segments, each a kind and its points, filled by the even-odd rule.
    fn composite(&self) -> Result<Vec<Vec<Vec<[f64; 2]>>>, OutlineFileError> {
        const CURVE_STEPS: usize = 16;
        let count = usize::try_from(self.int(36)?).unwrap_or(0);
        if count > 3 * MOST_POINTS {
            let (what, found) = ("points in one outline", count / 3);
            return Err(OutlineFileError::TooMany { what, found, bound: MOST_POINTS });
        }
        self.need(HEADER + 4 * count)?;
        let number = |place: usize| match place {
            place if place < count => self.float(HEADER + 4 * place),
            _ => Err(self.damaged("its path ends within a segment".to_owned())),
        };
        let point = |place: usize| -> Result<[f64; 2], OutlineFileError> {
            Ok([number(place)?, number(place + 1)?])
        };
        let mut rings: Vec<Vec<[f64; 2]>> = Vec::new();
        let (mut place, mut pen, mut total) = (0, [0.0; 2], 0);
        while place < count {
            let kind = number(place)?;
            let points = match kind {
                0.0 | 1.0 => 1,
                2.0 => 2,
                3.0 => 3,
                4.0 => 0,
                _ => return Err(self.damaged(format!("{kind} is not a kind of segment"))),
            };
            let controls = (0..points)
                .map(|index| point(place + 1 + 2 * index))
                .collect::<Result<Vec<[f64; 2]>, _>>()?;
            place += 1 + 2 * points;
            if kind == 0.0 {
                rings.push(Vec::new());
            }
            let Some(ring) = rings.last_mut() else {
                return Err(self.damaged("its path does not start with a point".to_owned()));
            };
            match controls.as_slice() {
                [] => pen = ring.first().copied().unwrap_or(pen),
                [end] => ring.push(*end),
                curve => {
                    let control: Vec<[f64; 2]> = [&[pen], curve].concat();
                    let at = |step| bezier(&control, step as f64 / CURVE_STEPS as f64);
                    ring.extend((1..=CURVE_STEPS).map(at));
                }
            }
            pen = controls.last().copied().unwrap_or(pen);
            total += if points > 1 { CURVE_STEPS } else { points };
        }
        let found = rings.len();
        if found > MOST_HOLES {
            let what = "rings in one outline";
            return Err(OutlineFileError::TooMany { what, found, bound: MOST_HOLES });
        }
        if total > MOST_POINTS {
            let what = "points in one outline";
            return Err(OutlineFileError::TooMany { what, found: total, bound: MOST_POINTS });
        }
        let polygons = ring::nest(rings);
        if polygons.is_empty() {
            return Err(self.damaged("its path encloses no area".to_owned()));
        }
        Ok(polygons)
    }
}

/// An ellipse from its centre and its two semi-axes.
fn ellipse(centre: [f64; 2], a: [f64; 2], b: [f64; 2]) -> Vec<[f64; 2]> {
    let point = |step: usize| {
        let (sin, cos) = (step as f64 * TAU / ELLIPSE_SIDES as f64).sin_cos();
        [0, 1].map(|axis| centre[axis] + a[axis] * cos + b[axis] * sin)
    };
    (0..ELLIPSE_SIDES).map(point).collect()
}

/// A point of a Bezier curve, by de Casteljau's algorithm.
fn bezier(control: &[[f64; 2]], t: f64) -> [f64; 2] {
    let mut points = control.to_vec();
    while points.len() > 1 {
        points = points
            .windows(2)
            .map(|pair| [0, 1].map(|axis| pair[0][axis] + t * (pair[1][axis] - pair[0][axis])))
            .collect();
    }
    points.first().copied().unwrap_or_default()
}
