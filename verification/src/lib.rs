//! Our side of the comparisons of Myospring with closed forms and with programs we did not write.
//!
//! Each file holds one check: what is computed, the closed form or the other program, the tolerance
//! and its reason. A check gives [`row::Row`]s; `cargo xtask verify` runs all of them, lets the Python
//! scripts in `verification/python` run the other programs, and makes `docs/reference/verification.md`.
//! The checks use the public interface of the library only, so they hold for whatever computes behind
//! it.

pub mod beat;
pub mod chain;
mod check;
pub mod conservation;
pub mod convergence;
pub mod engine;
pub mod finite_elements;
pub mod fit;
pub mod gel;
pub mod lammps;
pub mod land;
pub mod loads;
pub mod motion;
pub mod myokit;
pub mod oscillator;
pub mod parts;
pub mod patch;
pub mod random;
pub mod row;
pub mod sarcomeres;
pub mod thick;
pub mod time_order;
pub mod tissue;
pub mod tor_ord;
pub mod twitch_in_space;
pub mod viscosity;
pub mod wave;

pub use check::{Check, Failure, Setting, published_data};

/// Every check, in the order of the table.
pub fn checks() -> Vec<Check> {
    vec![
        Check { name: "oscillator", run: oscillator::rows },
        Check { name: "time-order", run: time_order::rows },
        Check { name: "chain", run: chain::rows },
        Check { name: "wave", run: wave::rows },
        Check { name: "patch", run: patch::rows },
        Check { name: "conservation", run: conservation::rows },
        Check { name: "beat", run: beat::rows },
        Check { name: "convergence", run: convergence::rows },
        Check { name: "lammps", run: lammps::write },
        Check { name: "myokit", run: myokit::write },
        Check { name: "land", run: land::rows },
        Check { name: "tor-ord", run: tor_ord::rows },
        Check { name: "loads", run: loads::rows },
        Check { name: "gel", run: gel::rows },
        Check { name: "thick", run: thick::rows },
        Check { name: "tissue", run: tissue::rows },
        Check { name: "viscosity", run: viscosity::rows },
        Check { name: "parts", run: parts::rows },
        Check { name: "finite-elements", run: twitch_in_space::rows },
        Check { name: "sarcomeres", run: sarcomeres::rows },
        Check { name: "motion", run: motion::rows },
    ]
}
