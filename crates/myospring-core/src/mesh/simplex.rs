//! One triangle or tetrahedron: its area or volume, and how that changes with the corners.
//!
//! Both are called the measure of the simplex. With the edges `u`, `w` (and `q`) from the first corner,
//!
//! ```text
//! A = (u_x w_y - u_y w_x)/2            V = u . (w x q)/6
//! ```
//!
//! The linear shape function of corner i has the gradient `grad N_i = (d measure/d x_i) / measure`.

use std::ops::{Add, Mul, Sub};

/// Signed measure, um^2 or um^3: positive if the corners run as [`super::Simplex::nodes`] says.
///
/// # Example
/// ```
/// use myospring::mesh::simplex::measure;
/// assert_eq!(measure(&[[0.0, 0.0], [2.0, 0.0], [0.0, 1.0]]), 1.0);
/// let corner = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 3.0]];
/// assert_eq!(measure(&corner), 0.5);
/// ```
pub fn measure<const D: usize, const N: usize>(corners: &[[f64; D]; N]) -> f64 {
    measure_of::<D, N>(|corner, axis| corners[corner][axis])
}

/// Signed measure of the simplex of these nodes in given positions (`positions[axis][node]`), um^2 or um^3.
#[inline]
pub fn measure_at<const D: usize, const N: usize>(
    positions: &[Vec<f64>; D],
    nodes: [u32; N],
) -> f64 {
    measure_of::<D, N>(|corner, axis| positions[axis][nodes[corner] as usize])
}

#[inline(always)]
#[allow(clippy::inline_always, reason = "belongs to sums over all simplices")]
fn measure_of<const D: usize, const N: usize>(at: impl Fn(usize, usize) -> f64) -> f64 {
    const { assert!(N == D + 1 && (D == 2 || D == 3), "triangles and tetrahedra") };
    let edge = |k: usize, axis: usize| at(k, axis) - at(0, axis);
    if D == 2 {
        return 0.5 * (edge(1, 0) * edge(2, 1) - edge(1, 1) * edge(2, 0));
    }
    let minor = |p: usize, q: usize| edge(2, p) * edge(3, q) - edge(2, q) * edge(3, p);
    (edge(1, 0) * minor(1, 2) + edge(1, 1) * minor(2, 0) + edge(1, 2) * minor(0, 1)) / 6.0
}

/// What coordinates may be: numbers, or numbers of several simplices at once.
pub(crate) trait Real:
    Copy
    + Default
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Mul<f64, Output = Self>
{
}

impl<T> Real for T where
    T: Copy + Default + Add<Output = T> + Sub<Output = T> + Mul<Output = T> + Mul<f64, Output = T>
{
}

/// Derivative of the measure with respect to each corner, um or um^2: `gradients[corner][axis]`; their sum
/// is zero.
#[inline]
pub fn measure_gradients<const D: usize, const N: usize>(corners: &[[f64; D]; N]) -> [[f64; D]; N] {
    gradients_of(corners.each_ref())
}

/// As [`measure_gradients`].
#[inline(always)]
#[allow(clippy::inline_always, reason = "belongs to vectorised work")]
pub(crate) fn gradients_of<T: Real, const D: usize, const N: usize>(
    corners: [&[T; D]; N],
) -> [[T; D]; N] {
    const { assert!(N == D + 1 && (D == 2 || D == 3), "triangles and tetrahedra") };
    let mut gradients = [[T::default(); D]; N];
    if D == 2 {
        // dA/dx_a = (y_b - y_c, x_c - x_b)/2
        for k in 0..3 {
            let (next, last) = (corners[(k + 1) % 3], corners[(k + 2) % 3]);
            gradients[k][0] = (next[1] - last[1]) * 0.5;
            gradients[k][1] = (last[0] - next[0]) * 0.5;
        }
        return gradients;
    }
    // dV/du = (w x q)/6 and so on round; the first corner takes minus the rest.
    for k in 1..4 {
        let (next, last) = (corners[k % 3 + 1], corners[(k + 1) % 3 + 1]);
        let normal = cross(corners[0], next, last);
        for axis in 0..3 {
            gradients[k][axis] = normal[axis] * (1.0 / 6.0);
            gradients[0][axis] = gradients[0][axis] - gradients[k][axis];
        }
    }
    gradients
}

/// Second derivatives of the measure, dimensionless or um: `curvature[a][b][i][j]` is that with respect to coordinate `i` of
/// corner `a` and `j` of corner `b`. The measure is linear in each corner, so those of one corner are 0.
#[inline]
pub fn measure_curvature<const D: usize, const N: usize>(
    corners: &[[f64; D]; N],
) -> [[[[f64; D]; D]; N]; N] {
    const { assert!(N == D + 1 && (D == 2 || D == 3), "triangles and tetrahedra") };
    let mut curvature = [[[[0.0; D]; D]; N]; N];
    // Of a tetrahedron: d(dV/dx_a)/dx_b = +-[x_c - x_d]x/6 with the matrix [q]x of the product q x, that is
    // [q]x_ij = -sum_k e_ijk q_k. Of a triangle: d(dA/dx_a)/dx_b = +-e_ij/2, with + from each corner to the next.
    let mut both = |a: usize, b: usize, i: usize, j: usize, value: f64| {
        curvature[a][b][i][j] = value;
        curvature[b][a][j][i] = value;
    };
    if D == 2 {
        for a in 0..3 {
            both(a, (a + 1) % 3, 0, 1, 0.5);
            both(a, (a + 1) % 3, 1, 0, -0.5);
        }
        return curvature;
    }
    for [a, b, c, d] in
        [[1, 2, 0, 3], [3, 1, 0, 2], [2, 3, 0, 1], [1, 0, 3, 2], [2, 0, 1, 3], [3, 0, 2, 1]]
    {
        for k in 0..3 {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            let part = (corners[c][k] - corners[d][k]) / 6.0;
            both(a, b, j, i, part);
            both(a, b, i, j, -part);
        }
    }
    curvature
}

/// `(a - origin) x (b - origin)`, of three axes.
#[inline(always)]
#[allow(clippy::inline_always, reason = "belongs to vectorised work")]
fn cross<T: Real, const D: usize>(origin: &[T; D], a: &[T; D], b: &[T; D]) -> [T; 3] {
    let [a, b] = [a, b].map(|end| [0, 1, 2].map(|axis| end[axis] - origin[axis]));
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn differences_agree<const D: usize, const N: usize>(corners: [[f64; D]; N]) {
        let gradients = measure_gradients(&corners);
        for k in 0..N {
            for axis in 0..D {
                let moved = |by: f64| {
                    let mut there = corners;
                    there[k][axis] += by;
                    measure(&there)
                };
                // The measure is linear in each coordinate: only rounding is left.
                let slope = (moved(0.5) - moved(-0.5)) / 1.0;
                assert!((gradients[k][axis] - slope).abs() < 1e-14, "corner {k}, axis {axis}");
            }
        }
        for axis in 0..D {
            let sum: f64 = gradients.iter().map(|gradient| gradient[axis]).sum();
            assert!(sum.abs() < 1e-15, "a shift changes the measure by {sum}");
        }
    }

    fn curvature_agrees<const D: usize, const N: usize>(corners: [[f64; D]; N]) {
        let curvature = measure_curvature(&corners);
        let base = measure_gradients(&corners);
        for b in 0..N {
            for j in 0..D {
                let mut moved = corners;
                moved[b][j] += 1.0;
                let there = measure_gradients(&moved);
                for a in (0..N).filter(|a| *a != b) {
                    for i in 0..D {
                        let slope = there[a][i] - base[a][i];
                        let found = curvature[a][b][i][j];
                        assert!((found - slope).abs() < 1e-14, "{a} {b} {i} {j}: {found}, {slope}");
                    }
                }
            }
        }
    }

    #[test]
    fn curvatures_of_area_and_volume_are_the_derivatives_of_gradients() {
        curvature_agrees([[0.1, 0.3], [1.2, 0.2], [0.4, 0.9]]);
        curvature_agrees([[0.1, 0.3, -0.2], [1.2, 0.2, 0.1], [0.4, 0.9, 0.0], [0.2, 0.1, 1.1]]);
    }

    #[test]
    fn gradients_of_area_and_volume_are_their_derivatives() {
        differences_agree([[0.1, 0.3], [1.2, 0.2], [0.4, 0.9]]);
        differences_agree([[0.1, 0.3, -0.2], [1.2, 0.2, 0.1], [0.4, 0.9, 0.0], [0.2, 0.1, 1.1]]);
    }
}
