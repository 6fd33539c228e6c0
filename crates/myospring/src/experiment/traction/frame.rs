//! The numbers of a frame.

use serde::Serialize;

/// The numbers of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TractionFrame {
    /// Number of the frame in its film, from 0.
    pub frame: usize,
    /// Its time, ms, if the frame rate is known.
    pub t_ms: Option<f64>,
    /// Sum of the absolute tractions, nN.
    #[serde(rename = "traction_force_nN")]
    pub force_nn: f64,
    /// Force across the middle of the cell along the direction in which it pulls, nN: above 0 where its halves are pulled
    /// toward each other.
    #[serde(rename = "axial_force_nN")]
    pub axial_force_nn: f64,
    /// Minus the sum of traction times place, fJ: above 0 where the gel is drawn together.
    #[serde(rename = "contractile_moment_fJ")]
    pub contractile_moment_fj: f64,
    /// Half of the sum of traction times displacement, fJ.
    #[serde(rename = "gel_energy_fJ")]
    pub energy_fj: f64,
    /// The sum of absolute tractions that noise alone would make, nN.
    #[serde(rename = "noise_floor_nN")]
    pub noise_floor_nn: f64,
    /// Standard deviation of the axial force that noise alone would make, nN.
    #[serde(rename = "axial_noise_floor_nN")]
    pub axial_noise_floor_nn: f64,
}
