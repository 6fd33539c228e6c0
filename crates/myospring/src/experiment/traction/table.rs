//! Displacements from a table of places, as programs for particle image velocimetry write them.
//!
//! A row has a place and its displacement: `x, y, u, v`, to the right and downward, in pixels (or um, where the names say so), and
//! perhaps a `frame`. Fields are parted by commas, semicolons, tabs or spaces; without names the first four columns count. The
//! places of a frame form a lattice, in any order.

use super::measured::{Displacements, Grid, upward};
use crate::experiment::{ExperimentError, Files};
use crate::mechanics::gel::Surface;
use crate::mechanics::gel::cytometry::Errors;
use std::path::Path;

/// Fewest columns and rows of places.
const LEAST: usize = 8;
/// Places this part of a spacing apart are in one column or row.
const SAME: f64 = 0.25;

/// The names of columns, in small letters and without their unit.
const NAMES: [&[&str]; 4] =
    [&["x"], &["y"], &["u", "ux", "u_x", "dx"], &["v", "uy", "u_y", "vy", "dy"]];
const FRAME: [&str; 3] = ["frame", "t", "slice"];

/// A row: its line, frame, place and displacement.
struct Row {
    line: usize,
    frame: f64,
    values: [f64; 4],
}

/// Which columns of a table are which.
struct Columns {
    places: [usize; 4],
    frame: Option<usize>,
    /// Whether places, and displacements, are in um.
    in_um: [bool; 2],
}

impl Columns {
    fn first_four() -> Self {
        Self { places: [0, 1, 2, 3], frame: None, in_um: [false; 2] }
    }

    /// By the names in a head; `None` if one is missing.
    fn named(head: &[&str]) -> Option<Self> {
        let read = |name: &&str| {
            let name = name.trim_matches('"').to_lowercase();
            let stem =
                name.split(['[', '(']).next().unwrap_or_default().trim_end_matches(['_', ' ']);
            let is_um =
                name.contains("um") || name.contains("\u{b5}m") || name.contains("\u{3bc}m");
            let stem = stem.trim_end_matches("_um").trim_end_matches("_px").to_owned();
            (stem, is_um)
        };
        let names: Vec<(String, bool)> = head.iter().map(read).collect();
        let find =
            |known: &[&str]| names.iter().position(|(name, _)| known.contains(&name.as_str()));
        let places = NAMES.map(find);
        let [Some(x), Some(y), Some(u), Some(v)] = places else { return None };
        Some(Self {
            places: [x, y, u, v],
            frame: find(&FRAME),
            in_um: [names[x].1 && names[y].1, names[u].1 && names[v].1],
        })
    }
}

fn fields(line: &str) -> Vec<&str> {
    let parted = |mark: char| line.split(mark).map(str::trim).collect();
    // A decimal comma parts no fields.
    match [';', '\t', ','].into_iter().find(|mark| line.contains(*mark)) {
        Some(mark) => parted(mark),
        None => line.split_whitespace().collect(),
    }
}

fn rows(
    text: &str,
    failed: &dyn Fn(String) -> ExperimentError,
) -> Result<(Vec<Row>, [bool; 2]), ExperimentError> {
    let lines = text.lines().enumerate().map(|(at, line)| (at + 1, line.trim()));
    let mut lines =
        lines.filter(|(_, line)| !line.is_empty() && !line.starts_with(['#', '%'])).peekable();
    let Some((_, head)) = lines.peek().copied() else {
        return Err(failed("it is empty".to_owned()));
    };
    let head = fields(head);
    let is_named = head.first().is_some_and(|name| name.parse::<f64>().is_err());
    let columns = if is_named {
        lines.next();
        Columns::named(&head).ok_or_else(|| {
            failed(format!("its columns are {}; x, y, u and v are needed", head.join(", ")))
        })?
    } else {
        Columns::first_four()
    };
    let mut rows = Vec::new();
    for (line, text) in lines {
        let fields = fields(text);
        let number = |column: usize| -> Result<f64, ExperimentError> {
            let field = fields.get(column).copied().unwrap_or_default();
            let number =
                field.replace(',', ".").parse::<f64>().ok().filter(|number| number.is_finite());
            number.ok_or_else(|| {
                failed(format!("line {line}: `{field}` in column {} is no number", column + 1))
                    .advise("fill missing displacements, for example from their neighbours")
            })
        };
        let [x, y, u, v] = columns.places;
        let values = [number(x)?, number(y)?, number(u)?, number(v)?];
        let frame = columns.frame.map_or(Ok(0.0), number)?;
        rows.push(Row { line, frame, values });
    }
    Ok((rows, columns.in_um))
}

/// The distinct values of an axis, ascending, and their distance; `None` if that varies.
fn axis(values: impl Iterator<Item = f64>) -> Option<(Vec<f64>, f64)> {
    let mut all: Vec<f64> = values.collect();
    all.sort_by(f64::total_cmp);
    let range = all.last()? - all.first()?;
    all.dedup_by(|a, b| *a - *b <= 1e-6 * range);
    let spacing = range / (all.len().max(2) - 1) as f64;
    let is_even = |pair: &[f64]| (pair[1] - pair[0] - spacing).abs() < SAME * spacing;
    (all.len() > 1 && all.windows(2).all(is_even)).then_some((all, spacing))
}

/// The displacements of a table. `pixel_um` is the side of a pixel, `unit_um` what a displacement of 1 is.
pub(super) fn read(
    path: &Path,
    (pixel_um, unit_um): (Option<f64>, Option<f64>),
    files: &Files,
) -> Result<Displacements, ExperimentError> {
    let name = path.display();
    let failed = |what: String| ExperimentError::new(format!("`{name}`: {what}"));
    let (mut rows, [places_in_um, moved_in_um]) = rows(&files.text(path)?, &failed)?;
    let pixel = || {
        pixel_um.ok_or_else(|| {
            failed("it does not say how large pixels are".to_owned()).advise(
                "give it like --pixel-size \"0.16 um\", or name the columns x_um, y_um, u_um and v_um",
            )
        })
    };
    let scale = if places_in_um { 1.0 } else { pixel()? };
    let unit = match unit_um {
        Some(unit) => unit,
        None if moved_in_um => 1.0,
        None => pixel()?,
    };
    let uneven = || {
        failed("its places form no lattice".to_owned()).advise(
            "displacements of single beads must be interpolated at even distances first, for example with scipy.interpolate.griddata",
        )
    };
    let (xs, spacing) = axis(rows.iter().map(|row| row.values[0])).ok_or_else(uneven)?;
    let (ys, other) = axis(rows.iter().map(|row| row.values[1])).ok_or_else(uneven)?;
    if (spacing / other - 1.0).abs() > 1e-3 {
        return Err(uneven().also(&format!(
            "columns are {spacing} apart, rows {other}; both distances must be the same"
        )));
    }
    let (columns, count) = (xs.len(), ys.len());
    if columns < LEAST || count < LEAST {
        return Err(failed(format!(
            "it has {columns} columns and {count} rows of places; at least {LEAST} of each are needed"
        )));
    }
    rows.sort_by(|a, b| a.frame.total_cmp(&b.frame));
    let mut surfaces = Vec::new();
    for frame in rows.chunk_by(|a, b| a.frame == b.frame) {
        let mut moved = [(); 2].map(|()| vec![f64::NAN; columns * count]);
        for Row { line, values: [x, y, u, v], .. } in frame {
            let column = ((x - xs[0]) / spacing).round() as usize;
            let row = ((y - ys[0]) / spacing).round() as usize;
            let at = row * columns + column;
            if !moved[0][at].is_nan() {
                return Err(failed(format!("line {line}: a second displacement at {x}, {y}")));
            }
            (moved[0][at], moved[1][at]) = (*u, *v);
        }
        if let Some(at) = moved[0].iter().position(|moved| moved.is_nan()) {
            let (x, y, number) = (xs[at % columns], ys[at / columns], frame[0].frame);
            return Err(failed(format!("there is no displacement at {x}, {y} in frame {number}"))
                .advise("fill missing displacements, for example from their neighbours"));
        }
        surfaces.push(Surface {
            spacing: scale * spacing,
            origin: [0.0; 2],
            shape: [columns, count],
            displacements: [upward(&moved[0], columns, unit), upward(&moved[1], columns, -unit)],
        });
    }
    let first = surfaces[0].displacements[0][0];
    let still = |surface: &Surface| {
        let [u, v] = &surface.displacements;
        u.iter().all(|moved| *moved == first) && v.iter().all(|moved| *moved == v[0])
    };
    if surfaces.iter().all(still) {
        return Err(failed("nothing moves: all displacements are the same".to_owned()));
    }
    Ok(Displacements {
        frames: (0..surfaces.len()).collect(),
        grid: Grid::of_pixels([columns, count], scale * spacing),
        surfaces,
        frame_rate_per_s: None,
        errors: Errors::default(),
        followed: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A lattice of 9 by 8 places, every 16 pixels, whose displacements are a tenth and a twentieth of the place.
    fn table(head: &str, mark: &str) -> String {
        let places = (0..72_u32).rev().map(|at| [8 + 16 * (at % 9), 8 + 16 * (at / 9)]);
        let row = |[x, y]: [u32; 2]| {
            let [u, v] = [0.1 * f64::from(x), 0.05 * f64::from(y)];
            [x.to_string(), y.to_string(), u.to_string(), v.to_string()].join(mark)
        };
        std::iter::once(head.to_owned()).chain(places.map(row)).collect::<Vec<_>>().join("\n")
    }

    fn found(text: String, pixel: Option<f64>) -> Result<Displacements, ExperimentError> {
        let files = Files::holding([("piv.txt".to_owned(), text.into_bytes())].into());
        read(Path::new("piv.txt"), (pixel, None), &files)
    }

    #[test]
    fn a_lattice_is_read_in_any_order_with_any_mark_and_unit() {
        for (head, mark, pixel) in [
            ("x,y,u,v", ",", Some(0.5)),
            ("# x y ux1 uy1 mag1", " ", Some(0.5)),
            ("x\ty\tdx\tdy", "\t", Some(0.5)),
            ("\"x [px]\";\"y [px]\";\"u [px]\";\"v [px]\"", ";", Some(0.5)),
        ] {
            let read = found(table(head, mark), pixel).unwrap();
            let surface = &read.surfaces[0];
            assert_eq!((surface.shape, surface.spacing), ([9, 8], 8.0), "{head}");
            // The first place is the lowest one on the left; down is negative.
            let [u, v] = &surface.displacements;
            assert!((u[0] - 0.4).abs() < 1e-12 && (v[0] + 0.5 * 0.05 * 120.0).abs() < 1e-12);
        }
        let decimal_commas = table("x;y;u;v", ";").replace('.', ",");
        assert_eq!(found(decimal_commas, Some(0.5)).unwrap().surfaces[0].shape, [9, 8]);
        let read = found(table("x_um,y_um,u_um,v_um", ","), None).unwrap();
        assert!((read.surfaces[0].spacing - 16.0).abs() < 1e-12);
    }

    #[test]
    fn what_is_missing_is_said_with_its_line() {
        let of = |text: String| found(text, Some(1.0)).unwrap_err().to_string();
        let good = table("x,y,u,v", ",");
        assert!(of(good.replace("x,y,u,v", "x,y,w,v")).contains("x, y, w, v; x, y, u and v"));
        assert!(of(good.replacen("136,120,", "136,120,nan", 1)).contains("line 2: `nan"));
        let mut lines: Vec<&str> = good.lines().collect();
        lines.remove(3);
        assert!(of(lines.join("\n")).contains("no displacement at 104, 120 in frame 0"));
        assert!(of(format!("{good}\n8,8,0,0")).contains("a second displacement"));
        assert!(of(good.replacen("136,", "141,", 4)).contains("no lattice"));
        assert!(of(String::new()).contains("empty"));
        let unsized_pixels = found(good, None).unwrap_err().to_string();
        assert!(unsized_pixels.contains("how large pixels are"), "{unsized_pixels}");
    }
}
