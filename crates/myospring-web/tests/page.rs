//! The program that puts the page around its engine.
#![allow(clippy::unwrap_used, reason = "tests")]

use std::fs;
use std::process::Command;

fn program() -> Command {
    Command::new(env!("CARGO_BIN_EXE_myospring-web"))
}

#[test]
fn the_page_is_one_file_that_asks_for_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let [engine, unpacker, page] =
        ["engine.wasm", "unpack.wasm", "page.html"].map(|name| folder.path().join(name));
    fs::write(&engine, b"\0asm\x01\0\0\0").unwrap();
    fs::write(&unpacker, b"\0asm\x01\0\0\0").unwrap();
    assert!(program().arg(&engine).arg(&unpacker).arg(&page).status().unwrap().success());
    let text = fs::read_to_string(&page).unwrap();
    assert!(
        text.starts_with("<!DOCTYPE html>") || text.starts_with("<!doctype html>"),
        "{}",
        &text[..80]
    );
    assert!(!text.contains("src=\"http") && !text.contains("href=\"http://"));
    // The one that unpacks as it is, the engine as LZMA, both in base64.
    assert!(text.contains("AGFzbQEAAAA=") && text.contains(">XQAA"));
}

#[test]
fn without_an_engine_it_says_so() {
    let output = program().args(["missing.wasm", "missing.wasm", "page.html"]).output().unwrap();
    assert!(!output.status.success());
    assert!(!program().output().unwrap().status.success());
}
