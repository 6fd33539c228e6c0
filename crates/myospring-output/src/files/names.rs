//! File names that are the same in every folder of results.

/// Name of the list of a folder's files and their hashes. Its lines are those of `sha256sum`, so `sha256sum -c myospring.sha256` checks results.
pub const MANIFEST: &str = "myospring.sha256";
