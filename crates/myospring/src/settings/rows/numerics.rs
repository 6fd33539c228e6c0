//! `[numerics]`.

use super::super::bounds::Bounds;
use super::super::setting::{Setting, ValueKind};
use super::super::words::{Word, Worded, choose, worded};
use crate::integrate::Method;
use crate::integrate::engine::Loops;
use crate::integrate::verlet::Integrator;
use crate::units::Dimension;

/// How the shape follows the tension.
#[derive(Clone, Copy)]
enum IntegratorName {
    Verlet,
    StoermerVerlet,
    VelocityVerlet,
    QuasiStatic,
}

worded! { IntegratorName {
    IntegratorName::Verlet = "verlet":
        "In time, by the paper's form of Verlet's method: the same as \"stoermer-verlet\".",
    IntegratorName::StoermerVerlet = "stoermer-verlet": "Stoermer-Verlet, the paper's Eq. (16).",
    IntegratorName::VelocityVerlet = "velocity-verlet":
        "Velocity Verlet: the same positions except for rounding.",
    IntegratorName::QuasiStatic = "quasi-static":
        "Along the path of equilibria: fast, for tension along the fibre and the area law \
         \"gradient\".",
} }

worded! { Loops {
    Loops::Auto = "auto": "The fused kernel if it supports the run, else the plain loops.",
    Loops::Plain = "plain":
        "Plain loops over all laws: any mesh, force, tension and form of Verlet's method.",
    Loops::Fused = "fused": "The fused kernel of a lattice; an error if it does not support the run.",
} }

pub(super) const ROWS: &[Setting] = &[
    Setting::new(
        "numerics.integrator",
        "How the shape follows the tension: in time by Verlet's method (\"verlet\" is \
         the paper's form), or along its equilibria.",
        ValueKind::Words {
            words: IntegratorName::WORDS,
            get: |run| Some(name(run.numerics.method).word()),
            set: |run, word| {
                run.numerics.method = method(IntegratorName::of_word(word)?);
                Some(())
            },
        },
    )
    .otherwise("verlet, or quasi-static on a gel")
    .option_saying(
        "--integrator",
        "NAME",
        "verlet (in time, as in the paper) or quasi-static (along the equilibria, many times \
         faster); also stoermer-verlet, velocity-verlet",
    ),
    Setting::new(
        "numerics.engine",
        "Implementation of the integrator in time; an unsupported one is an error, and run.json states the one used.",
        ValueKind::Words {
            words: Loops::WORDS,
            get: |run| Some(run.numerics.engine.loops.word()),
            set: |run, word| choose(&mut run.numerics.engine.loops, word),
        },
    )
    .option_saying(
        "--engine",
        "NAME",
        "Implementation of the integrator in time: auto (the fused kernel if possible), plain, or fused, which is an error \
         if it is not possible",
    ),
    Setting::quantity(
        "numerics.time_step",
        "Mechanical time step; a step above the stability limit is an error. Not for \
         \"quasi-static\".",
        Bounds::any(Dimension::Time, "0.004 ms").from(1e-7).to(10.0),
        |run| run.numerics.time_step,
        |run, step| run.numerics.time_step = Some(step),
    )
    .otherwise("0.95 of the stability limit")
    .option_saying("--time-step", "TIME", "Mechanical time step of Verlet's method"),
    Setting::quantity(
        "numerics.exchange_interval",
        "Interval at which cell model and mesh exchange tension and stretch.",
        Bounds::any(Dimension::Time, "0.25 ms").from(1e-3).to(10.0),
        |run| Some(run.numerics.exchange_interval),
        |run, interval| run.numerics.exchange_interval = interval,
    ),
    Setting::quantity(
        "numerics.output_interval",
        "Interval of the rows in traces.csv, a multiple of the exchange interval.",
        Bounds::any(Dimension::Time, "0.5 ms").from(1e-3).to(1e4),
        |run| Some(run.numerics.output_interval),
        |run, interval| run.numerics.output_interval = interval,
    ),
    Setting::quantity(
        "numerics.frame_interval",
        "Interval of the recorded shapes, from which films, ParaView's files and frames.npz are made; a multiple of \
         the output interval.",
        Bounds::any(Dimension::Time, "5 ms").from(1e-3).to(1e5),
        |run| Some(run.numerics.frame_interval),
        |run, interval| run.numerics.frame_interval = interval,
    )
    .option_saying(
        "--frame-interval",
        "TIME",
        "Interval of the shapes in films, ParaView's files and frames.npz, a multiple of 0.5 ms",
    ),
];

fn name(method: Method) -> IntegratorName {
    match method {
        Method::Verlet(Integrator::StoermerVerlet) => IntegratorName::Verlet,
        Method::Verlet(Integrator::VelocityVerlet) => IntegratorName::VelocityVerlet,
        Method::QuasiStatic => IntegratorName::QuasiStatic,
    }
}

fn method(name: IntegratorName) -> Method {
    match name {
        IntegratorName::Verlet | IntegratorName::StoermerVerlet => {
            Method::Verlet(Integrator::StoermerVerlet)
        }
        IntegratorName::VelocityVerlet => Method::Verlet(Integrator::VelocityVerlet),
        IntegratorName::QuasiStatic => Method::QuasiStatic,
    }
}
