//! Puts the page around its engine: `myospring-web ENGINE.wasm UNPACK.wasm PAGE.html`; `cargo xtask web` runs it.

use myospring::output::page;
use std::error::Error;
use std::fs;

/// The tutorial for students, whose steps are the tour of the page.
const TOUR: &str = include_str!("../../../docs/tutorials/six-questions.md");

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [engine, unpacker, target] = &arguments[..] else {
        return Err(
            "give the engine (.wasm), what unpacks it (.wasm) and the page (.html) to write".into(),
        );
    };
    let packed = packed(&fs::read(engine)?)?;
    Ok(fs::write(target, page::around_engine(&packed, &fs::read(unpacker)?, TOUR))?)
}

/// As a `.lzma` file.
#[cfg(not(target_arch = "wasm32"))]
fn packed(bytes: &[u8]) -> std::io::Result<Vec<u8>> {
    use lzma_rust2::{LzmaOptions, LzmaWriter};
    use std::io::Write as _;
    let options =
        LzmaOptions { nice_len: LzmaOptions::NICE_LEN_MAX, ..LzmaOptions::with_preset(9) };
    let mut writer = LzmaWriter::new_use_header(Vec::new(), &options, Some(bytes.len() as u64))?;
    writer.write_all(bytes)?;
    writer.finish()
}

/// A browser makes no page.
#[cfg(target_arch = "wasm32")]
fn packed(_: &[u8]) -> std::io::Result<Vec<u8>> {
    Err(std::io::ErrorKind::Unsupported.into())
}

#[cfg(test)]
mod tests {
    #[test]
    fn what_is_packed_is_unpacked_by_the_page() {
        let bytes: Vec<u8> = (0..100_000_u32).map(|k| (k % 251 * (k / 977)) as u8).collect();
        let packed = super::packed(&bytes).unwrap();
        assert!(packed.len() < bytes.len());
        assert_eq!(myospring_unpack::unpacked(&packed).unwrap(), bytes);
    }
}
