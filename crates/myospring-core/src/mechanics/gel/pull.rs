//! How hard a cell pulls, and in which direction, from its tractions.
//!
//! The first moments of the tractions `t` (each a force on its place) about the places `r` are
//! `M = -sum (t r^T + r t^T)/2`; their trace is the contractile moment (`butler_2002`). The cell pulls along the eigenvector `e` of
//! the largest eigenvalue. With `c` the middle of the absolute tractions, its axial force is
//!
//! ```text
//! F = -1/2 sum (t . e) sign((r - c) . e)
//! ```
//!
//! the force across the middle of the cell: half of what the two halves pull toward each other. Moment and axial force are
//! linear in the tractions, so noise adds to them in both directions alike; it always adds to a sum of absolute values.

use super::surface::Surface;
use crate::mechanics::vectors::Vectors;

/// The direction in which a cell pulls, and its middle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PullAxis {
    /// Unit vector.
    pub direction: [f64; 2],
    /// The middle of the absolute tractions, um.
    pub middle: [f64; 2],
}

/// Forces (nN) of tractions (Pa) on each place, along one axis.
fn force_of(surface: &Surface, traction_pa: f64) -> f64 {
    // 1 Pa um^2 is 1e-3 nN.
    1e-3 * surface.spacing * surface.spacing * traction_pa
}

/// Minus the sum of force times place, `[xx, xy, yy]`, fJ; `xy` is the mean of both orders.
pub fn moments_fj(surface: &Surface, tractions_pa: &Vectors) -> [f64; 3] {
    let [x, y] = tractions_pa;
    let mut moments = [0.0; 3];
    for (place, (x, y)) in x.iter().zip(y).enumerate() {
        let [along, up] = surface.place(place);
        let [x, y] = [x, y].map(|traction| force_of(surface, *traction));
        moments[0] -= x * along;
        moments[1] -= 0.5 * (x * up + y * along);
        moments[2] -= y * up;
    }
    moments
}

/// Half of the sum of force times displacement, fJ.
pub fn energy_fj(surface: &Surface, tractions_pa: &Vectors) -> f64 {
    let axes = tractions_pa.iter().zip(&surface.displacements);
    let products = axes.flat_map(|(tractions, moved)| tractions.iter().zip(moved));
    products.map(|(traction, moved)| 0.5 * force_of(surface, *traction) * moved).sum()
}

impl PullAxis {
    /// The axis of these tractions; `None` where they are all 0.
    ///
    /// # Example
    /// Two forces of 3 nN toward each other:
    /// ```
    /// use myospring::mechanics::gel::Surface;
    /// use myospring::mechanics::gel::pull::PullAxis;
    /// let surface =
    ///     Surface { spacing: 2.0, origin: [0.0; 2], shape: [5, 1], displacements: Default::default() };
    /// let tractions = [vec![750.0, 0.0, 0.0, 0.0, -750.0], vec![0.0; 5]];
    /// let axis = PullAxis::of(&surface, &tractions).unwrap();
    /// assert_eq!((axis.direction, axis.middle), ([1.0, 0.0], [4.0, 0.0]));
    /// assert!((axis.force_nn(&surface, &tractions) - 3.0).abs() < 1e-12);
    /// ```
    pub fn of(surface: &Surface, tractions_pa: &Vectors) -> Option<Self> {
        let [xx, xy, yy] = moments_fj(surface, tractions_pa);
        let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
        let (mut total, mut middle) = (0.0, [0.0; 2]);
        for (place, (x, y)) in tractions_pa[0].iter().zip(&tractions_pa[1]).enumerate() {
            let size = x.hypot(*y);
            total += size;
            let at = surface.place(place);
            middle = [0, 1].map(|axis: usize| middle[axis] + size * at[axis]);
        }
        let direction = [angle.cos(), angle.sin()];
        (total > 0.0).then(|| Self { direction, middle: middle.map(|sum| sum / total) })
    }

    /// What the force along the axis is multiplied by at each place: 1/2 before the middle, -1/2 behind it.
    fn weight(&self, surface: &Surface, place: usize) -> f64 {
        let at = surface.place(place);
        let ahead: f64 =
            (0..2).map(|axis| (at[axis] - self.middle[axis]) * self.direction[axis]).sum();
        if ahead == 0.0 { 0.0 } else { -0.5 * ahead.signum() }
    }

    /// The axial force of tractions, nN: above 0 where the two halves are pulled toward each other.
    pub fn force_nn(&self, surface: &Surface, tractions_pa: &Vectors) -> f64 {
        let [x, y] = tractions_pa;
        let [cosine, sine] = self.direction;
        let along = x.iter().zip(y).map(|(x, y)| force_of(surface, x * cosine + y * sine));
        along.enumerate().map(|(place, force)| self.weight(surface, place) * force).sum()
    }

    /// The vector field whose scalar product with the tractions (Pa) is the axial force, nN.
    pub(super) fn weights(&self, surface: &Surface, region: Option<&[bool]>) -> Vectors {
        let within = |place: usize| region.is_none_or(|region| region[place]);
        let places = 0..surface.shape[0] * surface.shape[1];
        let weights = places.map(|place| {
            if within(place) { force_of(surface, self.weight(surface, place)) } else { 0.0 }
        });
        let weights: Vec<f64> = weights.collect();
        self.direction.map(|part| weights.iter().map(|weight| part * weight).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_ends_that_pull_obliquely_have_their_axis_their_force_and_their_moment() {
        let shape = [30, 20];
        let surface =
            Surface { spacing: 0.5, origin: [-3.0, 2.0], shape, displacements: Default::default() };
        let mut tractions = [(); 2].map(|()| vec![0.0; 600]);
        // 8 Pa on 0.25 um^2 are 2e-3 nN, along (3, 4)/5, at places 10 um apart along it.
        for (column, row, sign) in [(5, 1, 1.0), (17, 17, -1.0)] {
            tractions[0][row * 30 + column] = sign * 8.0 * 0.6;
            tractions[1][row * 30 + column] = sign * 8.0 * 0.8;
        }
        let axis = PullAxis::of(&surface, &tractions).unwrap();
        assert!((axis.direction[0] - 0.6).abs() < 1e-12 && (axis.direction[1] - 0.8).abs() < 1e-12);
        assert!((axis.force_nn(&surface, &tractions) - 2e-3).abs() < 1e-15);
        let [xx, _, yy] = moments_fj(&surface, &tractions);
        assert!((xx + yy - 2e-2).abs() < 1e-12);
        let pushed = tractions.each_ref().map(|axis| axis.iter().map(|t| -t).collect());
        assert!((axis.force_nn(&surface, &pushed) + 2e-3).abs() < 1e-15);
        let weights = axis.weights(&surface, None);
        let product = weights.iter().zip(&tractions).flat_map(|(a, b)| a.iter().zip(b));
        assert!((product.map(|(a, b)| a * b).sum::<f64>() - 2e-3).abs() < 1e-15);
        assert_eq!(PullAxis::of(&surface, &[vec![0.0; 600], vec![0.0; 600]]), None);
    }
}
