//! The table: one row per setting, one file per table of a run file.

mod cell;
mod material;
mod mechanics;
mod numerics;
mod segmentation;
mod shape;
mod stimulus;
mod tissue;

use super::bounds::Bounds;
use super::setting::{Setting, ValueKind};
use crate::units::Dimension;

/// Settings that belong together.
#[derive(Debug, Clone, Copy)]
pub struct Table {
    /// Name of the table in a run file; empty for the top level.
    pub name: &'static str,
    /// Description of its settings, in a sentence.
    pub doc: &'static str,
    /// Heading of its options in the help of the program.
    pub heading: &'static str,
    /// The settings, in the order in which they are shown and applied to a run.
    pub settings: &'static [Setting],
}

const MATERIAL: &str = "Material and mechanics";
const CELL: &str = "Cell model and stimulus";
const NUMERICS: &str = "Numerics";

pub(super) static TABLES: &[Table] = &[
    Table {
        name: "",
        doc: "",
        heading: "",
        settings: &[Setting::new(
            "title",
            "Title of the run, for people.",
            ValueKind::Text {
                get: |run| Some(run.title.clone()),
                set: |run, title| {
                    title.clone_into(&mut run.title);
                    Ok(())
                },
            },
        )],
    },
    Table {
        name: "cell",
        doc: "The cell model: action potential and active tension.",
        heading: CELL,
        settings: cell::ROWS,
    },
    Table {
        name: "stimulus",
        doc: "When and how the cell is stimulated.",
        heading: CELL,
        settings: stimulus::ROWS,
    },
    Table {
        name: "tissue",
        doc: "A tissue: cells that stimulate each other, one at each point of the mesh, instead of one cell.",
        heading: "Tissue",
        settings: tissue::ROWS,
    },
    Table {
        name: "shape",
        doc: "The cell's shape: one of `built_in`, `picture`, `outline`.",
        heading: "Shape",
        settings: shape::ROWS,
    },
    Table {
        name: "segmentation",
        doc: "How the cell is found in a picture; without effect without a picture.",
        heading: "Finding the cell in a picture",
        settings: segmentation::ROWS,
    },
    Table {
        name: "material",
        doc: "Passive properties of the cell.",
        heading: MATERIAL,
        settings: material::ROWS,
    },
    Table {
        name: "mechanics",
        doc: "How the tension acts, and the support of the cell.",
        heading: MATERIAL,
        settings: mechanics::ROWS,
    },
    Table {
        name: "numerics",
        doc: "Numerical settings; the defaults give a converged beat.",
        heading: NUMERICS,
        settings: numerics::ROWS,
    },
    Table {
        name: "run",
        doc: "The run.",
        heading: NUMERICS,
        settings: &[Setting::quantity(
            "run.duration",
            "Time simulated, a multiple of the exchange interval.",
            Bounds::any(Dimension::Time, "600 ms").above(0.0).to(1e6),
            |run| Some(run.duration),
            |run, duration| run.duration = duration,
        )
        .otherwise("550 ms after the last stimulus")
        .option_saying("--duration", "TIME", "Time simulated")],
    },
];
