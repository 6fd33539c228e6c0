//! The files that the program reads.

use myospring::experiment::Files;
use std::sync::LazyLock;

/// Reads every file, so that no result replaces one.
pub(crate) static FILES: LazyLock<Files> = LazyLock::new(Files::default);
