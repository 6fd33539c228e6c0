//! The engine of the page: Myospring's experiments as WebAssembly.
//!
//! The page asks and the [`Engine`] answers, both in JSON: `requests.d.ts` in the page's source has the types. The engine runs in a worker of
//! the page. A worker that is stopped takes its engine with it, so the page keeps all that a new engine needs.
//!
//! `exports` are the functions of the WebAssembly module: plain numbers and bytes, so nothing but the compiler is needed to
//! make it. `cargo xtask web` makes it, and the program of this crate puts the page around it.

mod about;
mod cells;
mod engine;
mod exports;
mod progress;
mod request;
mod traction;

pub use engine::Engine;
