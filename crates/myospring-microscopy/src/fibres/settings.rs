//! How directions are read from a picture.

use std::ops::RangeInclusive;

/// Lengths that the settings may have, um.
pub const SCALES_UM: RangeInclusive<f64> = 0.05..=100.0;

/// Bounds of coherency that the settings may have.
pub const COHERENCY_BOUNDS: RangeInclusive<f64> = 0.01..=0.9;

/// What the picture shows of the myofibrils.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stain {
    /// Stripes that lie **across** the fibre: z-discs (alpha-actinin, titin's end), M-bands (myomesin).
    ZDisc,
    /// Threads that run **along** the fibre: actin (phalloidin).
    Filament,
}

/// How directions are read from a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FibreSettings {
    /// What the picture shows.
    pub stain: Stain,
    /// Standard deviation of the Gaussian whose derivative is the gradient, um. At least one pixel is
    /// used, below which the directions of a square grid show through.
    pub gradient_scale_um: f64,
    /// Standard deviation of the Gaussian whose mean is taken off, um: wider things than about six
    /// times this are light, not structure.
    pub background_scale_um: f64,
    /// Standard deviation of the Gaussian over the tensors, um.
    pub smoothing_um: f64,
    /// Width of the rim along the outline whose gradients are left out, um. Its outer part, all but
    /// three gradient scales, is not looked at at all.
    pub rim_um: f64,
    /// Coherency at which picture and long axis weigh the same. From half of it to one and a half of it
    /// the direction passes from the long axis to that of the picture.
    pub least_coherency: f64,
}

impl FibreSettings {
    /// The defaults for a stain.
    ///
    /// | setting | z-discs | filaments | why |
    /// |---|---|---|---|
    /// | gradient scale | 0.3 um | 0.5 um | a Gaussian's derivative answers most to stripes `2 pi` of its width apart: 1.9 um, a sarcomere; bundles of filaments are wider than z-discs |
    /// | background scale | 1.2 um | 2 um | four times the gradient scale: keeps stripes whole |
    /// | smoothing | 3 um | 3 um | about three sarcomeres to each side; fibres turn over more |
    /// | rim | 1.5 um | 2 um | beyond the reach of the blurred outline through the gradient |
    /// | least coherency | 0.2 | 0.2 | 99 of 100 places of a picture of noise alone stay below |
    ///
    /// # Example
    /// ```
    /// use myospring::microscopy::fibres::{FibreSettings, Stain};
    /// assert_eq!(FibreSettings::of(Stain::ZDisc).gradient_scale_um, 0.3);
    /// ```
    pub const fn of(stain: Stain) -> Self {
        let (gradient, rim) = match stain {
            Stain::ZDisc => (0.3, 1.5),
            Stain::Filament => (0.5, 2.0),
        };
        Self {
            stain,
            gradient_scale_um: gradient,
            background_scale_um: 4.0 * gradient,
            smoothing_um: 3.0,
            rim_um: rim,
            least_coherency: 0.2,
        }
    }
}
