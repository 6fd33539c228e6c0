//! The twitch of finite elements in space: cubes in the form of the finite elements' own cell.
//!
//! `cell_3D_intracellular.vtk` has that cell's tetrahedra, some as wide as half of it. What is inside of them is filled with cubes. The matrix
//! around is springs that hold each point where it was, in proportion to its volume. Two constants are fitted as for the strip of [`finite_elements`]:
//! Young's modulus to the peak of the strain, the matrix to the mean fibre stress at that peak.

use crate::check::{Failure, Setting};
use crate::finite_elements::{self, LENGTH, Line, SOURCE, VOLUME, apart, timing};
use crate::row::Row;
use myospring::integrate::quasi_static::{Path, Tolerance};
use myospring::interruption::Interruption;
use myospring::mechanics::material::{
    Material, Stiffness, assemble_thick, default_material, of_thick_cell,
};
use myospring::mechanics::stiffness::StiffnessMatrix;
use myospring::mechanics::support::{Support, SupportKind};
use myospring::mechanics::{Body, Configuration, Force, System, Vectors};
use myospring::mesh::Mesh;
use myospring::mesh::thick::from_voxels;
use myospring::mesh::voxels::Voxels;
use std::array::from_fn;

const FILE: &str = "meshes/cell_3D_intracellular.vtk";

/// Side of a voxel, um.
const VOXEL: f64 = 0.25;

/// Springs from each point to where it was at rest.
struct Matrix {
    places: Vectors<3>,
    /// nN/um.
    stiffness: Vec<f64>,
}

impl Force<3> for Matrix {
    fn name(&self) -> &'static str {
        "matrix"
    }

    fn add_forces(&self, at: &Configuration<'_, 3>, forces: &mut Vectors<3>) {
        for axis in 0..3 {
            for (node, stiffness) in self.stiffness.iter().enumerate() {
                forces[axis][node] -=
                    stiffness * (at.positions[axis][node] - self.places[axis][node]);
            }
        }
    }

    fn energy(&self, at: &Configuration<'_, 3>) -> Option<f64> {
        let along = |axis: usize| -> f64 {
            let moved = at.positions[axis].iter().zip(&self.places[axis]);
            moved.zip(&self.stiffness).map(|((x, rest), k)| 0.5 * k * (x - rest).powi(2)).sum()
        };
        Some((0..3).map(along).sum())
    }

    fn add_stiffness(&self, _: &Configuration<'_, 3>, stiffness: &mut StiffnessMatrix<3>) -> bool {
        for (node, &k) in self.stiffness.iter().enumerate() {
            stiffness.add(node, node, from_fn(|i| from_fn(|j| if i == j { k } else { 0.0 })));
        }
        true
    }

    fn is_internal(&self) -> bool {
        false
    }
}

/// The cell as cubes.
struct Cell {
    mesh: Mesh<3, 4>,
    /// Young's modulus, kPa.
    young: f64,
    /// Stiffness of the matrix, kPa/um^2.
    matrix: f64,
}

impl Cell {
    fn made(&self) -> (Body<3>, System<3>) {
        let stiffness = Stiffness::YoungModulus(self.young);
        let material = Material { stiffness, ..of_thick_cell(&default_material()) };
        let fibres = vec![[1.0, 0.0, 0.0]; self.mesh.simplices.len()];
        let (body, mut system) = assemble_thick(
            &self.mesh,
            &material,
            &fibres,
            SupportKind::MassCentre,
            [1.0, 0.0, 0.0],
            LENGTH,
        );
        let stiffness = self.mesh.areas.iter().map(|volume| self.matrix * volume).collect();
        let matrix = Matrix { places: body.positions.clone(), stiffness };
        system.passive.push(Box::new(matrix));
        system.support = Support::Free;
        (body, system)
    }

    /// Mean of Green's fibre strain over the volume, and of the fibre stress by what the matrix does (the virial), kPa.
    fn read(&self, positions: &Vectors<3>) -> [f64; 2] {
        let (mut strain, mut volume) = (0.0, 0.0);
        for simplex in &self.mesh.simplices {
            let corners = simplex.nodes.map(|node| node as usize);
            let edges = |of: &Vectors<3>| -> [[f64; 3]; 3] {
                from_fn(|k| from_fn(|axis| of[axis][corners[k + 1]] - of[axis][corners[0]]))
            };
            let (rest, now) = (edges(&self.mesh.points), edges(positions));
            let across = |k: usize| cross(rest[(k + 1) % 3], rest[(k + 2) % 3]);
            let determinant = dot(rest[0], across(0));
            // F e_x: sum over edges of the edge now times the x component of the dual of the edge at rest.
            let along: [f64; 3] = from_fn(|axis| {
                (0..3).map(|k| now[k][axis] * across(k)[0]).sum::<f64>() / determinant
            });
            let weight = simplex.weight * determinant.abs() / 6.0;
            strain += weight * 0.5 * (dot(along, along) - 1.0);
            volume += weight;
        }
        let pull: f64 = (0..self.mesh.len())
            .map(|node| {
                let (rest, now) = (self.mesh.points[0][node], positions[0][node]);
                -self.matrix * self.mesh.areas[node] * (now - rest) * now
            })
            .sum();
        [strain / volume, pull / volume]
    }

    /// Fits modulus and matrix to strain and stress under a tension; returns the path up to it.
    fn fit(&mut self, top: &Line, tensions: &[f64]) -> Result<Vec<f64>, Failure> {
        for _ in 0..40 {
            let (body, system) = self.made();
            let mut path =
                Path::start(&system, &body, Tolerance::default(), &Interruption::default())?;
            path.extend(top.tension)?;
            let shape =
                |tension| path.positions(tension).ok_or("the path does not reach a tension");
            let [strain, stress] = self.read(&shape(top.tension)?);
            if (strain / top.strain - 1.0).abs() < 1e-5 && (stress / top.stress - 1.0).abs() < 1e-5
            {
                return tensions.iter().map(|&ta| Ok(self.read(&shape(ta.max(0.0))?)[0])).collect();
            }
            self.young *= strain / top.strain;
            self.matrix *= top.stress / stress;
        }
        Err("modulus and matrix were not found in 40 rounds".into())
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    from_fn(|k| {
        let (next, last) = ((k + 1) % 3, (k + 2) % 3);
        a[next] * b[last] - a[last] * b[next]
    })
}

/// The numbers after a word of a legacy VTK file in ASCII.
fn numbers(text: &str, word: &str, skipped: usize) -> Result<Vec<f64>, Failure> {
    let after = text.split_once(word).ok_or_else(|| format!("{FILE} has no {word}"))?.1;
    let tokens = after.split_whitespace().skip(skipped);
    Ok(tokens.map_while(|token| token.parse().ok()).collect())
}

/// What is inside of the tetrahedra.
fn voxels(text: &str) -> Result<Voxels, Failure> {
    // `POINTS count double`, and `CELLS count numbers` of lists that begin with their length.
    let points: Vec<[f64; 3]> = numbers(text, "\nPOINTS", 2)?.as_chunks::<3>().0.to_vec();
    let tetrahedra: Vec<[usize; 4]> = numbers(text, "\nCELLS", 2)?
        .as_chunks::<5>()
        .0
        .iter()
        .filter(|list| list[0] == 4.0)
        .map(|list| from_fn(|k| list[k + 1] as usize))
        .collect();
    let bound = |axis: usize, larger: fn(f64, f64) -> f64| {
        points.iter().map(|point| point[axis]).reduce(larger).unwrap_or(0.0)
    };
    let low: [f64; 3] = from_fn(|axis| bound(axis, f64::min) - VOXEL);
    let size: [usize; 3] =
        from_fn(|axis| ((bound(axis, f64::max) + VOXEL - low[axis]) / VOXEL).ceil() as usize);
    let mut inside = vec![false; size.iter().product()];
    for nodes in tetrahedra {
        let corners = nodes.map(|node| points[node]);
        let edges: [[f64; 3]; 3] =
            from_fn(|k| from_fn(|axis| corners[k + 1][axis] - corners[0][axis]));
        let across: [[f64; 3]; 3] = from_fn(|k| cross(edges[(k + 1) % 3], edges[(k + 2) % 3]));
        let determinant = dot(edges[0], across[0]);
        let range = |axis: usize| {
            let along = corners.map(|corner| corner[axis] - low[axis]);
            let [first, last] = [
                along.iter().copied().fold(f64::INFINITY, f64::min),
                along.iter().copied().fold(0.0, f64::max),
            ];
            (first / VOXEL) as usize..(last / VOXEL) as usize + 1
        };
        for (z, y) in range(2).flat_map(|z| range(1).map(move |y| (z, y))) {
            for x in range(0) {
                let middle: [f64; 3] = from_fn(|axis| {
                    low[axis] + ([x, y, z][axis] as f64 + 0.5) * VOXEL - corners[0][axis]
                });
                let parts = across.map(|across| dot(middle, across) / determinant);
                if parts.iter().all(|part| *part >= 0.0) && parts.iter().sum::<f64>() <= 1.0 {
                    inside[(z * size[1] + y) * size[0] + x] = true;
                }
            }
        }
    }
    Ok(Voxels::new(size, [VOXEL; 3], inside)?)
}

/// The twitch in the plane and in space beside theirs.
///
/// # Errors
/// Files that cannot be read, a strip or a cell without equilibrium.
pub fn rows(setting: &Setting<'_>) -> Result<Vec<Row>, Failure> {
    let mut rows = finite_elements::rows(setting)?;
    if let Some(lines) = finite_elements::lines(setting)? {
        rows.extend(in_space(setting, &lines)?);
    }
    Ok(rows)
}

fn in_space(setting: &Setting<'_>, lines: &[Line]) -> Result<Vec<Row>, Failure> {
    let file = setting.data.join(FILE);
    if !file.exists() {
        let missing = format!("no {FILE} beside the twitch");
        return Ok(vec![Row::skipped("the twitch in space", SOURCE, &missing)]);
    }
    let voxels = voxels(&std::fs::read_to_string(file)?)?;
    let volume = voxels.volume_um3();
    let (_, thick, _) = from_voxels(&voxels, Some(if setting.quick { 4.5 } else { 2.25 }))?;
    let times: Vec<f64> = lines.iter().map(|line| line.time_ms).collect();
    let tensions: Vec<f64> = lines.iter().map(|line| line.tension).collect();
    let most = tensions.iter().copied().fold(0.0, f64::max);
    let top = lines.iter().find(|line| line.tension == most).ok_or("no line at all")?;
    let mut cell = Cell { mesh: thick.mesh, young: 900.0, matrix: 0.01 };
    let strains = cell.fit(top, &tensions)?;
    let shortening = |strains: &[f64]| -> Vec<f64> {
        strains.iter().map(|strain| 100.0 * (1.0 - (1.0 + 2.0 * strain).sqrt())).collect()
    };
    let ours = shortening(&strains);
    let theirs = shortening(&lines.iter().map(|line| line.strain).collect::<Vec<_>>());
    let (them, us) = (timing(&times, &theirs)?, timing(&times, &ours)?);
    let law = "as for the strip: their material is exponential, ours nearly Hookean, in space as in the plane";
    Ok(vec![
        Row::about(
            "the finite elements' own cell as voxels: volume",
            "what its authors state",
            volume,
            VOLUME,
            0.005 * VOLUME,
            "um^3",
            format!("voxels of {VOXEL} um"),
        ),
        Row::about(
            "its twitch in space: time of the peak of shortening",
            SOURCE,
            us[0],
            them[0],
            1.0,
            "ms",
            format!(
                "one sample is 1 ms; {} points; ours: E = {:.0} kPa fitted to their peak strain, matrix {:.4} kPa/um^2 to their \
                 peak stress of {:.2} kPa",
                cell.mesh.len(),
                cell.young,
                cell.matrix,
                top.stress
            ),
        ),
        Row::noted("the same: half of the peak, rising", SOURCE, us[1], them[1], "ms", law),
        Row::noted("the same: half of the peak, falling", SOURCE, us[2], them[2], "ms", law),
        Row::noted(
            "the same: largest difference of the shortening, each over its peak",
            SOURCE,
            apart(&ours, &theirs),
            0.0,
            "",
            law,
        ),
    ])
}
