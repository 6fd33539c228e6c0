//! The input files of a run, as its results name them. They are copied into the results, so that a
//! moved folder repeats its run; large ones are named by their path relative to the results.

use super::error::ExperimentError;
use super::folder::Folder;
use crate::cell_files::{has_imports, is_model_file};
use crate::run_file::RunFile;
use crate::study::sha256;
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};
use std::{fs, io};

/// Where copies go within the results.
pub const FOLDER: &str = "inputs";

/// Largest file that is copied, bytes. Pictures, masks, outlines and tables are smaller; films may be larger.
pub const LARGEST_COPY: u64 = 100_000_000;

/// Names of files within the results, by their names as the run has them.
#[derive(Debug, Clone, Default)]
pub struct Inputs {
    names: BTreeMap<String, String>,
    /// Names of copies by their content: files of the same content are one.
    copies: BTreeMap<String, String>,
}

impl Inputs {
    /// Copies the files that a run file names into the results, except large ones; `read` reads a
    /// file by its name.
    ///
    /// # Errors
    /// A copy that cannot be written.
    pub fn keep(
        &mut self,
        folder: &Folder,
        mut file: RunFile,
        read: impl Fn(&str) -> io::Result<Vec<u8>>,
    ) -> Result<(), ExperimentError> {
        for path in file.paths_mut() {
            if self.names.contains_key(path) {
                continue;
            }
            let from_results = relative(Path::new(&*path), folder.target());
            // One that these results have made.
            let own = from_results.clone().filter(|name| folder.has(name));
            let large = fs::metadata(&*path).is_ok_and(|file| file.len() > LARGEST_COPY);
            // What a model imports lies beside it.
            let imports = is_model_file(path) && read(path).is_ok_and(|bytes| has_imports(&bytes));
            let copy = if own.is_none() && !large && !imports { read(path).ok() } else { None };
            let name = match (own, copy) {
                (Some(own), _) => own,
                (None, Some(bytes)) => {
                    self.copy(path, &bytes, |name, bytes| folder.write(name, bytes))?;
                    continue;
                }
                (None, None) => match from_results {
                    Some(name) => name,
                    // On another drive.
                    None => continue,
                },
            };
            self.names.insert(path.clone(), name);
        }
        Ok(())
    }

    /// Copies a file by `write`, unless another of the same content was copied.
    ///
    /// # Errors
    /// A copy that cannot be written.
    pub fn copy(
        &mut self,
        path: &str,
        bytes: &[u8],
        write: impl FnOnce(&str, &[u8]) -> Result<(), ExperimentError>,
    ) -> Result<(), ExperimentError> {
        let content = sha256(bytes);
        let name = if let Some(name) = self.copies.get(&content) {
            name.clone()
        } else {
            let name = self.free(Path::new(path));
            write(&name, bytes)?;
            self.copies.insert(content, name.clone());
            name
        };
        self.names.insert(path.to_owned(), name);
        Ok(())
    }

    /// Names a file that is not copied by its path relative to a folder of the results.
    pub fn stays(&mut self, path: &str, folder: &Path) {
        if let Some(name) = relative(Path::new(path), folder) {
            self.names.insert(path.to_owned(), name);
        }
    }

    /// A name for the copy of a file that no other copy has.
    fn free(&self, path: &Path) -> String {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let (stem, ending) = name.rsplit_once('.').unwrap_or((&name, ""));
        let dot = if ending.is_empty() { "" } else { "." };
        let numbered = (2..).map(|number| format!("{FOLDER}/{stem}_{number}{dot}{ending}"));
        let taken = |name: &String| self.names.values().any(|other| other == name);
        let mut all = std::iter::once(format!("{FOLDER}/{name}")).chain(numbered);
        all.find(|name| !taken(name)).unwrap_or_default()
    }

    /// The path `up` to the results, followed by the name of a file within them; unchanged for an
    /// unknown file.
    pub fn name(&self, path: &str, up: &str) -> String {
        self.names.get(path).map_or_else(|| path.to_owned(), |name| format!("{up}{name}"))
    }

    /// A run file whose files are named relative to a folder of the results, from which `up` leads to their top.
    pub fn renamed(&self, mut file: RunFile, up: &str) -> RunFile {
        for path in file.paths_mut() {
            *path = self.name(path, up);
        }
        file
    }
}

/// A path relative to a folder, with `/`; `None` if there is none, as from one drive to another.
pub fn relative(path: &Path, folder: &Path) -> Option<String> {
    let [path, folder] = [path, folder].map(|it| std::path::absolute(it).map(|it| plain(&it)));
    let (path, folder) = (path.ok()?, folder.ok()?);
    let (path, folder): (Vec<_>, Vec<_>) =
        (path.components().collect(), folder.components().collect());
    let shared = path.iter().zip(&folder).take_while(|(a, b)| a == b).count();
    if shared == 0 {
        return None;
    }
    let up = folder[shared..].iter().map(|_| "..".to_owned());
    let down = path[shared..].iter().map(|part| part.as_os_str().to_string_lossy().into_owned());
    Some(up.chain(down).collect::<Vec<_>>().join("/"))
}

/// Without `..`.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => drop(plain.pop()),
            part => plain.push(part),
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_named_as_seen_from_a_folder() {
        for (path, folder, expected) in [
            ("/a/b/cell.tif", "/a/results/cell", "../../b/cell.tif"),
            ("/a/results/cell/track/rest.tif", "/a/results/cell", "track/rest.tif"),
            ("cell.tif", "results/cell", "../../cell.tif"),
            ("x/../cell.tif", "results", "../cell.tif"),
        ] {
            let found = relative(Path::new(path), Path::new(folder));
            assert_eq!(found.as_deref(), Some(expected), "{path} from {folder}");
        }
    }
}
