//! Distances in space between voxels of any shape.
//!
//! Squared distances, one axis after the other: along an axis, the distance is the lower envelope of
//! a parabola over each voxel (Felzenszwalb and Huttenlocher 2012). The cost is linear in voxels.

/// Squared distance of the middle of each voxel from that of the nearest voxel in the set, um^2;
/// infinite if the set is empty.
///
/// `size` is the number of voxels along x (fastest), y and z, `pitch` their sides. A side of
/// `f64::INFINITY` keeps the distances within each layer.
pub(super) fn squared(set: &[bool], size: [usize; 3], pitch: [f64; 3]) -> Vec<f32> {
    let mut squares: Vec<f32> =
        set.iter().map(|&is| if is { 0.0 } else { f32::INFINITY }).collect();
    let strides = [1, size[0], size[0] * size[1]];
    for axis in 0..3 {
        if !pitch[axis].is_finite() || size[axis] < 2 {
            continue;
        }
        let mut envelope = Envelope::new(size[axis], pitch[axis]);
        let (a, b) = [(1, 2), (0, 2), (0, 1)][axis];
        for j in 0..size[b] {
            for i in 0..size[a] {
                envelope.lower(&mut squares, i * strides[a] + j * strides[b], strides[axis]);
            }
        }
    }
    squares
}

/// Room for one line of voxels.
struct Envelope {
    count: usize,
    pitch: f64,
    line: Vec<f64>,
    /// Voxels whose parabolas form the envelope, and where each begins.
    roots: Vec<(usize, f64)>,
}

impl Envelope {
    fn new(count: usize, pitch: f64) -> Self {
        Self { count, pitch, line: Vec::with_capacity(count), roots: Vec::with_capacity(count) }
    }

    /// Replaces the values of one line by the lower envelope of the parabolas over them.
    fn lower(&mut self, values: &mut [f32], start: usize, stride: usize) {
        let Self { count, pitch, line, roots } = self;
        line.clear();
        line.extend(values[start..].iter().step_by(stride).take(*count).map(|&v| f64::from(v)));
        roots.clear();
        let place = |at: usize| at as f64 * *pitch;
        for (at, &value) in line.iter().enumerate().filter(|(_, value)| value.is_finite()) {
            let mut from = f64::NEG_INFINITY;
            while let Some(&(root, begins)) = roots.last() {
                let gap = place(at) - place(root);
                let rise = value - line[root];
                from = 0.5 * (rise / gap + place(at) + place(root));
                if from > begins {
                    break;
                }
                roots.pop();
                from = f64::NEG_INFINITY;
            }
            roots.push((at, from));
        }
        if roots.is_empty() {
            return;
        }
        let mut current = 0;
        for at in 0..*count {
            while current + 1 < roots.len() && roots[current + 1].1 < place(at) {
                current += 1;
            }
            let root = roots[current].0;
            let gap = place(at) - place(root);
            values[start + at * stride] = (gap * gap + line[root]) as f32;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_nearest_voxel_of_the_set_is_found(
            set in proptest::collection::vec(proptest::bool::weighted(0.1), 5 * 4 * 6),
            step in 0.2_f64..8.0,
        ) {
            let (size, pitch) = ([5, 4, 6], [1.0, 0.7, step]);
            let place = |at: usize| [at % 5, at / 5 % 4, at / 20];
            for (at, found) in squared(&set, size, pitch).into_iter().enumerate() {
                let square = |other: usize| -> f64 {
                    (0..3).map(|k| {
                        let gap = place(at)[k].abs_diff(place(other)[k]) as f64 * pitch[k];
                        gap * gap
                    }).sum()
                };
                let nearest = (0..set.len()).filter(|&other| set[other]).map(square);
                let nearest = nearest.fold(f64::INFINITY, f64::min);
                prop_assert!(found == nearest as f32 || (f64::from(found) / nearest - 1.0).abs() < 1e-5);
            }
        }
    }
}
