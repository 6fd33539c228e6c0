//! Nested dissection: an order of elimination in which factors stay sparse.
//!
//! A set of nodes is divided by a separator: the nodes on one side of a line across the body that
//! interact with nodes on the other. The two halves do not interact until the separator is
//! eliminated, so it comes last. The halves are divided in the same way (`george_1973`, for regular
//! meshes). The line is perpendicular to one of the axes, with half of the nodes on each side; the
//! axis and the side with the smallest separator are chosen.

use crate::interruption::Interruption;
use crate::mechanics::Vectors;
use crate::mechanics::stiffness::StiffnessMatrix;
use std::ops::Range;

/// Largest set of nodes that is not cut again.
const SMALLEST: usize = 16;

/// For each node, the other nodes with which it interacts.
pub(super) struct Graph {
    starts: Vec<usize>,
    partners: Vec<usize>,
}

impl Graph {
    pub(super) fn new<const D: usize>(stiffness: &StiffnessMatrix<D>) -> Self {
        let count = stiffness.len();
        let pairs = || {
            let of = |a: usize| stiffness.row(a).0.iter().map(move |&b| (a, b));
            (0..count).flat_map(of).filter(|(a, b)| a != b)
        };
        let mut starts = vec![0; count + 1];
        for (a, b) in pairs() {
            starts[a + 1] += 1;
            starts[b + 1] += 1;
        }
        for node in 0..count {
            starts[node + 1] += starts[node];
        }
        let mut next = starts.clone();
        let mut partners = vec![0; starts[count]];
        for (a, b) in pairs() {
            for (from, to) in [(a, b), (b, a)] {
                partners[next[from]] = to;
                next[from] += 1;
            }
        }
        Self { starts, partners }
    }

    pub(super) fn partners(&self, node: usize) -> &[usize] {
        &self.partners[self.starts[node]..self.starts[node + 1]]
    }
}

/// Nodes that are eliminated together: a separator, or a set that was not divided further.
pub(super) struct Part {
    /// Places in the order of elimination.
    pub(super) own: Range<usize>,
    /// The halves on both sides of a separator.
    pub(super) halves: [Option<usize>; 2],
    /// Number of separators around it.
    pub(super) depth: usize,
}

/// An order of elimination and the tree behind it.
pub(super) struct Dissection {
    /// The node at each place.
    pub(super) order: Vec<usize>,
    /// Halves before their separators, in the order of elimination.
    pub(super) parts: Vec<Part>,
}

/// Dissects a body; can be interrupted.
pub(super) fn dissect<const D: usize>(
    graph: &Graph,
    positions: &Vectors<D>,
    interruption: &Interruption,
) -> Dissection {
    let count = positions[0].len();
    let mut knife = Knife {
        graph,
        positions,
        class: vec![Class::Elsewhere; count],
        parts: Vec::new(),
        interruption,
    };
    let mut order: Vec<usize> = (0..count).collect();
    knife.cut(&mut order, 0, 0);
    Dissection { order, parts: knife.parts }
}

/// Class of a node, in the order of elimination.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Class {
    Below,
    Above,
    Separator,
    Elsewhere,
}

struct Knife<'a> {
    graph: &'a Graph,
    positions: &'a [Vec<f64>],
    class: Vec<Class>,
    parts: Vec<Part>,
    interruption: &'a Interruption,
}

impl Knife<'_> {
    /// Orders nodes whose places begin at `start`, and returns the index of their last part.
    fn cut(&mut self, nodes: &mut [usize], start: usize, depth: usize) -> Option<usize> {
        if nodes.is_empty() {
            return None;
        }
        let (mut end, mut halves) = (start, [None; 2]);
        if nodes.len() > SMALLEST && !self.interruption.is_requested() {
            let [below, above] = self.divide(nodes);
            halves[0] = self.cut(&mut nodes[..below], end, depth + 1);
            end += below;
            halves[1] = self.cut(&mut nodes[below..below + above], end, depth + 1);
            end += above;
        }
        self.parts.push(Part { own: end..start + nodes.len(), halves, depth });
        Some(self.parts.len() - 1)
    }

    /// Sorts nodes into those below a cut, those above it and the separator, each by number, and
    /// returns the counts of the first two.
    fn divide(&mut self, nodes: &mut [usize]) -> [usize; 2] {
        let sides = [Class::Below, Class::Above];
        let mut best = (usize::MAX, 0, Class::Below);
        for axis in 0..self.positions.len() {
            self.halve(nodes, axis);
            for side in sides {
                let size = nodes.iter().filter(|&&node| self.faces_the_other(node, side)).count();
                if size < best.0 {
                    best = (size, axis, side);
                }
            }
        }
        let (_, axis, side) = best;
        self.halve(nodes, axis);
        let separator: Vec<usize> =
            nodes.iter().copied().filter(|&node| self.faces_the_other(node, side)).collect();
        for node in separator {
            self.class[node] = Class::Separator;
        }
        nodes.sort_unstable_by_key(|&node| (self.class[node], node));
        let [below, both] =
            sides.map(|side| nodes.partition_point(|&node| self.class[node] <= side));
        for &mut node in nodes {
            self.class[node] = Class::Elsewhere;
        }
        [below, both - below]
    }

    /// Marks half of the nodes as below a cut across an axis, half as above.
    fn halve(&mut self, nodes: &mut [usize], axis: usize) {
        let along = &self.positions[axis];
        let (below, _, _) = nodes.select_nth_unstable_by(nodes.len() / 2, |&a, &b| {
            along[a].total_cmp(&along[b]).then(a.cmp(&b))
        });
        let below = below.len();
        for (at, &node) in nodes.iter().enumerate() {
            self.class[node] = if at < below { Class::Below } else { Class::Above };
        }
    }

    /// Whether a node interacts with one on the other side.
    fn faces_the_other(&self, node: usize, side: Class) -> bool {
        let other = if side == Class::Below { Class::Above } else { Class::Below };
        self.class[node] == side
            && self.graph.partners(node).iter().any(|&partner| self.class[partner] == other)
    }
}
