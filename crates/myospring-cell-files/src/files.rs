//! Files on disk: the model and what it imports from its own folder.

use crate::{Choices, LONGEST_FILE, ReadError, read};
use myospring_core::cell::equations::Equations;
use std::fs::File;
use std::io::Read;
use std::path::{Component, Path};

/// Reads a model file. Imports are read from its folder and the folders in it, never from elsewhere.
///
/// # Errors
/// A file that cannot be opened or is no model that can be simulated; the error says where and why.
pub fn open(path: &Path, choices: &Choices) -> Result<Equations, ReadError> {
    let file = path.display().to_string();
    let text = text_of(path).map_err(|reason| ReadError {
        file: file.clone(),
        line: None,
        component: None,
        reason,
    })?;
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    read(&file, &text, choices, &|name| {
        let inside = Path::new(name).components().all(|part| matches!(part, Component::Normal(_)));
        let root = if folder.as_os_str().is_empty() { Path::new(".") } else { &folder };
        let root = root.canonicalize().ok()?;
        let target = root.join(name).canonicalize().ok()?;
        (inside && target.starts_with(&root)).then(|| text_of(&target).ok()).flatten()
    })
}

fn text_of(path: &Path) -> Result<String, String> {
    let file = File::open(path).map_err(|error| format!("cannot be opened: {error}"))?;
    let mut bytes = Vec::new();
    let most = LONGEST_FILE as u64 + 1;
    file.take(most).read_to_end(&mut bytes).map_err(|error| format!("cannot be read: {error}"))?;
    String::from_utf8(bytes).map_err(|_| "the file is not text (UTF-8)".to_owned())
}
