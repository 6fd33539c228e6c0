//! Where something is, in words.

use serde::{Deserialize, Serialize};
use std::fmt;

/// A place in a cell, um.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Place {
    /// In the picture, to the right.
    pub x: f64,
    /// In the picture, upward.
    pub y: f64,
    /// Above the plane of the picture; `None` in a flat cell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub z: Option<f64>,
}

impl Place {
    /// Where a node of these positions (by axis) is.
    pub fn of<const D: usize>(positions: &[Vec<f64>; D], node: usize) -> Self {
        let along = |axis: usize| positions.get(axis).map(|of| of[node]);
        let [x, y] = [0, 1].map(|axis| along(axis).unwrap_or(f64::NAN));
        Self { x, y, z: along(2) }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "x = {:.1} um, y = {:.1} um", self.x, self.y)?;
        self.z.map_or(Ok(()), |z| write!(out, ", z = {z:.1} um"))
    }
}
