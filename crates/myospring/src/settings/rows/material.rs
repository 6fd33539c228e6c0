//! `[material]`.

use super::super::bounds::Bounds;
use super::super::setting::{Setting, ValueKind};
use super::super::words::{Word, Worded, choose, worded};
use crate::mechanics::area::AreaLaw;
use crate::mechanics::material::Stiffness;
use crate::units::Dimension;

worded! { AreaLaw {
    AreaLaw::Gradient = "gradient":
        "Minus the gradient of an energy of the area's deviation from rest.",
    AreaLaw::Barycentric = "barycentric":
        "Towards the barycentre, proportional to the area's deviation from rest.",
    AreaLaw::Printed = "printed":
        "Exactly the paper's Eq. (13), absolute area and all; for comparison only.",
} }

pub(super) const ROWS: &[Setting] = &[
    Setting::quantity(
        "material.young_modulus",
        "Young's modulus of the sheet formed by the springs, or of the solid of a thick cell.",
        Bounds::any(Dimension::Pressure, "308 kPa").from(0.1).to(1e6),
        |run| match run.material.stiffness {
            Stiffness::YoungModulus(modulus) => Some(modulus),
            Stiffness::Spring(_) => None,
        },
        |run, modulus| run.material.stiffness = Stiffness::YoungModulus(modulus),
    )
    .option_saying("--young-modulus", "MODULUS", "Young's modulus"),
    Setting::quantity(
        "material.spring_stiffness",
        "Stiffness of a horizontal or vertical spring, instead of `young_modulus`; a diagonal \
         one has half of it.",
        Bounds::any(Dimension::Stiffness, "2310 nN/um").from(0.1).to(1e8),
        |run| match run.material.stiffness {
            Stiffness::YoungModulus(_) => None,
            Stiffness::Spring(stiffness) => Some(stiffness),
        },
        |run, stiffness| run.material.stiffness = Stiffness::Spring(stiffness),
    ),
    Setting::quantity(
        "material.thickness",
        "Thickness of the cell; where it varies, the greatest.",
        Bounds::any(Dimension::Length, "10 um").above(0.0).to(5000.0),
        |run| run.shape.slices().is_none().then_some(run.material.thickness),
        |run, thickness| {
            run.material.thickness = thickness;
            if let Some(form) = &mut run.shape.form {
                form.thickness = thickness;
            }
        },
    )
    .option("--thickness", "LENGTH"),
    Setting::new(
        "material.area_law",
        "Law of area preservation.",
        ValueKind::Words {
            words: AreaLaw::WORDS,
            get: |run| (!run.shape.is_thick()).then(|| run.material.area_law.word()),
            set: |run, word| choose(&mut run.material.area_law, word),
        },
    )
    .option("--area-law", "LAW"),
    Setting::quantity(
        "material.area_modulus",
        "Stiffness of the area law per thickness.",
        Bounds::any(Dimension::Pressure, "175 kPa").from(0.0).to(1e6),
        |run| (!run.shape.is_thick()).then_some(run.material.area_modulus),
        |run, modulus| run.material.area_modulus = modulus,
    ),
    Setting::quantity(
        "material.poisson_ratio",
        "Poisson's ratio of a thick cell. Near 0.5 it keeps its volume; 0.25 is that of springs alone. A flat cell has `area_modulus` \
         instead.",
        Bounds::any(Dimension::Number, "0.49").from(0.25).to(0.499),
        |run| run.shape.is_thick().then_some(run.material.poisson_ratio),
        |run, ratio| run.material.poisson_ratio = ratio,
    )
    .otherwise("0.49"),
    Setting::quantity(
        "material.fibre_modulus",
        "What the fibres add to Young's modulus along themselves.",
        Bounds::any(Dimension::Pressure, "100 kPa").from(0.0).to(1e6),
        |run| Some(run.material.fibre_modulus),
        |run, modulus| run.material.fibre_modulus = modulus,
    ),
    Setting::quantity(
        "material.damping_ratio",
        "Dashpots along the springs, as a part of critical damping.",
        Bounds::any(Dimension::Number, "0.05").from(0.0).to(10.0),
        |run| Some(run.material.damping_ratio),
        |run, ratio| run.material.damping_ratio = ratio,
    ),
    Setting::quantity(
        "material.slowest_period",
        "Period of the slowest vibration along the cell; sets the numerical density. Unless it is set, a run in time takes \
         the longest from 2 to 8 ms with which its shortening lags by at most 1 % of its peak.",
        Bounds::any(Dimension::Time, "2 ms").from(0.01).to(100.0),
        |run| run.material.slowest_period,
        |run, period| run.material.slowest_period = Some(period),
    ),
    Setting::quantity(
        "material.drag_ratio",
        "Damping of that vibration by drag, as a part of critical damping.",
        Bounds::any(Dimension::Number, "0.3").from(0.0).to(100.0),
        |run| Some(run.material.drag_ratio),
        |run, ratio| run.material.drag_ratio = ratio,
    ),
    Setting::quantity(
        "material.retardation_time",
        "Viscosity of the cell divided by its Young's modulus (Kelvin-Voigt): the time by which its shape lags behind its \
         tension. Quasi-static runs only.",
        Bounds::any(Dimension::Time, "20 ms").from(0.0).to(1000.0),
        |run| Some(run.material.retardation_time),
        |run, time| run.material.retardation_time = time,
    )
    .option("--retardation-time", "TIME"),
];
