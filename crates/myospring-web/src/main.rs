//! Puts the page around its engine: `myospring-web ENGINE.wasm PAGE.html`; `cargo xtask web` runs it.

use myospring::output::page;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(engine), Some(target)) = (arguments.next(), arguments.next()) else {
        return Err("give the engine (.wasm) and the page (.html) to write".into());
    };
    Ok(std::fs::write(target, page::around_engine(&std::fs::read(engine)?)?)?)
}
