//! The program `myospring`.
fn main() {}
