//! `report.html`: the result of any experiment as one page that needs nothing else.
//!
//! A [`Page`] is a head (title, facts, the answer in one line, warnings) and a list of
//! [`Section`]s, each of parts of a few kinds ([`Part`]): beating cells with their curves, charts,
//! tables, thumbnails, figures, sentences, text to copy. An experiment composes its own sections;
//! nothing here or in the page's script knows which experiment it is. [`Runs`] makes the sections
//! of runs, [`Chart::of_curve`] and [`Chart::of_fit`] charts of measured and fitted curves.
//!
//! The page itself (HTML, style, drawing) has its source in the folder `page/` of this crate; here
//! it is assembled (`template`) and gets its data. It needs no network, and its content policy
//! forbids any.
//!
//! Its size is bounded: squares of the lattice or several of them in one (`display`), frames that
//! the eye can distinguish, displacements in 16 bits: 2 MB for the frames of all cells, and as much
//! for the surfaces of thick ones, which the page turns in space ([`ThickCell`]). All charts
//! have 120 000 numbers (1 MB), a figure above 400 kB becomes a picture of pixels, a gallery 3 MB,
//! a table 1000 rows. `payload.d.ts` in the page's source describes the data.

mod cell;
mod chart;
mod content;
mod display;
mod error;
mod fields;
mod figure;
mod frames;
mod html;
mod payload;
mod photograph;
mod run;
mod runs;
mod section;
mod table;
mod template;
mod thick;

pub use cell::{BeatingCells, MovingCell};
pub use chart::{Chart, Dot, Series, Side, Span, Tone};
pub use content::{Answer, Page, Part, Quality, Section};
pub use error::PageError;
pub use figure::{Drawing, Thumbnail};
pub use html::{data_of, html};
pub use payload::data;
pub use photograph::Photograph;
pub use run::{PageRun, ParameterGroup, ParameterRow};
pub use runs::{Difference, Runs};
pub use table::{Column, Look, Row, Table, TableCell, Tile, VerdictMark, metric_words};
pub use template::around_engine;
pub use thick::ThickCell;
