//! `report.html`: a run, or several beside each other, as one page that needs nothing else.
//!
//! The page itself (HTML, style, drawing) has its source in the folder `page/` of this crate; here it is put
//! together (`template`) and gets its data. It shows the beating cell, the curves linked to it, all numbers
//! with their definitions, parameters with their sources, and how to cite and to repeat the run. It asks nothing of
//! any network, and forbids itself to.
//!
//! What the cell needs is made small: squares of the lattice or several of them in one (`display`), frames that
//! the eye can tell apart, displacements in 16 bits. `payload.d.ts` beside the page's source has the form.

mod band;
mod cell;
mod curves;
mod display;
mod fields;
mod fit;
mod frames;
mod given;
mod html;
mod payload;
mod photograph;
mod template;

pub use given::{
    Difference, FittedNumber, Page, PageError, PageFigure, PageFit, PageRun, ParameterGroup,
    ParameterRow, Photograph,
};
pub use html::html;
