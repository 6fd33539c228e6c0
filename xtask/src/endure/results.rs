//! The files of a folder of results.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Contents by their paths; `None` where two undisturbed programs wrote other ones, such as times.
#[derive(Default, PartialEq)]
pub(super) struct Results(BTreeMap<String, Option<Vec<u8>>>);

impl Results {
    /// Of a folder and those in it; empty where there is none.
    pub(super) fn of(folder: &Path) -> Result<Self, String> {
        let mut all = BTreeMap::new();
        if folder.exists() {
            read(folder, "", &mut all).map_err(|error| format!("{}: {error}", folder.display()))?;
        }
        Ok(Self(all.into_iter().map(|(name, content)| (name, Some(content))).collect()))
    }

    /// How many files have contents that are compared.
    pub(super) fn compared(&self) -> usize {
        self.0.values().flatten().count()
    }

    /// These files, with the contents that are the same in both.
    pub(super) fn alike_in(mut self, other: &Self) -> Self {
        for (name, content) in &mut self.0 {
            if other.0.get(name) != Some(content) {
                *content = None;
            }
        }
        self
    }

    /// Which of these files are missing or other there, and which are there besides.
    pub(super) fn differences(&self, there: &Self) -> Vec<String> {
        let missing = self.0.keys().filter(|name| !there.0.contains_key(*name));
        let more = there.0.keys().filter(|name| !self.0.contains_key(*name));
        missing
            .map(|name| format!("`{name}` is missing"))
            .chain(more.map(|name| format!("`{name}` is left behind")))
            .chain(self.others(there))
            .collect()
    }

    /// Which of these files are other there.
    pub(super) fn others(&self, there: &Self) -> Vec<String> {
        let is_other = |(name, content): &(&String, &Option<Vec<u8>>)| {
            let both = content.as_ref().zip(there.0.get(*name).and_then(Option::as_ref));
            both.is_some_and(|(content, other)| !same(name, content, other))
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
