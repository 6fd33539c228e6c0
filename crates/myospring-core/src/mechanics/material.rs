//! The cell's material: user parameters, and the resulting spring constants.
//!
//! A square lattice of spacing h with springs to all eight neighbours is an isotropic sheet with
//! Young's modulus `E`, thickness `w` and in-plane Poisson ratio 1/3 when
//!
//! ```text
//! k_axial = (3/4) E w        k_diagonal = (3/8) E w
//! ```
//!
//! independent of h, so a finer mesh gives the same cell. A spring on the rim borders on one
//! lattice square instead of two, and has half of this.
//!
//! A lattice of cubes of spacing h with the same stiffness of sides and face diagonals, and a volume energy per cube, is an
//! isotropic solid with Young's modulus `E` and Poisson's ratio `nu` from 1/4 on when
//!
//! ```text
//! k = mu h        kappa = lambda - mu        mu = E/(2 (1 + nu)),  lambda = E nu/((1 + nu)(1 - 2 nu))
//! ```
//!
//! Density is a numerical parameter. The real one (1e-6 ug/um^3) would require time steps of about
//! 1e-5 ms. Since a contraction is quasi-static, its result does not depend on the mass as long as
//! the slowest vibration, of period `T = 2 L sqrt(rho/E)`, is fast compared with the twitch. So the
//! user states `T`, and `rho = E (T / 2 L)^2` follows.

use super::active::{ActiveLaw, EndTension, FibreTension, Myofibrils};
use super::area::{AreaLaw, AreaPreservation};
use super::drag::Drag;
use super::fibre_stiffness::FibreStiffness;
use super::gel::GelBed;
use super::spring::Springs;
use super::support::{Attachment, Support, SupportKind};
use super::volume::VolumePreservation;
use super::{Body, Force, System};
use crate::mesh::cubes::TETRAHEDRA_OF_A_CUBE;
use crate::mesh::{Mesh, Spring, SpringKind};
use serde::Serialize;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// Stiffness of the lattice.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stiffness {
    /// Young's modulus of the sheet, kPa.
    YoungModulus(f64),
    /// Stiffness of an axial spring inside the cell, nN/um; a diagonal one has half of it.
    Spring(f64),
}

/// Passive properties of the cell, in internal units.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Material {
    /// Stiffness of the lattice.
    pub stiffness: Stiffness,
    /// Thickness of the cell, um.
    pub thickness: f64,
    /// Law of area preservation.
    pub area_law: AreaLaw,
    /// Area modulus, kPa: the stiffness of the area law per thickness. A thick cell keeps its volume instead.
    pub area_modulus: f64,
    /// Poisson's ratio of a thick cell, from 1/4, that of springs alone, to below 1/2.
    pub poisson_ratio: f64,
    /// What the fibres add to the modulus along themselves, kPa.
    pub fibre_modulus: f64,
    /// Ratio xi of the axial dashpots to critical damping, Eq. (9); dimensionless.
    pub damping_ratio: f64,
    /// Period of the slowest vibration along the cell, ms; sets the (numerical) density. `None`: a run in time takes the longest
    /// with which it lags little behind its equilibria, and anything else 2 ms.
    pub slowest_period: Option<f64>,
    /// Damping ratio of that slowest vibration by drag; dimensionless.
    pub drag_ratio: f64,
    /// Retardation time tau of the cell as a Kelvin-Voigt solid, ms: its viscous forces are tau
    /// times the rate of its elastic ones. Only along the path of equilibria; 0 for none.
    pub retardation_time: f64,
}

/// Period of the slowest vibration where nothing speaks for another, ms.
pub(crate) const USUAL_PERIOD: f64 = 2.0;

/// The default material: shortening 12 % at 50 kPa on the built-in cell (`coelho_2021`, Fig. 6) and
/// the widening that conserves the cell's volume.
///
/// Young's modulus and area modulus are fitted to these two targets; the thickness of 10 um is half
/// of a myocyte's width. The other values are numerical: see [`Material`].
pub fn default_material() -> Material {
    Material {
        stiffness: Stiffness::YoungModulus(308.0),
        thickness: 10.0,
        area_law: AreaLaw::Gradient,
        area_modulus: 175.0,
        poisson_ratio: 0.49,
        fibre_modulus: 0.0,
        damping_ratio: 0.05,
        slowest_period: None,
        drag_ratio: 0.3,
        retardation_time: 0.0,
    }
}

/// The default material for myofilaments that depend on length and give their tension in kPa: both
/// moduli are reduced by one factor, so that the unloaded twitch of `land_2017` shortens the
/// built-in cell by about 10 %, as measured cells do.
///
/// That tension has its peak near 12 kPa in a free cell, not 50. The factor is 100.6/348.6: the
/// modulus of a block of Poisson's ratio 0.49 that shortens 9.9 % under these myofilaments, divided
/// by that of one that shortens 12 % at 50 kPa.
pub fn myofilament_material() -> Material {
    const SOFTER: f64 = 100.6 / 348.6;
    let usual = default_material();
    Material {
        // Rounded to one decimal.
        stiffness: Stiffness::YoungModulus((usual.young_modulus() * SOFTER * 10.0).round() / 10.0),
        area_modulus: (usual.area_modulus * SOFTER * 10.0).round() / 10.0,
        ..usual
    }
}

/// As a material, for a thick cell: Young's modulus such that the default material shortens by 12 % at 50 kPa, too.
///
/// The modulus of the default material of a flat cell times 348.6/308: the modulus of a block of Poisson's ratio 0.49 over that of a
/// sheet, both fitted to that shortening. A stated spring stiffness stays.
#[must_use]
pub fn of_thick_cell(material: &Material) -> Material {
    const STIFFER: f64 = 348.6 / 308.0;
    let stiffness = match material.stiffness {
        // Rounded to one decimal.
        Stiffness::YoungModulus(modulus) => {
            Stiffness::YoungModulus((modulus * STIFFER * 10.0).round() / 10.0)
        }
        Stiffness::Spring(spring) => Stiffness::Spring(spring),
    };
    Material { stiffness, ..material.clone() }
}

impl Material {
    /// Multiplies every elastic constant of the cell itself.
    pub fn stiffen(&mut self, by: f64) {
        self.stiffness = match self.stiffness {
            Stiffness::YoungModulus(modulus) => Stiffness::YoungModulus(by * modulus),
            Stiffness::Spring(stiffness) => Stiffness::Spring(by * stiffness),
        };
        self.area_modulus *= by;
        self.fibre_modulus *= by;
    }

    /// Young's modulus of the sheet, kPa.
    pub fn young_modulus(&self) -> f64 {
        match self.stiffness {
            Stiffness::YoungModulus(modulus) => modulus,
            Stiffness::Spring(stiffness) => stiffness / (0.75 * self.thickness),
        }
    }

    /// Critical tension of end loads for in-plane buckling of a strip of this length and width (um)
    /// (Euler, free ends), kPa: `E (pi^2/12) (width/length)^2`.
    pub fn buckling_tension(&self, length: f64, width: f64) -> f64 {
        self.young_modulus() * PI * PI / 12.0 * (width / length).powi(2)
    }

    /// Period of the slowest vibration, ms: that which is set, or the usual one.
    fn period(&self) -> f64 {
        self.slowest_period.unwrap_or(USUAL_PERIOD)
    }

    /// Numerical density for a cell of this length (um), ug/um^3.
    pub fn density(&self, length: f64) -> f64 {
        self.young_modulus() * (self.period() / (2.0 * length)).powi(2)
    }

    /// Stiffness of a full spring, nN/um.
    pub fn spring_stiffness(&self, kind: SpringKind) -> f64 {
        // k_1 = (3/4) E w, k_2 = (3/8) E w
        let axial = 0.75 * self.young_modulus() * self.thickness;
        match kind {
            SpringKind::Axial => axial,
            SpringKind::Diagonal => 0.5 * axial,
        }
    }

    /// Shear modulus `mu = E/(2 (1 + nu))` of a thick cell, kPa.
    pub fn shear_modulus(&self) -> f64 {
        self.young_modulus() / (2.0 * (1.0 + self.poisson_ratio))
    }

    /// Volume modulus of a thick cell, kPa: `lambda - mu`, since springs have `lambda = mu`.
    pub fn volume_modulus(&self) -> f64 {
        let nu = self.poisson_ratio;
        // lambda = E nu/((1 + nu)(1 - 2 nu))
        let lambda = self.young_modulus() * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
        (lambda - self.shear_modulus()).max(0.0)
    }

    /// The springs of a mesh, with dashpots `c = xi 2 sqrt(k m)`, Eqs (9) and (11); m is the mean
    /// of the two masses.
    pub fn springs<const D: usize, const N: usize>(
        &self,
        mesh: &Mesh<D, N>,
        masses: &[f64],
    ) -> Springs {
        let nodes: Vec<[u32; 2]> = mesh.springs.iter().map(|spring| spring.nodes).collect();
        let length = |pair: &[u32; 2]| {
            let [a, b] = pair.map(|node| node as usize);
            let parts = mesh.points.iter().map(|x| x[b] - x[a]);
            parts.reduce(f64::hypot).map_or(0.0, f64::abs)
        };
        let rest_length: Vec<f64> = nodes.iter().map(length).collect();
        let full = |spring: &Spring, length: f64| match (D, spring.kind) {
            (2, kind) => self.spring_stiffness(kind),
            // k_1 = k_2 = mu h
            (_, SpringKind::Axial) => self.shear_modulus() * length,
            (_, SpringKind::Diagonal) => self.shear_modulus() * length * FRAC_1_SQRT_2,
        };
        let springs = mesh.springs.iter().zip(&rest_length);
        let stiffness: Vec<f64> =
            springs.map(|(spring, length)| spring.share * full(spring, *length)).collect();
        let damping = nodes
            .iter()
            .zip(&stiffness)
            .map(|(pair, stiffness)| {
                let mass = 0.5 * (masses[pair[0] as usize] + masses[pair[1] as usize]);
                self.damping_ratio * 2.0 * (stiffness * mass).sqrt()
            })
            .collect();
        Springs::new(nodes, stiffness, rest_length, damping)
    }
}

/// Makes a body at rest and all forces on it.
///
/// `axis` is the cell's long axis, `length` (um) its length along it, `fibres` one unit vector per
/// triangle, or the [`Myofibrils`] with their content, `support` the support, or the [`Attachment`] with where the cell
/// adheres.
///
/// # Panics
/// If the support is a gel that does not fit the mesh; see [`Gel::check`](super::gel::Gel::check).
pub fn assemble<'a>(
    mesh: &Mesh,
    material: &Material,
    active: ActiveLaw,
    fibres: impl Into<Myofibrils<'a>>,
    support: impl Into<Attachment<'a>>,
    axis: [f64; 2],
    length: f64,
) -> (Body, System) {
    let (fibres, thickness) = (fibres.into(), material.thickness);
    let area = AreaPreservation::new(mesh, material.area_law, material.area_modulus * thickness);
    let active: Box<dyn Force> = match active {
        ActiveLaw::Fibre => Box::new(FibreTension::new(mesh, fibres, thickness)),
        ActiveLaw::Ends => Box::new(EndTension::new(mesh, axis, thickness)),
    };
    let laws: [Box<dyn Force>; 2] = [Box::new(area), active];
    joined(mesh, material, fibres, support.into(), axis, [length, thickness], laws)
}

/// As [`assemble`], for a thick cell of cubes, whose long axis is in the plane of the first two axes.
///
/// # Panics
/// As [`assemble`].
pub fn assemble_thick<'a>(
    mesh: &Mesh<3, 4>,
    material: &Material,
    fibres: impl Into<Myofibrils<'a, 3>>,
    support: impl Into<Attachment<'a>>,
    axis: [f64; 3],
    length: f64,
) -> (Body<3>, System<3>) {
    let fibres = fibres.into();
    let volume = VolumePreservation::new(mesh, TETRAHEDRA_OF_A_CUBE, material.volume_modulus());
    let active = FibreTension::new(mesh, fibres, 1.0);
    let laws: [Box<dyn Force<3>>; 2] = [Box::new(volume), Box::new(active)];
    joined(mesh, material, fibres, support.into(), axis, [length, 1.0], laws)
}

/// The body at rest, with springs, what keeps its area or volume, the stiffness of its fibres, its active force, drag and support.
fn joined<const D: usize, const N: usize>(
    mesh: &Mesh<D, N>,
    material: &Material,
    fibres: Myofibrils<'_, D>,
    Attachment { support, adhesion }: Attachment<'_>,
    axis: [f64; D],
    [length, thickness]: [f64; 2],
    [keeping, active]: [Box<dyn Force<D>>; 2],
) -> (Body<D>, System<D>) {
    let body = Body::at_rest(mesh, material.density(length), thickness);
    let drag = Drag::of_slowest_mode(material.period(), material.drag_ratio, &body.masses);
    let mut passive: Vec<Box<dyn Force<D>>> =
        vec![Box::new(material.springs(mesh, &body.masses)), keeping];
    if let Some(anchors) = support.anchors(mesh, axis) {
        passive.push(Box::new(anchors));
    }
    if let SupportKind::Gel(gel) = support {
        match GelBed::adhering(gel, mesh, axis, adhesion) {
            Ok(bed) => passive.push(Box::new(bed)),
            Err(error) => panic!("{error}"),
        }
    }
    if material.fibre_modulus > 0.0 {
        let modulus = material.fibre_modulus;
        passive.push(Box::new(FibreStiffness::new(mesh, fibres, modulus, thickness)));
    }
    let support = Support::new(support, mesh, axis);
    (body, System { passive, active: vec![active], drag, support })
}
