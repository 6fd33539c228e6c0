//! The figures of a paper, as SVG and PNG.
//!
//! | figure | shows | in the paper |
//! |---|---|---|
//! | [`action_potential_and_tension`] | potential and active tension over time | Fig. 3 |
//! | [`mesh`] | the lattice made from a picture | Fig. 4a |
//! | [`cell_shapes`] | the cell at rest, contracting and at its peak, coloured by a field | Fig. 5 |
//! | [`thick_cell()`] | a thick cell from above and from the side, and sections through it | |
//! | [`contraction`] | shortening over time, one or several curves | Fig. 6 |
//! | [`compared()`] | curves and cells of several runs over each other | |
//! | [`overview()`] | cell and curves of one run in one picture | |
//! | [`BeatFilm`] | the beating cell as GIF or as frames for video | |
//! | [`rankings`] | which parameter matters for which metric | |
//! | [`scatter`] | a metric of many members over each parameter | |
//! | [`distributions`] | histograms of the metrics of many members | |
//! | [`responses`], [`response_map`] | a metric over one parameter, or over two | |
//! | [`trace_bands`] | curves of many members: median, and bands of 50 % and 90 % of them | |
//! | [`Tracked`] | a film with the tracked lattice, and its curves | |
//! | [`FilmFrames`] | frames of a film with the outlines of its cell and of a simulated one | |
//! | [`maps()`] | a cell coloured by several quantities, side by side: a map, hatched where it is doubtful, and its uncertainty | |
//! | [`map_series()`] | maps of a cell at several times, with one colour scale | |
//! | [`no_map()`] | the outline of a cell without a map, and the reason | |
//! | [`measured()`] | a measured curve with its beats, and one beat with the points at which its metrics were read | |
//! | [`loops()`] | calcium and motion of the same beats over time, and over each other | |
//! | [`overlay()`] | the picture with outline, lattice, fibres and sarcomeres | |
//!
//! A [`Figure`] has the width of one (85 mm) or two (178 mm) columns of a journal. Its text stays
//! text in the SVG; the PNG is drawn with an embedded font (Noto Sans, SIL Open Font License 1.1),
//! so both files are identical on every machine. Curves use the Okabe-Ito colours, and the cell
//! those of [`ColourScale`](crate::field::ColourScale), which are light at rest; people with any
//! colour vision can read both. [`Figure::themed`] puts it on dark paper.
//!
//! A [`DrawnCell`] is drawn with its smooth outline, which moves with its lattice; [`mesh`] shows the
//! lattice. Area and length in the results of a run are those of the lattice. At rest the areas of
//! outline and lattice differ by less than the mesh's report says (`area_error_pct`), the lengths
//! by less than a spacing at either end.

use crate::field::FieldError;

mod cell;
mod chart;
mod compared;
mod drawing;
pub(crate) mod facets;
mod film;
mod film_frames;
mod fit;
mod font;
mod lattice;
mod loops;
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
mod slices;
mod svg;
mod theme;
mod thick;
mod thumbnail;
mod traces;
mod tracked;
mod traction;
mod work_loop;

pub use cell::DrawnCell;
pub use compared::{ComparedRun, Rings, compared};
pub(crate) use facets::{check_frame, check_mesh};
pub use film::{BeatFilm, FRAMES_PER_SECOND, Still};
pub use film_frames::{ComparedFrame, FilmFrames, FilmView};
pub use fit::{DrawnFit, DrawnTension, LikelihoodProfile, fit, tension};
pub use lattice::mesh;
pub use loops::{DrawnLoops, loops};
pub use maps::{Map, NOT_KNOWN, map_series, maps, no_map};
pub use measured::{Measured, measured};
pub(crate) use measured::{around, shown};
pub use members::{
    Distribution, MemberResponse, Numbers, QUANTILES, ResponseMap, Scatter, TraceBand,
    distributions, response_map, responses, scatter, trace_bands,
};
pub use moments::{Shape, key_shapes, key_shapes_in_space, moments};
pub use overlay::{CELL, Contour, Overlay, Sarcomeres, Tick, overlay};
pub use overview::overview;
pub use ranking::{Bar, Ranking, rankings};
pub use shapes::cell_shapes;
pub use sheet::Figure;
pub(crate) use slices::{Between, cut_surface};
pub use theme::Theme;
pub use thick::{DrawnThickCell, thick_cell};
pub(crate) use thumbnail::thumbnail;
pub use traces::{ContractionOptions, action_potential_and_tension, contraction};
pub use tracked::{Tracked, TrackedFrame};
pub use traction::traction;
pub use work_loop::work_loop;

/// Why a figure cannot be drawn.
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
    /// Nothing to draw.
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
    /// A position that is not finite.
    #[error(
        "{what} puts point {node} at {at} um, which is not finite; draw an earlier frame and look at \
         the time step"
    )]
    NotFinite {
        /// The frame or mesh.
        what: String,
        /// The point.
        node: usize,
        /// Its position, um: `(0, NaN)`.
        at: String,
    },
    /// A triangle or spring refers to a point that does not exist.
    #[error("the mesh refers to point {node}, but has {points} points; build it with `Mesh::new`")]
    NoSuchPoint {
        /// The point.
        node: u32,
        /// Points in the mesh.
        points: usize,
    },
    /// A thick mesh without cubes.
    #[error(
        "the thick cell has no cubes, so its surface cannot be drawn; draw one whose mesh has a \
         lattice, such as `mesh::cubes::block` makes"
    )]
    NoCubes,
    /// Fibres or contents that do not fit the mesh.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// A picture whose number of values does not match its size.
    #[error("a picture of {width} x {height} pixels needs {} values, but {found} were given", width.saturating_mul(*height))]
    PictureShape {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
        /// Values given.
        found: usize,
    },
    /// A film faster than real time.
    #[error("a film cannot be slowed by a factor of {slowed}; give at least 1, which is real time")]
    Slowed {
        /// The factor.
        slowed: f64,
    },
    /// A resolution out of range.
    #[error("a resolution of {dpi} dpi is outside 10 to 2400 dpi; 300 dpi suits a journal")]
    Resolution {
        /// What was asked for, pixels per inch.
        dpi: f64,
    },
    /// More pixels than memory or the PNG format allows.
    #[error("the figure cannot be drawn as PNG: {reason}")]
    Raster {
        /// Message of the renderer.
        reason: String,
    },
}
