//! Tables of values by place in a cell: one row per triangle or node, or points, of which each
//! triangle or node takes the nearest.
//!
//! A table whose header has `x_um` and `y_um` has points; its other columns are ignored, so that
//! `fibres.csv` can be read. Points without a value are ignored. A table with one row per triangle
//! or node has only the value's column.

use super::words::Word;
use crate::mesh::Mesh;
use std::io;
use std::ops::RangeInclusive;

/// Words that do not name a file.
pub(super) const WORDS: &[Word] = &[
    Word { name: "uniform", doc: "The same in every place." },
    Word { name: "picture", doc: "As the picture of the cell shows it." },
];

/// Source of a quantity that may vary over the cell.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FromPlaces {
    /// Uniform.
    Uniform,
    /// From the picture of the cell.
    Picture,
    /// A file, as written.
    File(String),
}

impl FromPlaces {
    /// From the text that a user wrote.
    pub(super) fn of(text: String) -> Self {
        match text.as_str() {
            "uniform" => Self::Uniform,
            "picture" => Self::Picture,
            _ => Self::File(text),
        }
    }

    /// As written by users.
    pub(super) fn written(&self) -> &str {
        match self {
            Self::Uniform => "uniform",
            Self::Picture => "picture",
            Self::File(path) => path,
        }
    }
}

/// Largest number of points of a table; each triangle or node is compared with all of them.
const MOST_POINTS: usize = 100_000;

/// The parts of a mesh that have values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    Triangle,
    Node,
}

impl Part {
    const fn name(self) -> &'static str {
        match self {
            Self::Triangle => "triangle",
            Self::Node => "node",
        }
    }

    /// The place of each part of a mesh, um: the centre of a triangle, or the node.
    pub(super) fn places(self, mesh: &Mesh) -> Vec<[f64; 2]> {
        match self {
            Self::Triangle => mesh.simplices.iter().map(|it| mesh.centre(it)).collect(),
            Self::Node => (0..mesh.len()).map(|node| mesh.point(node)).collect(),
        }
    }
}

/// A column of such a table.
pub(super) struct Column {
    /// Its name in the header.
    pub(super) name: &'static str,
    /// The quantity, in words.
    pub(super) of: &'static str,
    /// Allowed numbers, all finite.
    pub(super) within: RangeInclusive<f64>,
    /// The allowed numbers, in words.
    pub(super) must: &'static str,
    /// Which parts of the mesh have a value.
    pub(super) part: Part,
}

/// Why a file is not a valid table by place.
#[derive(Debug, thiserror::Error)]
pub enum PlacesError {
    /// The file could not be read.
    #[error("cannot read `{path}`: {cause}")]
    Read {
        /// The file.
        path: String,
        /// What the system says.
        cause: io::Error,
    },
    /// It is not a table by place.
    #[error(
        "`{path}`: {cause}; a table of {of} has the header `{column}`, with one row for each {part}, or \
         `x_um,y_um,{column}`"
    )]
    Table {
        /// The file.
        path: String,
        /// What is wrong, with the line.
        cause: String,
        /// The quantity of the table.
        of: &'static str,
        /// Its column.
        column: &'static str,
        /// What has a row each: `triangle` or `node`.
        part: &'static str,
    },
    /// A number out of range.
    #[error("`{path}`, line {line}: {column} is {value}; it must be {must}")]
    Value {
        /// The file.
        path: String,
        /// Its line, from 1.
        line: u64,
        /// Column of the table.
        column: &'static str,
        /// The value as written.
        value: String,
        /// What it must be.
        must: &'static str,
    },
    /// Too few or too many rows.
    #[error("`{path}` has {rows} rows; {must}")]
    Rows {
        /// The file.
        path: String,
        /// How many rows it has.
        rows: usize,
        /// How many it must have, and why.
        must: String,
    },
    /// Places that all lie outside the cell: another origin or unit.
    #[error(
        "`{path}` has places from {first:.1?} to {last:.1?} um, the cell lies from {cell_first:.1?} to \
         {cell_last:.1?} um, so none lies in it; give x_um and y_um from the same origin as the \
         cell's nodes"
    )]
    Beside {
        /// The file.
        path: String,
        /// Least x and y of the places, um.
        first: [f64; 2],
        /// Largest x and y of the places, um.
        last: [f64; 2],
        /// Least x and y of the cell's nodes, um.
        cell_first: [f64; 2],
        /// Largest x and y of the cell's nodes, um.
        cell_last: [f64; 2],
    },
}

/// Reads a file by its name as written.
pub(super) fn read_bytes(
    path: &str,
    read: impl Fn(&str) -> io::Result<Vec<u8>>,
) -> Result<Vec<u8>, PlacesError> {
    read(path).map_err(|cause| PlacesError::Read { path: path.to_owned(), cause })
}

/// The value of each triangle or node from a column of a table.
pub(super) fn read_table(
    path: &str,
    column: &Column,
    mesh: &Mesh,
    read: impl Fn(&str) -> io::Result<Vec<u8>>,
) -> Result<Vec<f64>, PlacesError> {
    let bytes = read_bytes(path, read)?;
    let mut reader =
        csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_reader(&*bytes);
    let table = |cause: String| {
        let (path, of, part) = (path.to_owned(), column.of, column.part.name());
        PlacesError::Table { path, cause, of, column: column.name, part }
    };
    let header = reader.headers().map_err(|error| table(error.to_string()))?.clone();
    let place = |name: &str| header.iter().position(|column| column == name);
    let [x, y, wanted] = ["x_um", "y_um", column.name].map(place);
    // With other columns, one row per part would be a guess: coordinates may have other names.
    let places = x.is_some() && y.is_some() || header.len() == 1;
    let (Some(wanted), true) = (wanted, places) else {
        let found: Vec<_> = header.iter().map(|name| format!("`{name}`")).collect();
        return Err(table(match found.len() {
            0 => "it is empty".to_owned(),
            1 => format!("its one column, as separated by commas, is {}", found[0]),
            _ => format!("its columns are {}", found.join(", ")),
        }));
    };
    let (mut points, mut values) = (Vec::new(), Vec::new());
    for record in reader.records() {
        let record = record.map_err(|error| table(error.to_string()))?;
        let line = record.position().map_or(0, csv::Position::line);
        let number = |at: usize, column, must, within: &RangeInclusive<f64>| {
            let text = record.get(at).unwrap_or_default();
            let number = text.parse::<f64>().ok();
            number.filter(|number| number.is_finite() && within.contains(number)).ok_or_else(|| {
                let value = if text.is_empty() { "empty" } else { text }.to_owned();
                PlacesError::Value { path: path.to_owned(), line, column, value, must }
            })
        };
        if let Some((x, y)) = x.zip(y) {
            if record.get(wanted).is_none_or(str::is_empty) {
                continue;
            }
            let anywhere = f64::NEG_INFINITY..=f64::INFINITY;
            let of = |at, name| number(at, name, "a finite number", &anywhere);
            points.push([of(x, "x_um")?, of(y, "y_um")?]);
        }
        values.push(number(wanted, column.name, column.must, &column.within)?);
    }
    let rows = values.len();
    let refused = |must: String| Err(PlacesError::Rows { path: path.to_owned(), rows, must });
    let parts = column.part.places(mesh);
    if x.is_none() {
        let (wanted, part) = (parts.len(), column.part.name());
        if rows != wanted {
            return refused(format!("the mesh has {wanted} {part}s: give one for each"));
        }
        return Ok(values);
    }
    if rows == 0 || rows > MOST_POINTS {
        return refused(format!("there may be 1 to {MOST_POINTS} points with a value"));
    }
    let ([first, last], [cell_first, cell_last]) =
        (bounds(&points), bounds(&Part::Node.places(mesh)));
    if (0..2).any(|axis| first[axis] > cell_last[axis] || last[axis] < cell_first[axis]) {
        let path = path.to_owned();
        return Err(PlacesError::Beside { path, first, last, cell_first, cell_last });
    }
    Ok(nearest(&points, &values, &parts))
}

/// The value of the point nearest to each place; there must be at least one point.
pub(super) fn nearest(points: &[[f64; 2]], values: &[f64], places: &[[f64; 2]]) -> Vec<f64> {
    let of = |&[x, y]: &[f64; 2]| {
        let square = |at: usize| (points[at][0] - x).powi(2) + (points[at][1] - y).powi(2);
        let at = (0..points.len()).min_by(|&a, &b| square(a).total_cmp(&square(b))).unwrap_or(0);
        values[at]
    };
    places.iter().map(of).collect()
}

/// Smallest and largest x and y of points.
fn bounds(points: &[[f64; 2]]) -> [[f64; 2]; 2] {
    let of = |most: fn(f64, f64) -> f64| {
        points
            .iter()
            .copied()
            .reduce(|[x, y], [u, v]| [most(x, u), most(y, v)])
            .unwrap_or([f64::NAN; 2])
    };
    [of(f64::min), of(f64::max)]
}
