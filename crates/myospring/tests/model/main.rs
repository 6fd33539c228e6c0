//! The model, from units to beats: what needs none of the library's features but `testing`.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/noise.rs"]
mod noise;

mod afterload;
mod architecture;
mod beat;
mod block;
mod cell_adaptive;
mod cell_bueno_orovio_2008;
mod cell_coelho_2021;
mod cell_derivatives;
mod cell_population;
mod cell_solver;
mod checks;
mod curves;
mod exchange;
mod gel;
mod interruption;
mod land_2017;
mod mechanics;
mod mesh;
mod outline;
mod own_model;
mod paired_curves;
mod parts;
mod quasi_static;
mod rhythm;
mod s1_s2;
mod shared_runs;
mod solid;
mod supports;
mod thick;
#[cfg(feature = "run-file")]
mod tissue;
mod tor_ord;
mod upstroke;
mod viscosity;
