//! Displacements of a body that is tied to another one of known compliance, such as a gel.
//!
//! ```text
//! K dx + E t = f,      E^T dx = C t
//! ```
//!
//! `K` is the sparse stiffness of the body, `t` the forces on the other, `E` puts the nodes that are attached among all. With
//! the sparse stiffness `B` of springs that are like the other body, `K + B` has the factor that a body on springs has, and
//!
//! ```text
//! (K + E B E^T) dx = f - E (t - B C t)
//! B [C t + E^T (K + B)^-1 E (t - B C t)] = B E^T (K + B)^-1 f
//! ```
//!
//! If `B C` were 1, the matrix of `t` would be, too. Its eigenvalues are near enough for GMRES (`saad_schultz_1986`) to take
//! some twenty rounds.

use super::factor::Factor;
use crate::mechanics::compliance::Compliance;
use crate::mechanics::{Vectors, add_scaled, product, zeros};

/// Largest number of rounds.
const ROUNDS: usize = 200;

/// Displacements (um) of all nodes under forces (nN), up to `tolerance`, a part of the forces on the other body.
pub(super) fn solve<const D: usize>(
    factor: &Factor<D>,
    other: &dyn Compliance<D>,
    forces: &Vectors<D>,
    tolerance: f64,
) -> Vectors<D> {
    let nodes = other.nodes();
    let attached = |vectors: &Vectors<D>| {
        vectors.each_ref().map(|axis| nodes.iter().map(|&node| axis[node]).collect::<Vec<f64>>())
    };
    let mut among_all = zeros::<D>(forces[0].len());
    let mut put = |vectors: &Vectors<D>| {
        for (all, vectors) in among_all.iter_mut().zip(vectors) {
            for (&node, value) in nodes.iter().zip(vectors) {
                all[node] = *value;
            }
        }
        among_all.clone()
    };
    let start = other.likeness(&attached(&factor.solve(forces)));
    let mut times = |tractions: &Vectors<D>| {
        let mut moved = other.displaced(tractions);
        let unlike = less(tractions, &other.likeness(&moved));
        add_scaled(&mut moved, 1.0, &attached(&factor.solve(&put(&unlike))));
        other.likeness(&moved)
    };
    let tractions = gmres(&mut times, start, tolerance);
    let unlike = less(&tractions, &other.likeness(&other.displaced(&tractions)));
    factor.solve(&less(forces, &put(&unlike)))
}

/// Solves `A x = b` by the generalised minimal residual method, from 0.
fn gmres<const D: usize>(
    times: &mut impl FnMut(&Vectors<D>) -> Vectors<D>,
    right: Vectors<D>,
    tolerance: f64,
) -> Vectors<D> {
    let count = right[0].len();
    let size = product(&right, &right).sqrt();
    if size == 0.0 || !size.is_finite() {
        return right;
    }
    let mut basis = vec![scaled(right, 1.0 / size)];
    // Columns of the triangle into which rotations turn the Hessenberg matrix, and the right side turned with it.
    let mut columns: Vec<Vec<f64>> = Vec::new();
    let mut rotations: Vec<[f64; 2]> = Vec::new();
    let mut turned = vec![size];
    while columns.len() < ROUNDS {
        let mut next = times(&basis[columns.len()]);
        let mut column: Vec<f64> = Vec::with_capacity(columns.len() + 2);
        for vector in &basis {
            let part = product(vector, &next);
            add_scaled(&mut next, -part, vector);
            column.push(part);
        }
        let rest = product(&next, &next).sqrt();
        for (place, [cosine, sine]) in rotations.iter().enumerate() {
            let [a, b] = [column[place], column[place + 1]];
            column[place] = cosine * a + sine * b;
            column[place + 1] = cosine * b - sine * a;
        }
        let last = columns.len();
        let length = column[last].hypot(rest);
        let [cosine, sine] = [column[last] / length, rest / length];
        column[last] = length;
        rotations.push([cosine, sine]);
        columns.push(column);
        let left = turned[last];
        turned[last] = cosine * left;
        turned.push(-sine * left);
        if (sine * left).abs() <= tolerance * size || rest == 0.0 {
            break;
        }
        basis.push(scaled(next, 1.0 / rest));
    }
    let mut parts = turned[..columns.len()].to_vec();
    for place in (0..columns.len()).rev() {
        parts[place] /= columns[place][place];
        for above in 0..place {
            parts[above] -= columns[place][above] * parts[place];
        }
    }
    let mut solution = zeros::<D>(count);
    for (part, vector) in parts.iter().zip(&basis) {
        add_scaled(&mut solution, *part, vector);
    }
    solution
}

fn less<const D: usize>(a: &Vectors<D>, b: &Vectors<D>) -> Vectors<D> {
    let mut difference = a.clone();
    add_scaled(&mut difference, -1.0, b);
    difference
}

fn scaled<const D: usize>(mut vectors: Vectors<D>, by: f64) -> Vectors<D> {
    vectors.iter_mut().flatten().for_each(|value| *value *= by);
    vectors
}
