//! How directions are read from a picture.

use std::ops::RangeInclusive;

/// Bounds of the length settings, um.
pub const SCALES_UM: RangeInclusive<f64> = 0.05..=100.0;

/// Bounds of the coherency setting.
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
    /// Standard deviation of the Gaussian whose derivative is the gradient, um; only for filaments.
    /// At least one pixel is used: below that, the pixel grid biases the directions.
    pub gradient_scale_um: f64,
    /// Standard deviation of the Gaussian whose mean is subtracted, um: things wider than about six
    /// times this count as uneven light.
    pub background_scale_um: f64,
    /// Standard deviation of the Gaussian over the local spectra or the tensors, um.
    pub smoothing_um: f64,
    /// Width of the ignored rim along the outline, um. For filaments, its inner part (three
    /// gradient scales wide) still contributes to the gradients beside it.
    pub rim_um: f64,
    /// Coherency at which picture and long axis have equal weight; only for filaments. The
    /// picture's weight rises from 0 at half this value to 1 at one and a half times it.
    pub least_coherency: f64,
}

impl FibreSettings {
    /// The defaults for a stain.
    ///
    /// | setting | z-discs | filaments | why |
    /// |---|---|---|---|
    /// | gradient scale | - | 0.5 um | a Gaussian's derivative answers most to threads `2 pi` of its width apart: bundles of filaments |
    /// | background scale | 1.5 um | 2 um | keeps periods up to 4 um, with which those of sarcomeres are compared |
    /// | smoothing | 3 um | 3 um | about three sarcomeres to each side; fibres turn over longer distances |
    /// | rim | 0.8 um | 2 um | the blurred outline; for filaments, also its reach through the gradient |
    /// | least coherency | - | 0.2 | 99 of 100 places in a picture of noise stay below |
    ///
    /// # Example
    /// ```
    /// use myospring::microscopy::fibres::{FibreSettings, Stain};
    /// assert_eq!(FibreSettings::of(Stain::ZDisc).smoothing_um, 3.0);
    /// ```
    pub const fn of(stain: Stain) -> Self {
        let (background_scale_um, rim_um) = match stain {
            Stain::ZDisc => (1.5, 0.8),
            Stain::Filament => (2.0, 2.0),
        };
        Self {
            stain,
            gradient_scale_um: 0.5,
            background_scale_um,
            smoothing_um: 3.0,
            rim_um,
            least_coherency: 0.2,
        }
    }
}
