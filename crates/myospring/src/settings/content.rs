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
use super::overlay::{Overlay, OverlayError};
use super::places::{self, Column, Part, PlacesError};
use crate::mesh::Mesh;
use crate::microscopy::cells::PictureCells;
use crate::microscopy::picture::Selection;
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
    /// The picture is not valid.
    #[error(transparent)]
    Picture(#[from] OverlayError),
}

/// The column of contents in a table.
const COLUMN: Column = Column {
    name: "content",
    of: "the content of myofibrils",
    within: 0.0..=100.0,
    must: "from 0 to 100, where 1 is the content that gives the cell's tension",
    part: Part::Triangle,
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
        return Ok((places::read_table(path, &COLUMN, mesh, read)?, None));
    }
    let bytes = places::read_bytes(path, read)?;
    let overlay = Overlay { path, of: COLUMN.of };
    let (grey, note) = overlay.grey(&bytes, COLUMN.part, mesh, picture)?;
    let content = relative(grey, mesh).ok_or_else(|| overlay.black())?;
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
    use crate::microscopy::plane::Plane;

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
        for ([x, y], content) in Part::Triangle.places(&mesh).into_iter().zip(content) {
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
