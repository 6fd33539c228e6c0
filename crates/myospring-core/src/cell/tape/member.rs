//! A cell of a batch, with its compiled equations.

use super::program::Program;
use crate::cell::cell_model::Paced;
use crate::cell::pacer::Pacer;
use std::sync::Arc;

/// The compiled equations of one cell, with its numbers.
#[derive(Debug, Clone)]
pub(in crate::cell) struct Compiled {
    pub(in crate::cell) program: Arc<Program>,
    /// The rows of its numbers.
    pub(in crate::cell) fixed: Vec<f64>,
    /// The states from which samples are computed: potential, calcium, tension.
    pub(in crate::cell) seen: Arc<[usize]>,
}

/// A cell with its compiled equations.
pub(super) struct Member<'a> {
    pub(super) cell: &'a Paced,
    pub(super) compiled: Compiled,
    pub(super) pacer: Pacer,
}
