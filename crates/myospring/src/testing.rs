//! Conformance suites for what others supply. Each check panics with what is wrong, for use in tests.

pub mod cell_model;
