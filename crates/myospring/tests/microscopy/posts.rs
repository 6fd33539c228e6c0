//! Posts in made-up films with known motion, and in real ones.

mod errors;
mod found;
mod made_up;
mod real;
mod stated;
