//! The model is in `tests/claims.rs`.
