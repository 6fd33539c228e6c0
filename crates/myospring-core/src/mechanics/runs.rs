//! Runs: consecutive springs, triangles or masses whose nodes or places are consecutive too.
//!
//! On a lattice numbered row by row, nearly all springs of one direction belong to such runs, so
//! the inner loops of the forces read memory sequentially and the compiler can vectorise them. Any
//! other mesh has runs of length one and the same results.
//!
//! [`vectorised`] compiles a loop a second time for wider vector units and uses it if the processor
//! has them. Rust never fuses or reorders floating-point operations, so both give bitwise the same
//! results.

/// Longest run; buffers of this size stay in registers and first-level cache.
pub(crate) const LONGEST: usize = 64;

/// Elements `first..first + len`, of which element `k` joins the nodes `nodes[..] + k`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Run<const N: usize> {
    pub(crate) nodes: [usize; N],
    pub(crate) first: usize,
    pub(crate) len: usize,
}

/// Cuts a list of elements into runs, in order.
pub(crate) fn find<const N: usize>(elements: &[[u32; N]]) -> Vec<Run<N>> {
    let mut runs: Vec<Run<N>> = Vec::new();
    for (index, element) in elements.iter().enumerate() {
        let nodes = element.map(|node| node as usize);
        match runs.last_mut() {
            Some(run)
                if run.len < LONGEST && (0..N).all(|k| run.nodes[k] + run.len == nodes[k]) =>
            {
                run.len += 1;
            }
            _ => runs.push(Run { nodes, first: index, len: 1 }),
        }
    }
    runs
}

/// Runs a closure of `#[inline(always)]` functions with the vector units this processor has.
pub(crate) fn vectorised(work: impl FnOnce()) {
    pulp::Arch::new().dispatch(work);
}

/// Adds `buffer` to the nodes from `start` on.
#[inline(always)]
#[allow(clippy::inline_always, reason = "belongs to the vectorised loop around it")]
pub(crate) fn add(forces: &mut [f64], start: usize, buffer: &[f64]) {
    for (force, value) in forces[start..start + buffer.len()].iter_mut().zip(buffer) {
        *force += value;
    }
}

/// Sum of the values, in eight partial sums that can be vectorised.
#[inline(always)]
#[allow(clippy::inline_always, reason = "belongs to the vectorised loop around it")]
pub(crate) fn sum(values: &[f64]) -> f64 {
    let mut lanes = [0.0; 8];
    let chunks = values.chunks_exact(8);
    let rest: f64 = chunks.remainder().iter().sum();
    for chunk in chunks {
        for (lane, value) in lanes.iter_mut().zip(chunk) {
            *lane += value;
        }
    }
    rest + lanes.iter().sum::<f64>()
}

/// Subtracts `buffer` from the nodes from `start` on.
#[inline(always)]
#[allow(clippy::inline_always, reason = "belongs to the vectorised loop around it")]
pub(crate) fn subtract(forces: &mut [f64], start: usize, buffer: &[f64]) {
    for (force, value) in forces[start..start + buffer.len()].iter_mut().zip(buffer) {
        *force -= value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_cover_all_elements_once_in_order() {
        let elements = [[0, 1], [1, 2], [2, 3], [5, 6], [6, 8], [7, 9]];
        let runs = find(&elements);
        assert_eq!(runs.iter().map(|run| run.len).collect::<Vec<_>>(), [3, 1, 2]);
        let expanded: Vec<[u32; 2]> = runs
            .iter()
            .flat_map(|run| (0..run.len).map(|k| run.nodes.map(|node| (node + k) as u32)))
            .collect();
        assert_eq!(expanded, elements);
    }
}
