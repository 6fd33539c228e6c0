//! Spring updates per second of the fused kernel, in the form of the peers' benchmarks.
//!
//! ```text
//! cargo run --release -p myospring-verification --example throughput -- SIZE THREADS [springs|all|fields] [avx512|avx2|portable|plain]
//! ```
//!
//! SIZE is `2k`, `20k`, `200k`, `2M`, or `COLUMNSxROWS` or `COLUMNSxROWSxLAYERS` masses. `springs`: springs and dashpots; `all`:
//! with area or volume law, fibre tension and drag too; `fields`: as `all`, with masses, stiffnesses and fibre
//! directions that differ from place to place. Prints one JSON line.
//!
//! The work: spacing 1, k = 1 for every spring, dashpot 0.1, mass 1, time step 0.05, a smooth initial
//! displacement of 0.05. After 200 steps of 100 x 20 masses the sum of the squared displacements is
//! 1.22231411297 and the sum of the squared half-step velocities 0.657978435, by programs not ours.
#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "a program of its own")]

use myospring::integrate::stencil::{Stencil, Units};
use myospring::mechanics::active::FibreTension;
use myospring::mechanics::area::{AreaLaw, AreaPreservation};
use myospring::mechanics::drag::Drag;
use myospring::mechanics::spring::Springs;
use myospring::mechanics::support::Support;
use myospring::mechanics::volume::VolumePreservation;
use myospring::mechanics::{Body, Configuration, Force, System, zeros};
use myospring::mesh::{Lattice, Mesh, cubes, lattice};
use std::time::Instant;

const TIME_STEP: f64 = 0.05;
const TENSION: f64 = 0.05;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let argument = |index: usize, default: &str| {
        arguments.get(index).map_or_else(|| default.to_owned(), Clone::clone)
    };
    let (size, threads) = (argument(0, "2k"), argument(1, "1").parse().unwrap());
    let (forces, units) = (argument(2, "springs"), argument(3, "best"));
    let size = match size.as_str() {
        "2k" => "100x20",
        "20k" => "320x64",
        "200k" => "1000x200",
        "2M" => "2000x1000",
        other => other,
    };
    let units = match units.as_str() {
        "avx512" => Units::Avx512,
        "avx2" => Units::Avx2,
        "portable" => Units::Portable,
        _ => Units::best(),
    };
    let shape: Vec<usize> = size.split('x').map(|count| count.parse().unwrap()).collect();
    match shape[..] {
        [columns, rows] => {
            let mesh = lattice::rectangle(columns - 1, rows - 1, 1.0).unwrap();
            let law = AreaPreservation::new(&mesh, AreaLaw::Gradient, 0.5);
            measure(&mesh, Box::new(law), (&forces, size), threads, units);
        }
        [columns, rows, layers] => {
            let mesh = cubes::block([columns, rows, layers].map(|count| count - 1), 1.0).unwrap();
            let law = VolumePreservation::new(&mesh, cubes::TETRAHEDRA_OF_A_CUBE, 0.5);
            measure(&mesh, Box::new(law), (&forces, size), threads, units);
        }
        _ => panic!("two or three numbers of masses"),
    }
}

/// Prints the speed of one lattice.
fn measure<const D: usize, const N: usize>(
    mesh: &Mesh<D, N>,
    law: Box<dyn Force<D>>,
    (forces, size): (&str, &str),
    threads: usize,
    units: Units,
) {
    let (body, system) = problem(mesh, law, forces);
    let springs = mesh.springs.len();
    let mut motion = Start::new(&system, body, mesh.lattice.as_ref().unwrap(), threads, units);
    motion.stencil.advance(199, [TENSION; 2]).unwrap();
    let check = motion.check(mesh);

    // As many steps as take about half a second; then the median of five runs of two seconds.
    let mut steps = 16;
    let seconds = |stencil: &mut Stencil<D>, steps: usize| {
        let start = Instant::now();
        stencil.advance(steps, [TENSION; 2]).unwrap();
        start.elapsed().as_secs_f64()
    };
    let mut taken = seconds(&mut motion.stencil, steps);
    while taken < 0.1 {
        steps *= 2;
        taken = seconds(&mut motion.stencil, steps);
    }
    steps = (steps as f64 * 0.4 / taken).ceil() as usize;
    let mut rates: Vec<f64> =
        (0..5).map(|_| (springs * steps) as f64 / seconds(&mut motion.stencil, steps)).collect();
    rates.sort_by(f64::total_cmp);
    println!(
        "{{\"peer\": \"myospring-{forces}\", \"units\": \"{units:?}\", \"size\": \"{size}\", \
         \"springs\": {springs}, \"threads\": {}, \"prec\": \"f64\", \"steps\": {steps}, \
         \"sups\": {:.6e}, \"sups_min\": {:.6e}, \"sups_max\": {:.6e}, \"check\": [{:.12}, {:.12}]}}",
        motion.stencil.threads(),
        rates[2],
        rates[0],
        rates[4],
        check[0],
        check[1],
    );
}

/// The peers' lattice under the asked forces.
fn problem<const D: usize, const N: usize>(
    mesh: &Mesh<D, N>,
    law: Box<dyn Force<D>>,
    forces: &str,
) -> (Body<D>, System<D>) {
    let varied = forces == "fields";
    let vary = |i: usize| if varied { 1.0 + 0.1 * (0.7 * i as f64).sin() } else { 1.0 };
    let masses: Vec<f64> = (0..mesh.len()).map(vary).collect();
    let nodes: Vec<[u32; 2]> = mesh.springs.iter().map(|spring| spring.nodes).collect();
    let rest_length: Vec<f64> = nodes
        .iter()
        .map(|pair| {
            let [a, b] = pair.map(|node| mesh.point(node as usize));
            a.iter().zip(b).map(|(a, b)| b - a).fold(0.0, f64::hypot)
        })
        .collect();
    let stiffness = nodes.iter().map(|pair| vary(pair[0] as usize)).collect();
    let damping = nodes.iter().map(|pair| 0.1 * vary(pair[0] as usize)).collect();
    let springs = Springs::new(nodes, stiffness, rest_length, damping);
    let mut system = System {
        passive: vec![Box::new(springs)],
        active: vec![],
        drag: Drag { rate: 0.0, masses: masses.clone() },
        support: Support::Free,
    };
    if forces != "springs" {
        system.passive.push(law);
        let angle = |i: usize| if varied { 0.3 + 0.2 * (0.01 * i as f64).sin() } else { 0.3 };
        let fibres: Vec<[f64; D]> = (0..mesh.simplices.len())
            .map(|i| {
                let (sine, cosine) = angle(i).sin_cos();
                std::array::from_fn(|axis| [cosine, sine, 0.0][axis])
            })
            .collect();
        system.active.push(Box::new(FibreTension::new(mesh, &fibres, 1.0)));
        system.drag.rate = 0.01;
    }
    let mut body = Body { positions: mesh.points.clone(), velocities: zeros(mesh.len()), masses };
    let cells = &mesh.lattice.as_ref().unwrap().cells;
    for (node, cell) in cells.iter().enumerate() {
        let (i, j) = (f64::from(cell[0]), f64::from(cell[1]));
        let k = cell.get(2).map_or(0.0, |layer| f64::from(*layer));
        body.positions[0][node] += 0.05 * (0.37 * i + 0.61 * j + 0.43 * k).sin();
        body.positions[1][node] += 0.05 * (0.53 * i - 0.29 * j + 0.71 * k + 1.0).sin();
    }
    (body, system)
}

/// The kernel after its first step, which starts from velocities at the full step.
struct Start<const D: usize> {
    stencil: Stencil<D>,
    count: usize,
}

impl<const D: usize> Start<D> {
    fn new(
        system: &System<D>,
        mut body: Body<D>,
        lattice: &Lattice<D>,
        threads: usize,
        units: Units,
    ) -> Self {
        let mut forces = zeros(body.len());
        let still = zeros(body.len());
        let at = Configuration {
            positions: &body.positions,
            velocities: &still,
            tension: TENSION.into(),
        };
        for force in system.passive.iter().chain(&system.active) {
            Force::add_forces(&**force, &at, &mut forces);
        }
        for axis in 0..D {
            for node in 0..body.len() {
                let velocity = 0.5 * TIME_STEP * forces[axis][node] / body.masses[node];
                body.velocities[axis][node] = velocity;
                body.positions[axis][node] += TIME_STEP * velocity;
            }
        }
        let stencil = Stencil::new(system, &body, lattice, TIME_STEP, threads, units).unwrap();
        Self { stencil, count: body.len() }
    }

    /// Sums of squared displacements and of squared half-step velocities.
    fn check<const N: usize>(&mut self, mesh: &Mesh<D, N>) -> [f64; 2] {
        let (mut positions, mut velocities) = (zeros(self.count), zeros(self.count));
        self.stencil.read_half_step(&mut positions, &mut velocities);
        let places = positions.iter().flatten().zip(mesh.points.iter().flatten());
        let velocities = velocities.iter().flatten();
        [places.map(|(x, r)| (x - r).powi(2)).sum(), velocities.map(|v| v * v).sum()]
    }
}
