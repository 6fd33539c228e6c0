//! How the potential spreads over a mesh: the monodomain equation without the cells.
//!
//! ```text
//! dV/dt = div(D grad V),   D = D_across 1 + (D_along - D_across) f f^T,   no flux through the rim
//! ```
//!
//! Linear finite elements on the triangles at rest, with the area of each node in its own row. On a square lattice with both diagonals
//! and an even `D` that is the stencil of five points. Short steps, of less than the time constant of the fastest mode, are the first terms
//! of the series of the exponential function, which are of second order, too. Longer ones are Crank and Nicolson's
//! (`crank_nicolson_1947`), of second order and stable at any length; the equations are solved by conjugate gradients (`hestenes_1952`) from
//! the potential before.

use crate::mesh::Mesh;
use crate::mesh::simplex::{measure, measure_gradients};
use std::ops::Range;

/// Rounds at most, and the part of the rest that ends them.
const ROUNDS: usize = 1000;
const LEFT: f64 = 1e-12;
/// A step shorter than this part of the fastest time constant takes the series. It has two terms or more: the first term left out changes the
/// fastest mode by `LAST` of it at most.
const SHORT: f64 = 1.0;
const LAST: f64 = 1.0 / 24.0;
/// A difference that is smaller relative to the terms is rounding.
const ROUNDING: f64 = 1e-12;

/// How a tissue conducts, um^2/ms; both 0 leave its cells alone.
///
/// The conduction velocity of a wave grows with the square root. That of human ventricles, some 70 cm/s along the fibres, takes `1.171e5`
/// with the minimal models (`bueno_orovio_2008`).
#[derive(Debug, Clone, PartialEq)]
pub struct Conduction {
    /// Along the fibres.
    pub along: f64,
    /// Across them.
    pub across: f64,
    /// Of each triangle relative to these, such as 0 in a scar; `None` is 1 everywhere.
    pub relative: Option<Vec<f64>>,
}

impl Conduction {
    /// Alike in all directions.
    pub const fn even(diffusion: f64) -> Self {
        Self { along: diffusion, across: diffusion, relative: None }
    }
}

/// The spreading of a potential between the nodes of a mesh.
#[derive(Debug, Clone)]
pub(super) struct Diffusion {
    /// Area of each node, um^2.
    areas: Vec<f64>,
    /// Nodes one after the other whose partners are as far from each in their numbers, so that a register holds several of them.
    runs: Vec<Run>,
    /// What flows from a node to its partner for each unit of difference, 1/ms: run by run, partner by partner, and node by node where
    /// nodes differ.
    flows: Vec<f64>,
    /// The sum over the partners of each node, 1/ms.
    diagonal: Vec<f64>,
    /// A bound of the rate of the fastest mode, 1/ms (Gershgorin).
    fastest: f64,
}

/// Nodes of one pattern.
#[derive(Debug, Clone)]
struct Run {
    nodes: Range<usize>,
    /// The number of each partner less that of the node.
    offsets: Vec<isize>,
    /// Where its flows begin.
    flows: usize,
    /// All its nodes have the same flows, as in tissue that conducts evenly: one is kept for each partner.
    alike: bool,
}

impl Diffusion {
    /// Of a mesh with this direction of the fibres in each triangle, a unit vector.
    pub(super) fn new(mesh: &Mesh, fibres: &[[f64; 2]], conduction: &Conduction) -> Self {
        let Conduction { along, across, relative } = conduction;
        let count = mesh.len();
        let mut areas = vec![0.0; count];
        let mut pairs: Vec<(u32, u32, f64)> = Vec::new();
        for (index, (triangle, fibre)) in mesh.simplices.iter().zip(fibres).enumerate() {
            let part = relative.as_ref().map_or(1.0, |relative| relative[index]);
            let corners = triangle.nodes.map(|node| mesh.point(node as usize));
            let area = measure(&corners);
            let gradients = measure_gradients(&corners).map(|of| of.map(|part| part / area));
            for node in triangle.nodes {
                areas[node as usize] += triangle.weight * area / 3.0;
            }
            for a in 0..3 {
                for b in a + 1..3 {
                    let [ahead, behind] = [gradients[a], gradients[b]];
                    let flow = across * dot(ahead, behind)
                        + (along - across) * dot(ahead, *fibre) * dot(behind, *fibre);
                    let (from, to) = (triangle.nodes[a], triangle.nodes[b]);
                    let flow = -triangle.weight * part * area * flow;
                    pairs.extend([(from, to, flow), (to, from, flow)]);
                }
            }
        }
        pairs.sort_unstable_by_key(|&(from, to, _)| (from, to));
        let mut partners: Vec<Vec<(usize, f64)>> = vec![Vec::new(); count];
        for same in pairs.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let (from, to) = (same[0].0 as usize, same[0].1 as usize);
            let flow: f64 = same.iter().map(|pair| pair.2).sum();
            // Where the potential spreads alike in all directions nothing flows along the diagonals of squares.
            let largest = same.iter().map(|pair| pair.2.abs()).fold(0.0, f64::max);
            if flow.abs() > ROUNDING * largest {
                partners[from].push((to, flow / areas[from]));
            }
        }
        let diagonal: Vec<f64> =
            partners.iter().map(|own| own.iter().map(|(_, flow)| flow).sum()).collect();
        let rate = |(own, diagonal): (&Vec<(usize, f64)>, &f64)| {
            diagonal.abs() + own.iter().map(|(_, flow)| flow.abs()).sum::<f64>()
        };
        let fastest = partners.iter().zip(&diagonal).map(rate).fold(0.0, f64::max);
        let (runs, flows) = runs(&partners);
        Self { areas, runs, flows, diagonal, fastest }
    }

    /// `M (u + by K u)`, where `K` takes what flows away.
    fn times(&self, by: f64, potential: &[f64], product: &mut Vec<f64>) {
        product.resize(potential.len(), 0.0);
        self.away(potential, product);
        for ((product, potential), area) in product.iter_mut().zip(potential).zip(&self.areas) {
            *product = area * (potential + by * *product);
        }
    }

    /// Spreads a potential for some time, ms.
    pub(super) fn spread(&self, potential: &mut [f64], over_ms: f64, room: &mut Room) {
        if self.fastest * over_ms < SHORT {
            self.series(potential, over_ms, room);
        } else {
            self.crank_nicolson(potential, over_ms, room);
        }
    }

    /// A short step: `u - h K u + h^2/2 K^2 u - ...`
    fn series(&self, potential: &mut [f64], over_ms: f64, room: &mut Room) {
        let Room { left: term, product: next, .. } = room;
        term.clear();
        term.extend_from_slice(potential);
        next.resize(potential.len(), 0.0);
        let part = self.fastest * over_ms;
        let mut of_fastest = part;
        for number in 1.. {
            let by = -over_ms / f64::from(number);
            let sum = Some(&mut *potential);
            pulp::Arch::new().dispatch(Away { of: self, potential: term, by, rates: next, sum });
            of_fastest *= part / f64::from(number + 1);
            if number > 1 && of_fastest <= LAST {
                return;
            }
            std::mem::swap(term, next);
        }
    }

    /// What flows away from each node, 1/ms.
    fn away(&self, potential: &[f64], rates: &mut [f64]) {
        pulp::Arch::new().dispatch(Away { of: self, potential, by: 1.0, rates, sum: None });
    }

    fn crank_nicolson(&self, potential: &mut [f64], over_ms: f64, room: &mut Room) {
        let half = 0.5 * over_ms;
        let Room { left, next, direction, product } = room;
        // The right side is (M - K h/2) u, and u the first guess: the rest is -K h u.
        self.times(-half, potential, left);
        self.times(half, potential, product);
        left.iter_mut().zip(&*product).for_each(|(left, product)| *left -= product);
        // A node without triangles keeps its potential.
        let scale = |node: usize| {
            let area = self.areas[node];
            if area > 0.0 { 1.0 / (area * (1.0 + half * self.diagonal[node])) } else { 0.0 }
        };
        next.clear();
        next.extend(left.iter().enumerate().map(|(node, left)| scale(node) * left));
        direction.clone_from(next);
        let product_of = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut size = product_of(left, next);
        let whole: f64 =
            potential.iter().zip(&self.areas).map(|(value, area)| area * value * value).sum();
        for _ in 0..ROUNDS {
            if size <= LEFT * LEFT * whole {
                return;
            }
            if size.is_nan() {
                break;
            }
            self.times(half, direction, product);
            let step = size / product_of(direction, product);
            for (value, way) in potential.iter_mut().zip(&*direction) {
                *value += step * way;
            }
            for (left, product) in left.iter_mut().zip(&*product) {
                *left -= step * product;
            }
            next.clear();
            next.extend(left.iter().enumerate().map(|(node, left)| scale(node) * left));
            let was = std::mem::replace(&mut size, product_of(left, next));
            for (way, next) in direction.iter_mut().zip(&*next) {
                *way = next + size / was * *way;
            }
        }
        // Whoever looks at the cells then finds that they are no numbers.
        potential.fill(f64::NAN);
    }
}

/// Puts nodes one after the other of one pattern together; their flows.
fn runs(partners: &[Vec<(usize, f64)>]) -> (Vec<Run>, Vec<f64>) {
    let offsets_of = |node: usize| -> Vec<isize> {
        partners[node].iter().map(|&(other, _)| other.cast_signed() - node.cast_signed()).collect()
    };
    let (mut runs, mut flows): (Vec<Run>, Vec<f64>) = (Vec::new(), Vec::new());
    let mut first = 0;
    while first < partners.len() {
        let offsets = offsets_of(first);
        let others = first + 1..partners.len();
        let last = others.take_while(|&node| offsets_of(node) == offsets).last().unwrap_or(first);
        let nodes = &partners[first..=last];
        let near = |a: f64, b: f64| (a - b).abs() <= ROUNDING * a.abs().max(b.abs());
        let as_first = |own: &Vec<(usize, f64)>| {
            own.iter().zip(&nodes[0]).all(|(one, other)| near(one.1, other.1))
        };
        let alike = nodes.iter().all(as_first);
        let start = flows.len();
        for partner in 0..offsets.len() {
            let kept = if alike { &nodes[..1] } else { nodes };
            flows.extend(kept.iter().map(|own| own[partner].1));
        }
        runs.push(Run { nodes: first..last + 1, offsets, flows: start, alike });
        first = last + 1;
    }
    (runs, flows)
}

/// What flows away from each node, times a factor, compiled for each kind of vector unit.
struct Away<'a> {
    of: &'a Diffusion,
    potential: &'a [f64],
    by: f64,
    rates: &'a mut [f64],
    /// What it is added to.
    sum: Option<&'a mut [f64]>,
}

impl pulp::WithSimd for Away<'_> {
    type Output = ();

    #[inline(always)]
    #[allow(clippy::inline_always, reason = "a call from here would lose the vector units")]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Self { of: Diffusion { runs, flows, diagonal, .. }, potential, by, rates, sum } = self;
        let mut sum = sum;
        for Run { nodes, offsets, flows: start, alike } in runs {
            let count = nodes.len();
            let rates = &mut rates[nodes.clone()];
            let own = &potential[nodes.clone()];
            let diagonal = &diagonal[nodes.clone()];
            let other = |partner: usize| {
                let first = nodes.start.wrapping_add_signed(offsets[partner]);
                &potential[first..first + count]
            };
            match (offsets.len(), alike) {
                // A node in the middle of a sheet that conducts evenly: all at once.
                (4, true) => {
                    let flows: [f64; 4] = std::array::from_fn(|partner| flows[start + partner]);
                    let others: [&[f64]; 4] = std::array::from_fn(other);
                    for at in 0..count {
                        let mut away = diagonal[0] * own[at];
                        for (flow, other) in flows.iter().zip(&others) {
                            away -= flow * other[at];
                        }
                        rates[at] = by * away;
                    }
                }
                (partners, _) => {
                    for (away, (own, diagonal)) in rates.iter_mut().zip(own.iter().zip(diagonal)) {
                        *away = diagonal * own;
                    }
                    for partner in 0..partners {
                        let pairs = rates.iter_mut().zip(other(partner));
                        if *alike {
                            let flow = flows[start + partner];
                            pairs.for_each(|(away, other)| *away -= flow * other);
                        } else {
                            let flows = &flows[start + partner * count..][..count];
                            for ((away, other), flow) in pairs.zip(flows) {
                                *away -= flow * other;
                            }
                        }
                    }
                    for away in &mut *rates {
                        *away *= by;
                    }
                }
            }
            if let Some(sum) = &mut sum {
                for (sum, rate) in sum[nodes.clone()].iter_mut().zip(&*rates) {
                    *sum += rate;
                }
            }
        }
    }
}

fn dot([a, b]: [f64; 2], [c, d]: [f64; 2]) -> f64 {
    a * c + b * d
}

/// Memory of [`Diffusion::spread`].
#[derive(Debug, Clone, Default)]
pub(super) struct Room {
    left: Vec<f64>,
    next: Vec<f64>,
    direction: Vec<f64>,
    product: Vec<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::lattice;
    use std::f64::consts::PI;

    /// The part of `cos(k x) cos(l y)` that is left on a sheet, over what the equation leaves.
    fn left(columns: usize, step_ms: f64, conduction: &Conduction, fibre: [f64; 2]) -> f64 {
        let side = 1000.0;
        let mesh = lattice::rectangle(columns, columns, side / columns as f64).unwrap();
        let diffusion = Diffusion::new(&mesh, &vec![fibre; mesh.simplices.len()], conduction);
        let mode = |at: usize| {
            let [x, y] = mesh.point(at);
            (PI * x / side).cos() * (2.0 * PI * y / side).cos()
        };
        let mut potential: Vec<f64> = (0..mesh.len()).map(mode).collect();
        let (mut room, steps) = (Room::default(), (1.0 / step_ms).round() as usize);
        for _ in 0..steps {
            diffusion.spread(&mut potential, step_ms, &mut room);
        }
        let Conduction { along, across, .. } = conduction;
        let along_x = across + (along - across) * fibre[0] * fibre[0];
        let along_y = across + (along - across) * fibre[1] * fibre[1];
        let rate = (PI / side).powi(2) * (along_x + 4.0 * along_y);
        potential[0] / (-rate).exp()
    }

    #[test]
    fn a_wave_fades_as_the_equation_says_with_the_square_of_spacing_and_step() {
        for (conduction, fibre) in [
            (Conduction::even(2e4), [1.0, 0.0]),
            (Conduction { along: 4e4, ..Conduction::even(1e4) }, [0.0, 1.0]),
        ] {
            let off = |columns, step| (left(columns, step, &conduction, fibre) - 1.0).abs();
            let [coarse, fine] = [off(10, 0.002), off(20, 0.002)];
            assert!((coarse / fine / 4.0 - 1.0).abs() < 0.05, "{coarse} {fine}");
            let steps = |step| left(20, step, &conduction, fibre);
            let [long, short, shortest] = [steps(0.5), steps(0.25), steps(0.002)];
            let ratio = (long - shortest) / (short - shortest);
            assert!((ratio / 4.0 - 1.0).abs() < 0.1, "{ratio}");
        }
    }

    #[test]
    fn nothing_is_lost_and_an_even_potential_stays() {
        let mesh = lattice::rectangle(12, 7, 50.0).unwrap();
        let fibres = vec![[0.6, 0.8]; mesh.simplices.len()];
        // The left half conducts less, and its first column of triangles not at all.
        let relative = mesh.simplices.iter().map(|triangle| match mesh.centre(triangle)[0] {
            x if x < 50.0 => 0.0,
            x if x < 300.0 => 0.3,
            _ => 1.0,
        });
        let relative = Some(relative.collect());
        let conduction = Conduction { along: 1e5, across: 2e4, relative };
        let diffusion = Diffusion::new(&mesh, &fibres, &conduction);
        let total = |potential: &[f64]| -> f64 {
            potential.iter().zip(&mesh.areas).map(|(value, area)| value * area).sum()
        };
        let mut potential: Vec<f64> = (0..mesh.len()).map(|at| (at as f64).sin()).collect();
        let (before, mut room) = (total(&potential), Room::default());
        for _ in 0..50 {
            diffusion.spread(&mut potential, 0.05, &mut room);
        }
        assert!((total(&potential) - before).abs() < 1e-9 * before.abs().max(1.0));
        let mut even = vec![0.7; mesh.len()];
        diffusion.spread(&mut even, 1.0, &mut room);
        assert!(even.iter().all(|value| (value - 0.7).abs() < 1e-14));
    }
}
