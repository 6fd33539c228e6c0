//! The content of myofibrils in each triangle, from the fibres that the picture shows, a table or a picture.
//!
//! - The fibres (`picture`): order times coverage, relative to its mean over the cell, and 0 where
//!   no fibres were read. That order measures content is an assumption.
//! - A table (`.csv`) with the header `content` has one row for each triangle, in the order of the
//!   mesh; one with the header `x_um,y_um,content` has points; each triangle takes the value of the
//!   nearest.
//! - A picture (`.png`, `.tif`) must have the same frame as the picture of the cell; its plane is
//!   chosen in the same way (channel, frame, depth). The content is its grey values, averaged over
//!   a lattice square around each triangle, relative to their mean over the cell.

use super::fibres::Fibres;
use super::places::{self, Column, PlacesError, centres};
use crate::mesh::Mesh;
use crate::microscopy::cells::PictureCells;
use crate::microscopy::hot_pixels;
use crate::microscopy::picture::Selection;
use crate::microscopy::plane::Plane;
use crate::microscopy::read::{PictureError, read_picture};
use std::io;

/// Endings of files with a content of myofibrils, without the dot.
pub const CONTENT_ENDINGS: &[&str] = &["csv", "png", "tif", "tiff"];

/// Content relative to the mean above which a warning is given: 5 means that all myofibrils are in
/// a fifth of the cell.
const MUCH: f64 = 5.0;

/// Why a content of myofibrils cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum ContentError {
    /// There are no fibres from which to read it.
    #[error(
        "the content of myofibrils cannot be taken from the picture, because no fibres were read from it{reason}; use \
         --myofibril-content uniform, or a file"
    )]
    NotRead {
        /// Why, after a colon; may be empty.
        reason: String,
    },
    /// The table is not valid.
    #[error(transparent)]
    Table(#[from] PlacesError),
    /// The picture cannot be read.
    #[error("`{path}`: {cause}")]
    Picture {
        /// The file.
        path: String,
        /// What is wrong.
        cause: PictureError,
    },
    /// A picture of content without a picture of the cell.
    #[error(
        "`{path}` is a picture, but the shape of the cell does not come from a picture, so their positions cannot be matched; give a table \
         (.csv), or the picture of the cell as its shape"
    )]
    NoFrame {
        /// The file.
        path: String,
    },
    /// A picture of another frame.
    #[error(
        "`{path}` has {found:?} pixels, the picture of the cell {expected:?}; the content needs a picture of \
         the same frame"
    )]
    Frame {
        /// The file.
        path: String,
        /// Its columns and rows.
        found: [usize; 2],
        /// Those of the picture of the cell.
        expected: [usize; 2],
    },
    /// A picture that is black where the cell is.
    #[error(
        "`{path}` is black everywhere in the cell, so it contains no information on its myofibrils"
    )]
    Black {
        /// The file.
        path: String,
    },
}

/// The column of contents in a table.
const COLUMN: Column = Column {
    name: "content",
    of: "the content of myofibrils",
    within: 0.0..=100.0,
    must: "from 0 to 100, where 1 is the content that gives the cell's tension",
};

/// Reads the content of myofibrils in each triangle of a mesh from a file, with warnings; `read`
/// reads a file by its name as written, `picture` is that of the cell, with its selected plane.
pub(super) fn read_content(
    path: &str,
    mesh: &Mesh,
    picture: Option<(&PictureCells, &Selection)>,
    read: impl Fn(&str) -> io::Result<Vec<u8>>,
) -> Result<(Vec<f64>, Option<String>), ContentError> {
    if path.to_lowercase().ends_with(".csv") {
        Ok((places::read_table(path, &COLUMN, mesh, read)?, None))
    } else {
        of_picture(path, &places::read_bytes(path, read)?, mesh, picture)
    }
}

fn of_picture(
    path: &str,
    bytes: &[u8],
    mesh: &Mesh,
    cell: Option<(&PictureCells, &Selection)>,
) -> Result<(Vec<f64>, Option<String>), ContentError> {
    let path = || path.to_owned();
    let (cell, selection) = cell.ok_or_else(|| ContentError::NoFrame { path: path() })?;
    let picture = read_picture(bytes, selection)
        .map_err(|cause| ContentError::Picture { path: path(), cause })?;
    let (plane, note) = match hot_pixels::cooled(&picture.plane) {
        Some((plane, note)) => (plane, Some(format!("`{}`: {note}", path()))),
        None => (picture.plane, None),
    };
    let size = |plane: &Plane| [plane.width(), plane.height()];
    let (found, expected) = (size(&plane), size(&cell.plane));
    if found != expected {
        return Err(ContentError::Frame { path: path(), found, expected });
    }
    let pixel = cell.pixel_size.um();
    let spacing = mesh.lattice.as_ref().map_or(pixel, |lattice| lattice.spacing);
    let reach = 0.5 * spacing / pixel;
    // Columns, or rows from the bottom, of the pixels covered by a square around a place.
    let covered = |at: f64, count: usize| {
        let last = count as f64 - 1.0;
        let [first, end] = [at - reach, at + reach].map(|edge| edge.floor().clamp(0.0, last));
        first as usize..=end as usize
    };
    let grey: Vec<f64> = centres(mesh)
        .map(|[x, y]| {
            let rows = covered(y / pixel, expected[1]);
            let pixels = rows.flat_map(|row| {
                let row = expected[1] - 1 - row;
                covered(x / pixel, expected[0]).map(move |column| [column, row])
            });
            let values = pixels.map(|[column, row]| f64::from(plane.at(column, row)));
            let (sum, count) =
                values.fold((0.0, 0.0), |(sum, n), grey| (sum + grey.max(0.0), n + 1.0));
            sum / count
        })
        .collect();
    let content = relative(grey, mesh).ok_or_else(|| ContentError::Black { path: path() })?;
    Ok((content, note))
}

/// The content of myofibrils from the fibres of a picture, with a warning.
pub(super) fn of_fibres(
    fibres: &Fibres,
    mesh: &Mesh,
) -> Result<(Vec<f64>, Option<String>), ContentError> {
    let not_read = || ContentError::NotRead {
        reason: fibres.not_read.map(|reason| format!(": {reason}")).unwrap_or_default(),
    };
    let seen = fibres.seen.as_ref().ok_or_else(not_read)?;
    let ordered = seen.triangles.iter().map(|place| {
        // Without a readable direction, the content is 0.
        if place.from_picture { place.order * place.coverage } else { 0.0 }
    });
    let content = relative(ordered.collect(), mesh).ok_or_else(not_read)?;
    let most = content.iter().copied().fold(0.0, f64::max);
    let warning = (most > MUCH).then(|| {
        format!(
            "the content of myofibrils is up to {most:.0} times its mean, and so is the tension: the picture shows \
             fibres in only {:.0} % of the cell, which carry all the tension",
            100.0 * seen.field.summary().share_from_picture
        )
    });
    Ok((content, warning))
}

/// Values of triangles relative to their mean over the cell; `None` if that is not above 0.
fn relative(values: Vec<f64>, mesh: &Mesh) -> Option<Vec<f64>> {
    let weights = mesh.simplices.iter().map(|triangle| triangle.weight);
    let (sum, whole) = values
        .iter()
        .zip(weights)
        .fold((0.0, 0.0), |(sum, whole), (value, weight)| (sum + value * weight, whole + weight));
    let mean = sum / whole;
    let any = mean.is_finite() && mean > 0.0;
    any.then(|| values.into_iter().map(|value| value / mean).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::lattice;
    use crate::mesh::pixel_size::PixelSize;
    use crate::microscopy::cells::PictureOptions;

    /// A picture of 40 x 20 pixels as a PNG.
    fn png(grey: impl Fn(u32, u32) -> u8) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 40, 20).write_header().unwrap();
        let pixels: Vec<u8> = (0..40 * 20).map(|at| grey(at % 40, at / 40)).collect();
        encoder.write_image_data(&pixels).unwrap();
        encoder.finish().unwrap();
        bytes
    }

    #[test]
    fn grey_values_about_a_triangle_become_its_content_relative_to_the_mean_of_the_cell() {
        let options = PictureOptions {
            pixel_size: Some(PixelSize::new(1.0).unwrap()),
            ..PictureOptions::default()
        };
        let cell = png(|x, y| if (4..36).contains(&x) && (4..16).contains(&y) { 200 } else { 0 });
        let cells = PictureCells::find(&cell, &options).unwrap();
        // A mesh over columns 4 to 36, rows 4 to 16 of the picture, y upward.
        let mut mesh = lattice::rectangle(16, 6, 2.0).unwrap();
        mesh.points.iter_mut().flatten().for_each(|x| *x += 4.0);
        // The upper half of the picture, low rows, is three times as bright as the lower.
        let read = |_: &str| Ok(png(|_, y| if y < 10 { 150 } else { 50 }));
        let cell = Some((&cells, &Selection::default()));
        let (content, note) = read_content("stain.png", &mesh, cell, read).unwrap();
        assert_eq!(note, None);
        for (triangle, content) in mesh.simplices.iter().zip(content) {
            let y =
                triangle.nodes.map(|node| mesh.points[1][node as usize]).iter().sum::<f64>() / 3.0;
            let expected = if y > 10.0 { 1.5 } else { 0.5 };
            // Squares about triangles beside the border see both halves.
            let near = (y - 10.0).abs() < 1.5;
            assert!(near || (content - expected).abs() < 0.02, "{content} at y = {y}");
        }
    }

    #[test]
    fn where_the_picture_shows_stripes_there_are_myofibrils_and_where_it_shows_none_there_are_none()
    {
        use super::super::fibres::{FibreDirection, PictureFibres};
        use crate::microscopy::fibres::{FibreSettings, Stain, fibres};
        // Stripes 1.9 um apart in the left half of 40 x 20 um, nothing in the right one.
        let grey = |at: usize| match at % 200 {
            x if x < 100 => (std::f32::consts::TAU * 0.2 * x as f32 / 1.9).sin(),
            _ => 0.0,
        };
        let plane = Plane::new(200, 100, (0..20_000).map(grey).collect()).unwrap();
        let settings = FibreSettings::of(Stain::ZDisc);
        let pixel = PixelSize::new(0.2).unwrap();
        let field = fibres(&plane, &vec![true; 20_000], pixel, [1.0, 0.0], &settings).unwrap();
        let mesh = lattice::rectangle(20, 10, 2.0).unwrap();
        let mut read = FibreDirection::LongAxis.on(&mesh, None).unwrap();
        let error = of_fibres(&read, &mesh).unwrap_err().to_string();
        assert!(error.contains("no fibres were read"), "{error}");
        let triangles = field.on_triangles(&mesh);
        read.seen = Some(PictureFibres { stain: Stain::ZDisc, field, triangles });
        let (content, warning) = of_fibres(&read, &mesh).unwrap();
        assert_eq!(warning, None);
        let mean = content.iter().sum::<f64>() / content.len() as f64;
        assert!((mean - 1.0).abs() < 1e-12, "{mean}");
        for ([x, y], content) in centres(&mesh).zip(content) {
            // The mean of neighbours reaches over the border of the stripes.
            if x > 26.0 {
                assert_eq!(content, 0.0, "{x} {y}");
            } else if (4.0..16.0).contains(&x) && (4.0..16.0).contains(&y) {
                assert!((1.5..2.5).contains(&content), "{content} at {x} {y}");
            }
        }
    }

    #[test]
    fn a_row_for_each_triangle_is_taken_as_it_stands_and_points_by_their_nearness() {
        let mesh = lattice::rectangle(2, 1, 1.0).unwrap();
        let table =
            |text: &'static str| read_content("content.csv", &mesh, None, |_| Ok(text.into()));
        let (rows, _) = table("content\n0\n1\n2\n3\n4\n5\n6\n7\n").unwrap();
        assert_eq!(rows, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        let (points, _) = table("x_um, y_um, content\n0.5, 0.5, 0.25\n1.5, 0.5, 2\n").unwrap();
        for (triangle, content) in mesh.simplices.iter().zip(points) {
            let left = triangle.nodes.iter().all(|&node| mesh.points[0][node as usize] <= 1.0);
            assert_eq!(content, if left { 0.25 } else { 2.0 });
        }
        for (text, message) in [
            ("content\n1\n", "give one for each"),
            ("x_um,y_um,content\n0,0,1\n,,1\n", "line 3: x_um is empty"),
            ("# drawn\nx_um,content\n0,1\n", "its columns are `x_um`, `content`"),
            ("x_um,y_um,content\n0,5,1\n2,5,1\n", "the cell lies from [0.0, 0.0] to [2.0, 1.0] um"),
            ("x_um,y_um,content\n", "1 to 100000 points"),
            ("amount\n1\n", "has the header `content`"),
            ("content\nnan\n", "line 2: content is nan"),
            ("x_um,y_um,content\ninf,0,1\n", "x_um is inf"),
        ] {
            let error = table(text).unwrap_err().to_string();
            assert!(error.contains(message), "{message}: {error}");
        }
    }
}
