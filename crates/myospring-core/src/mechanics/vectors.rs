//! Positions, velocities and forces of all nodes.

/// One vector per node, by axis: `vectors[axis][node]`.
pub type Vectors<const D: usize = 2> = [Vec<f64>; D];

/// Vectors of length zero for `count` nodes.
pub fn zeros<const D: usize>(count: usize) -> Vectors<D> {
    std::array::from_fn(|_| vec![0.0; count])
}
