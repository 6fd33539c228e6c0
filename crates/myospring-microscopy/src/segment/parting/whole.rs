//! Data of a piece before it is cut, and straight lines through it.

use std::cell::OnceCell;

use super::light::{Light, Texture};
use super::piece::Piece;

/// Data of a piece before it is cut.
pub(super) struct Whole<'a> {
    pub(super) piece: &'a Piece,
    pub(super) light: &'a Light<'a>,
    /// Distance of each pixel from the outside.
    pub(super) depths: Vec<f32>,
    pub(super) solidity: f64,
    /// Standard deviation of the depth of a place relative to both sides, as measured for lines.
    pub(super) scatter: f64,
    texture: OnceCell<Option<Texture>>,
}

impl<'a> Whole<'a> {
    pub(super) fn of(
        piece: &'a Piece,
        light: &'a Light<'a>,
        depths: Vec<f32>,
        solidity: f64,
        scatter: f64,
    ) -> Self {
        Self { piece, light, depths, solidity, scatter, texture: OnceCell::new() }
    }

    /// The texture of the piece, computed on first use.
    pub(super) fn texture(&self) -> Option<&Texture> {
        self.texture.get_or_init(|| self.light.texture(self.piece)).as_ref()
    }
}

pub(super) fn distance(from: [f64; 2], to: [f64; 2]) -> f64 {
    (to[0] - from[0]).hypot(to[1] - from[1])
}

/// Places along a straight line.
pub(super) fn straight(
    from: [f64; 2],
    to: [f64; 2],
    step: f64,
) -> impl Iterator<Item = [f64; 2]> + Clone {
    let (x, y) = (to[0] - from[0], to[1] - from[1]);
    let steps = (distance(from, to) / step).ceil().max(1.0);
    (0..=steps as u32)
        .map(move |at| f64::from(at) / steps)
        .map(move |part| [from[0] + x * part, from[1] + y * part])
}

/// 0 at `none`, 1 at `all`, linear between; `all` may be smaller than `none`.
pub(super) fn rise(value: f64, none: f64, all: f64) -> f64 {
    ((value - none) / (all - none)).clamp(0.0, 1.0)
}
