//! `cargo xtask web`: the page, one HTML file with the engine inside.

use crate::tools::{cargo, root, say, step, target};
use std::path::PathBuf;
use std::process::Command;

const TARGET: &str = "wasm32-unknown-unknown";
/// The largest page that is shipped, bytes.
const LARGEST: u64 = 4_000_000;

/// Builds the engine and the page around it, `target/web/myospring.html`, and says how large it is.
pub(crate) fn run() -> Result<(), String> {
    toolchain()?;
    let around = cargo(["run", "--quiet", "-p", "myospring-web", "--locked", "--"]);
    step("the engine", engine("web"))?;
    let (_, page) = page("web", around)?;
    let size = std::fs::metadata(&page).map_or(0, |file| file.len());
    say(&format!("{}: {:.2} MB\n", page.display(), size as f64 / 1e6));
    if size > LARGEST {
        let most = LARGEST as f64 / 1e6;
        return Err(format!(
            "the page is larger than {most} MB, which is too much to send by mail or open on a phone"
        ));
    }
    Ok(())
}

/// Makes sure that the compiler makes WebAssembly; the error says what is missing and how to get it.
pub(crate) fn toolchain() -> Result<(), String> {
    if is_there() {
        return Ok(());
    }
    say(&format!("\n== the compiler's target {TARGET}, from rustup\n"));
    let added = Command::new("rustup").args(["target", "add", TARGET]).current_dir(root()).status();
    if added.is_ok_and(|status| status.success()) && is_there() {
        return Ok(());
    }
    Err(format!("the compiler lacks the target: `rustup target add {TARGET}`"))
}

fn is_there() -> bool {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let mut ask = Command::new(rustc);
    ask.args(["--print", "target-libdir", "--target", TARGET]).current_dir(root());
    ask.output()
        .is_ok_and(|output| PathBuf::from(String::from_utf8_lossy(&output.stdout).trim()).is_dir())
}

/// The command that builds the engine by a profile.
pub(crate) fn engine(profile: &str) -> Command {
    let mut command =
        cargo(["build", "-p", "myospring-web", "-p", "myospring-unpack", "--lib", "--locked"]);
    command.args(["--profile", profile, "--target", TARGET]);
    command
}

/// Builds by the program `around` the page around the engine, which was built by a profile; gives where both are.
pub(crate) fn page(profile: &str, mut around: Command) -> Result<(PathBuf, PathBuf), String> {
    let made = |name: &str| target().join(TARGET).join(profile).join(name);
    let engine = made("myospring_web.wasm");
    let folder = target().join("web");
    std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let page = folder.join("myospring.html");
    around.arg(&engine).arg(made("myospring_unpack.wasm")).arg(&page);
    step("the page", around)?;
    Ok((engine, page))
}
