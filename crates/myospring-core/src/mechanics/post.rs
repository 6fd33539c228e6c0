//! Flexible posts that hold a strip of tissue at its ends.
//!
//! The stiffness is that of a beam that is clamped at its foot and bent by a force at some height (Euler and Bernoulli):
//!
//! ```text
//! k = 6 E I/(a^2 (3 L - a)),   I = w t^3/12 of a rectangular section, pi d^4/64 of a round one
//! ```
//!
//! `L` is the length of the post and `a` the height of the strip on it.

use serde::Serialize;
use std::f64::consts::PI;

/// A post.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Post {
    /// Its length from foot to tip, um.
    pub length: f64,
    /// Height of the strip above the foot, um; `None` is at the tip.
    pub load_height: Option<f64>,
    /// Its width across the strip, um; of a round post its diameter.
    pub width: f64,
    /// Its thickness along the strip, in which it is bent, um; `None` is a round post.
    pub thickness: Option<f64>,
    /// Young's modulus, kPa.
    pub modulus: f64,
}

impl Post {
    /// Force per displacement of the strip, nN/um.
    ///
    /// # Example
    /// The post of a published device: 199 um long, loaded at 163 um, 163 um wide, 33.2 um thick, of 1610 kPa.
    /// ```
    /// use myospring::mechanics::post::Post;
    /// let post = Post {
    ///     length: 199.0,
    ///     load_height: Some(163.0),
    ///     width: 163.0,
    ///     thickness: Some(33.2),
    ///     modulus: 1610.0,
    /// };
    /// assert!((post.stiffness() - 416.0).abs() < 1.0);
    /// ```
    pub fn stiffness(&self) -> f64 {
        let Self { length, load_height, width, thickness, modulus } = *self;
        let height = load_height.unwrap_or(length);
        let second_moment = match thickness {
            Some(thickness) => width * thickness.powi(3) / 12.0,
            None => PI * width.powi(4) / 64.0,
        };
        6.0 * modulus * second_moment / (height.powi(2) * (3.0 * length - height))
    }
}
