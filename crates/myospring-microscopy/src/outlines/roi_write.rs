//! Writes one ImageJ ROI like `ij/io/RoiEncoder.java`; `roi.rs` documents the layout.

use super::{NamedOutline, PixelFrame};

/// Version that ImageJ 1.52 and later write.
const VERSION: u16 = 228;
const HEADER: usize = 64;
const HEADER_2: usize = 64;
const SUB_PIXEL: u16 = 128;
const POLYGON: u8 = 0;
const RECTANGLE: u8 = 1;
const TRACED: u8 = 8;

/// Largest number of points that the header can hold; longer polygons are written as composites.
const LONGEST_POLYGON: usize = 65_535;

/// Writes an outline as an ImageJ ROI in the pixels of a picture.
///
/// An outline without holes becomes a polygon with sub-pixel points, which can be dragged in Fiji,
/// or a traced ROI if all points are pixel corners; one with holes becomes a composite. Points have
/// single precision: 0.0001 pixel in a picture of 2000 pixels.
///
/// # Example
/// ```
/// use myospring::mesh::{built_in, pixel_size::PixelSize};
/// use myospring::microscopy::outlines::{
///     NamedOutline, PixelFrame, Placement, ReadOptions, read_outlines, write_roi,
/// };
/// let frame = PixelFrame::new(600, 300, PixelSize::new(0.3)?)?;
/// let outline = built_in::adult_ventricular().moved([90.0, 45.0]);
/// let cell = NamedOutline { name: "cell".to_owned(), outline };
/// let bytes = write_roi(&cell, &frame);
/// let options = ReadOptions { placement: Placement::Picture(frame), silent_unit: Default::default() };
/// let back = read_outlines(&bytes, "other.roi", &options)?.outlines.remove(0);
/// assert_eq!(back.name, "cell");
/// assert!((back.outline.area() / cell.outline.area() - 1.0).abs() < 1e-5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_roi(cell: &NamedOutline, frame: &PixelFrame) -> Vec<u8> {
    let rings: Vec<Vec<[f64; 2]>> = cell
        .outline
        .rings()
        .map(|ring| ring.iter().map(|&point| corner(frame.to_pixels(point))).collect())
        .collect();
    let [low, high] = bounds(&rings[0]);
    let mut bytes = vec![0; HEADER];
    bytes[..4].copy_from_slice(b"Iout");
    put(&mut bytes, 4, VERSION);
    for (at, side) in [(8, low[1]), (10, low[0]), (12, high[1]), (14, high[0])] {
        put(&mut bytes, at, short(side));
    }
    if rings.len() == 1 && rings[0].len() <= LONGEST_POLYGON {
        polygon(&mut bytes, &rings[0], low);
    } else {
        composite(&mut bytes, &rings);
    }
    let at = bytes.len() as u32;
    bytes[60..64].copy_from_slice(&at.to_be_bytes());
    bytes.extend(header_2(&cell.name, bytes.len()));
    bytes
}

/// Rounds a point to the pixel's corner if only rounding separates them.
fn corner(point: [f64; 2]) -> [f64; 2] {
    const ROUNDING: f64 = 1e-6;
    point.map(|x| if (x - x.round()).abs() < ROUNDING { x.round() } else { x })
}

fn bounds(ring: &[[f64; 2]]) -> [[f64; 2]; 2] {
    let start = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    ring.iter().fold(start, |[low, high], point| {
        [
            [0, 1].map(|axis| low[axis].min(point[axis].floor())),
            [0, 1].map(|axis| high[axis].max(point[axis].ceil())),
        ]
    })
}

/// A coordinate in two bytes, as ImageJ reads it: -5000 to 60535.
fn short(value: f64) -> u16 {
    value.round().clamp(-5000.0, 60_535.0) as i32 as u16
}

fn put(bytes: &mut [u8], at: usize, word: u16) {
    bytes[at..at + 2].copy_from_slice(&word.to_be_bytes());
}

fn polygon(bytes: &mut Vec<u8>, ring: &[[f64; 2]], low: [f64; 2]) {
    // Whole numbers that surely fit into two bytes.
    let short_range = 0.0..=f64::from(i16::MAX);
    let whole = |&value: &f64| value.fract() == 0.0 && short_range.contains(&value);
    let whole = ring.iter().flatten().all(whole);
    bytes[6] = if whole { TRACED } else { POLYGON };
    put(bytes, 16, ring.len() as u16);
    if !whole {
        put(bytes, 50, SUB_PIXEL);
    }
    for axis in 0..2 {
        bytes.extend(ring.iter().flat_map(|point| short(point[axis] - low[axis]).to_be_bytes()));
    }
    if !whole {
        for axis in 0..2 {
            bytes.extend(ring.iter().flat_map(|point| (point[axis] as f32).to_be_bytes()));
        }
    }
}

fn composite(bytes: &mut Vec<u8>, rings: &[Vec<[f64; 2]>]) {
    const MOVE: f32 = 0.0;
    const LINE: f32 = 1.0;
    const CLOSE: f32 = 4.0;
    bytes[6] = RECTANGLE;
    let mut path = Vec::new();
    for ring in rings {
        for (index, point) in ring.iter().enumerate() {
            path.extend([if index == 0 { MOVE } else { LINE }, point[0] as f32, point[1] as f32]);
        }
        path.push(CLOSE);
    }
    bytes[36..40].copy_from_slice(&(path.len() as u32).to_be_bytes());
    bytes.extend(path.iter().flat_map(|value| value.to_be_bytes()));
}

/// The second header, which starts at byte `at`, and the name.
fn header_2(name: &str, at: usize) -> Vec<u8> {
    let name: Vec<u16> = name.encode_utf16().collect();
    let mut bytes = vec![0; HEADER_2];
    if !name.is_empty() {
        bytes[16..20].copy_from_slice(&((at + HEADER_2) as u32).to_be_bytes());
        bytes[20..24].copy_from_slice(&(name.len() as u32).to_be_bytes());
        bytes.extend(name.iter().flat_map(|unit| unit.to_be_bytes()));
    }
    bytes
}
