//! Why there is no page.

use crate::field::FieldError;
use crate::figure::FigureError;
use crate::json::JsonError;

/// Why there is no page.
#[derive(Debug, thiserror::Error)]
pub enum PageError {
    /// No cell to show.
    #[error("a page needs at least 1 run, it was given 0")]
    NoRuns,
    /// A mesh, frame or picture that cannot be drawn.
    #[error(transparent)]
    Drawing(#[from] FigureError),
    /// Fibres or contents of another mesh.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// Data that JSON does not hold.
    #[error(transparent)]
    Json(#[from] JsonError),
}
