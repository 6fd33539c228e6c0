//! The files of a folder of results.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Contents by their paths.
#[derive(Default, PartialEq)]
pub(super) struct Results(BTreeMap<String, Vec<u8>>);

impl Results {
    /// Of a folder and those in it; empty where there is none.
    pub(super) fn of(folder: &Path) -> Result<Self, String> {
        let mut all = BTreeMap::new();
        if folder.exists() {
            read(folder, "", &mut all).map_err(|error| format!("{}: {error}", folder.display()))?;
        }
        Ok(Self(all))
    }

    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    /// The files that are the same in both.
    pub(super) fn common_with(mut self, other: &Self) -> Self {
        self.0.retain(|name, content| other.0.get(name) == Some(content));
        self
    }

    /// Which of these files are missing or other there.
    pub(super) fn differences(&self, there: &Self) -> Vec<String> {
        let missing = self.0.keys().filter(|name| !there.0.contains_key(*name));
        missing.map(|name| format!("`{name}` is missing")).chain(self.others(there)).collect()
    }

    /// Which of these files are other there.
    pub(super) fn others(&self, there: &Self) -> Vec<String> {
        let is_other = |(name, content): &(&String, &Vec<u8>)| {
            there.0.get(*name).is_some_and(|other| !same(name, content, other))
        };
        let others = self.0.iter().filter(is_other);
        others.map(|(name, _)| format!("`{name}` has other bytes")).collect()
    }
}

/// Whether two files say the same. The order of the lines of a journal is that in which threads end.
fn same(name: &str, one: &[u8], other: &[u8]) -> bool {
    let lines = |bytes: &[u8]| -> BTreeSet<Vec<u8>> {
        bytes.split(|byte| *byte == b'\n').map(<[u8]>::to_vec).collect()
    };
    one == other || is_journal(name) && lines(one) == lines(other)
}

fn read(folder: &Path, place: &str, all: &mut BTreeMap<String, Vec<u8>>) -> std::io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        let name = format!("{place}{}", entry.file_name().to_string_lossy());
        if entry.file_type()?.is_dir() {
            read(&entry.path(), &format!("{name}/"), all)?;
        } else {
            all.insert(name, std::fs::read(entry.path())?);
        }
    }
    Ok(())
}

fn is_journal(name: &str) -> bool {
    Path::new(name).extension().is_some_and(|extension| extension == "jsonl")
}
