//! The figures of a paper, as SVG and PNG.
//!
//! | figure | shows | in the paper |
//! |---|---|---|
//! | [`action_potential_and_tension`] | potential and active tension over time | Fig. 3 |
//! | [`mesh`] | the lattice made from a picture | Fig. 4a |
//! | [`cell_shapes`] | the cell at rest, on the way and at its peak, coloured by a field | Fig. 5 |
//! | [`contraction`] | shortening over time, one or several curves | Fig. 6 |
//! | [`compared()`] | curves and cells of several runs over each other | |
//! | [`overview()`] | cell and curves of one run in one picture | |
//! | [`Film`] | the beating cell as GIF or as frames for video | |
//! | [`rankings`] | which parameter matters for which metric | |
//! | [`scatter`] | a metric of many members over each parameter | |
//! | [`distributions`] | histograms of the metrics of many members | |
//! | [`responses`], [`response_map`] | a metric over one parameter, or over two | |
//! | [`trace_bands`] | curves of many members: where half of them lie, and nine of ten | |
//! | [`Tracked`] | a film with the lattice that was followed through it, and its curves | |
//! | [`maps()`] | a cell coloured by several quantities beside each other: a map, hatched where it is doubtful, and how sure it is | |
//! | [`no_map()`] | the outline of a cell whose map is not known, and why | |
//! | [`measured()`] | a measured curve with its beats, and where the metrics of one were read | |
//! | [`overlay()`] | the picture with outline, lattice, fibres and sarcomeres | |
//!
//! A [`Figure`] has the width of one (85 mm) or two (178 mm) columns of a journal. Its text stays
//! text in the SVG; the PNG is drawn with an embedded font (Noto Sans, SIL Open Font License 1.1),
//! so both are the same bytes on every machine. Curves use the Okabe-Ito colours, and the cell those of
//! [`ColourScale`](crate::field::ColourScale), which are light at rest; people with any colour vision can read both.
//! [`Figure::themed`] puts it on dark paper.
//!
//! A [`Cell`] is drawn with its smooth outline, which its lattice carries along; [`mesh`] shows the lattice. Area and
//! length that a run reports are those of the lattice. At rest the two areas differ by less than the mesh's report
//! says (`area_error_pct`), the lengths by less than a spacing at either end.

use crate::field::FieldError;

mod cell;
mod chart;
mod compared;
mod drawing;
pub(crate) mod facets;
mod film;
mod fit;
mod font;
mod lattice;
mod maps;
mod measured;
mod members;
mod moments;
mod overlay;
mod overview;
pub(crate) mod photograph;
mod ranking;
mod raster;
mod shapes;
mod sheet;
mod skin;
mod svg;
mod theme;
mod thumbnail;
mod traces;
mod tracked;
mod work_loop;

pub use cell::Cell;
pub use compared::{Compared, Rings, compared};
pub(crate) use facets::{check_frame, check_mesh};
pub use film::{FRAMES_PER_SECOND, Film, Still};
pub use fit::{FittedCurve, LikelihoodProfile, fit};
pub use lattice::mesh;
pub use maps::{Map, maps, no_map};
pub use measured::{Measured, measured};
pub(crate) use measured::{around, shown};
pub use members::{
    Distribution, Numbers, QUANTILES, Response, ResponseMap, Scatter, TraceBand, distributions,
    response_map, responses, scatter, trace_bands,
};
pub use moments::{Shape, key_shapes};
pub use overlay::{Contour, Overlay, Sarcomeres, Tick, overlay};
pub use overview::overview;
pub use ranking::{Bar, Ranking, rankings};
pub use shapes::cell_shapes;
pub use sheet::Figure;
pub use theme::Theme;
pub(crate) use thumbnail::thumbnail;
pub use traces::{ContractionOptions, action_potential_and_tension, contraction};
pub use tracked::{Tracked, TrackedFrame};
pub use work_loop::work_loop;

/// Why a figure was not drawn.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FigureError {
    /// No finite sample to draw.
    #[error(
        "{what} has 0 samples with finite numbers, a curve needs at least 1; record more often or \
         look for the step at which the run broke"
    )]
    NoSamples {
        /// Which recording.
        what: String,
    },
    /// Nothing to put in the figure.
    #[error("the figure was given 0 {what}, it needs at least 1")]
    Nothing {
        /// What is missing.
        what: &'static str,
    },
    /// A shape that belongs to another mesh.
    #[error(
        "the frame at {t_ms} ms has {found} positions along axis {axis}, the mesh has {points} \
         points; draw frames with the mesh of their own run"
    )]
    WrongMesh {
        /// Time of the frame, ms.
        t_ms: f64,
        /// Axis, 0 for x.
        axis: usize,
        /// Positions in the frame.
        found: usize,
        /// Points in the mesh.
        points: usize,
    },
    /// A shape that is not a shape.
    #[error(
        "{what} puts point {node} at ({x}, {y}) um, which is not finite; draw an earlier frame and \
         look at the time step"
    )]
    NotFinite {
        /// The frame or mesh.
        what: String,
        /// The point.
        node: usize,
        /// Its x, um.
        x: f64,
        /// Its y, um.
        y: f64,
    },
    /// A triangle or spring that names a point which is not there.
    #[error("the mesh names point {node}, but has {points} points; build it with `Mesh::new`")]
    NoSuchPoint {
        /// The point.
        node: u32,
        /// Points in the mesh.
        points: usize,
    },
    /// Fibres or contents that are not those of the mesh.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// A picture with another number of pixels than it says.
    #[error("a picture of {width} x {height} pixels needs {} values, but {found} were given", width.saturating_mul(*height))]
    PictureShape {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
        /// Values given.
        found: usize,
    },
    /// A film that would run faster than the cell.
    #[error("a film cannot be slowed by a factor of {slowed}; give at least 1, which is real time")]
    Slowed {
        /// The factor.
        slowed: f64,
    },
    /// A resolution that no printer has.
    #[error("a resolution of {dpi} dpi is outside 10 to 2400 dpi; 300 dpi suits a journal")]
    Resolution {
        /// What was asked for, pixels per inch.
        dpi: f64,
    },
    /// More pixels than memory allows, or than a PNG holds.
    #[error("the figure cannot be drawn as PNG: {reason}")]
    Raster {
        /// What the painter says.
        reason: String,
    },
}
