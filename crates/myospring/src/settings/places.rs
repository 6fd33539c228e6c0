//! Tables that say something of each place in a cell: a row for each triangle, or points of which each triangle takes
//! the nearest.
//!
//! A table whose header has `x_um` and `y_um` has points; its other columns are passed over, so `fibres.csv` may be read
//! as it was written. Points without a value say nothing. A table with a row for each triangle has the one column.

use crate::mesh::Mesh;
use std::io;
use std::ops::RangeInclusive;

/// Words that stand for no file.
pub(super) const WORDS: &[&str] = &["uniform", "picture"];

/// Where what differs from place to place is taken from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FromPlaces {
    /// The same everywhere.
    Uniform,
    /// What the picture of the cell shows.
    Picture,
    /// A file, as written.
    File(String),
}

impl FromPlaces {
    /// What a person wrote.
    pub(super) fn of(text: String) -> Self {
        match text.as_str() {
            "uniform" => Self::Uniform,
            "picture" => Self::Picture,
            _ => Self::File(text),
        }
    }

    /// As a person writes it.
    pub(super) fn written(&self) -> &str {
        match self {
            Self::Uniform => "uniform",
            Self::Picture => "picture",
            Self::File(path) => path,
        }
    }
}

/// Most points of a table: each triangle looks at all of them.
const MOST_POINTS: usize = 100_000;

/// A column of such a table.
pub(super) struct Column {
    /// Its name in the header.
    pub(super) name: &'static str,
    /// What it says.
    pub(super) of: &'static str,
    /// What its numbers may be, all finite.
    pub(super) within: RangeInclusive<f64>,
    /// That, in words.
    pub(super) must: &'static str,
}

/// Why a file is no table by place.
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
    /// It is no such table.
    #[error(
        "`{path}`: {cause}; a table of {of} has the header `{column}`, with one row for each triangle, or \
         `x_um,y_um,{column}`"
    )]
    Table {
        /// The file.
        path: String,
        /// What is wrong, with the line.
        cause: String,
        /// What the table says.
        of: &'static str,
        /// Its column.
        column: &'static str,
    },
    /// A number that cannot be.
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
        /// How many it may have, and why.
        must: String,
    },
    /// Places that all lie beside the cell: of another origin or unit.
    #[error(
        "`{path}` has places from {first:.1?} to {last:.1?} um, the cell lies from {cell_first:.1?} to \
         {cell_last:.1?} um, so they say nothing about it; give x_um and y_um from the same origin as the \
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

/// A file by its name as written.
pub(super) fn read_bytes(
    path: &str,
    read: impl Fn(&str) -> io::Result<Vec<u8>>,
) -> Result<Vec<u8>, PlacesError> {
    read(path).map_err(|cause| PlacesError::Read { path: path.to_owned(), cause })
}

/// The number of each triangle that a table gives in one of its columns.
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
        let (path, of, column) = (path.to_owned(), column.of, column.name);
        PlacesError::Table { path, cause, of, column }
    };
    let header = reader.headers().map_err(|error| table(error.to_string()))?.clone();
    let place = |name: &str| header.iter().position(|column| column == name);
    let [x, y, wanted] = ["x_um", "y_um", column.name].map(place);
    // Beside other columns a row for each triangle would be a guess: places may stand under another name.
    let places = x.is_some() && y.is_some() || header.len() == 1;
    let (Some(wanted), true) = (wanted, places) else {
        let found: Vec<_> = header.iter().map(|name| format!("`{name}`")).collect();
        return Err(table(match found.len() {
            0 => "it is empty".to_owned(),
            1 => format!("its one column, as commas part them, is {}", found[0]),
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
    if x.is_none() {
        let triangles = mesh.simplices.len();
        if rows != triangles {
            return refused(format!("the mesh has {triangles} triangles: give one for each"));
        }
        return Ok(values);
    }
    if rows == 0 || rows > MOST_POINTS {
        return refused(format!("there may be 1 to {MOST_POINTS} points with a value"));
    }
    let ([first, last], [cell_first, cell_last]) = (
        bounds(&points),
        bounds(&(0..mesh.len()).map(|node| mesh.point(node)).collect::<Vec<_>>()),
    );
    if (0..2).any(|axis| first[axis] > cell_last[axis] || last[axis] < cell_first[axis]) {
        let path = path.to_owned();
        return Err(PlacesError::Beside { path, first, last, cell_first, cell_last });
    }
    Ok(nearest(&points, &values, mesh))
}

/// The value of the point nearest to each triangle; there must be one.
pub(super) fn nearest(points: &[[f64; 2]], values: &[f64], mesh: &Mesh) -> Vec<f64> {
    let of = |[x, y]: [f64; 2]| {
        let square = |at: usize| (points[at][0] - x).powi(2) + (points[at][1] - y).powi(2);
        let at = (0..points.len()).min_by(|&a, &b| square(a).total_cmp(&square(b))).unwrap_or(0);
        values[at]
    };
    centres(mesh).map(of).collect()
}

/// Least and largest x and y of points.
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

/// The centre of each triangle, um.
pub(super) fn centres(mesh: &Mesh) -> impl Iterator<Item = [f64; 2]> {
    mesh.simplices.iter().map(|triangle| mesh.centre(triangle))
}
