//! The files of the library as a tree of modules, and which file uses which.

use super::reader::{self, Reading, Scope, Written};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// More names that stand for names than anyone would pass on; a path that leads in a circle ends here.
const DEEPEST: usize = 32;

/// A file, and the module that it is: the crate's name, then the modules down to it.
struct File {
    path: PathBuf,
    module: Scope,
    reading: Reading,
}

/// All files of some crates.
#[derive(Default)]
pub(super) struct Library {
    files: Vec<File>,
    /// The file that each module stands in.
    modules: BTreeMap<Scope, usize>,
    /// What each module calls by a name of its own: `use` gives it.
    names: BTreeMap<(Scope, String), Vec<String>>,
}

/// What a path leads to.
struct Target {
    module: Scope,
    /// Something that stands in the module, not the module itself.
    is_item: bool,
}

/// One file that uses another.
pub(super) struct Use<'a> {
    pub(super) from: &'a Path,
    /// The module that the file is.
    pub(super) module: &'a [String],
    pub(super) to: &'a Path,
    /// The module that is used.
    pub(super) used: Scope,
    /// As it is written.
    pub(super) path: String,
    /// A parent that passes on a name of a child, or a module that is named and nothing of it: what those
    /// who use the name then use is counted with them.
    pub(super) is_name_only: bool,
}

impl Library {
    /// Reads a crate from its folder of sources; test modules are left out.
    pub(super) fn add(&mut self, name: &str, sources: &Path) {
        let root = ["lib.rs", "main.rs"].map(|file| sources.join(file));
        let root = root.into_iter().find(|file| file.exists()).unwrap();
        self.add_file(root, sources, &[name.to_owned()]);
    }

    fn add_file(&mut self, path: PathBuf, folder: &Path, module: &[String]) {
        let reading = reader::read(&std::fs::read_to_string(&path).unwrap());
        let index = self.files.len();
        self.modules.insert(module.to_vec(), index);
        for scope in &reading.inline {
            self.modules.insert([module, scope.as_slice()].concat(), index);
        }
        for Written { scope, path, bound } in &reading.written {
            if let Some(bound) = bound {
                let module = [module, scope.as_slice()].concat();
                self.names.insert((module, bound.name.clone()), path.clone());
            }
        }
        let children = reading.files.clone();
        self.files.push(File { path, module: module.to_vec(), reading });
        for name in children {
            let path = folder.join(format!("{name}.rs"));
            self.add_file(path, &folder.join(&name), &child(module, &name));
        }
    }

    /// The files that were read.
    pub(super) fn files(&self) -> impl Iterator<Item = (&Path, &[String])> {
        self.files.iter().map(|file| (file.path.as_path(), file.module.as_slice()))
    }

    /// Every use of one file by another.
    pub(super) fn uses(&self) -> Vec<Use<'_>> {
        let mut uses = Vec::new();
        for file in &self.files {
            for Written { scope, path, bound } in &file.reading.written {
                let within = [file.module.clone(), scope.clone()].concat();
                let Some(target) = self.resolve(&within, path, 0) else { continue };
                let to = &self.files[self.modules[&target.module]];
                if to.path == file.path {
                    continue;
                }
                let is_own = target.module.starts_with(&file.module);
                let passes_on = bound.as_ref().is_some_and(|bound| bound.passed_on) && is_own;
                uses.push(Use {
                    from: &file.path,
                    module: &file.module,
                    to: &to.path,
                    used: target.module,
                    path: path.join("::"),
                    is_name_only: passes_on || !target.is_item,
                });
            }
        }
        uses
    }

    /// Where a path leads that is written in a module; `None` if out of the library.
    fn resolve(&self, within: &[String], path: &[String], depth: usize) -> Option<Target> {
        let first = path.first().filter(|_| depth < DEEPEST)?;
        let ups = path.iter().take_while(|word| *word == "super").count();
        let (start, rest) = match first.as_str() {
            "crate" => (within[..1].to_vec(), &path[1..]),
            "self" => (within.to_vec(), &path[1..]),
            "super" => (within[..within.len() - ups].to_vec(), &path[ups..]),
            name if self.modules.contains_key([name.to_owned()].as_slice()) => {
                (vec![name.to_owned()], &path[1..])
            }
            name => {
                let key = (within.to_vec(), name.to_owned());
                let is_known = self.names.get(&key).is_some_and(|named| named.as_slice() != path)
                    || self.modules.contains_key(&child(within, name));
                (is_known.then(|| within.to_vec())?, path)
            }
        };
        self.descend(start, rest, depth)
    }

    /// Follows the segments of a path from a module on, through the names that modules pass on.
    fn descend(&self, mut module: Scope, path: &[String], depth: usize) -> Option<Target> {
        for (at, name) in path.iter().enumerate() {
            let child = child(&module, name);
            if self.modules.contains_key(&child) {
                module = child;
                continue;
            }
            let Some(named) = self.names.get(&(module.clone(), name.clone())) else {
                return Some(Target { module, is_item: true });
            };
            let rest = [named.as_slice(), &path[at + 1..]].concat();
            return self.resolve(&module, &rest, depth + 1);
        }
        Some(Target { module, is_item: false })
    }
}

fn child(module: &[String], name: &str) -> Scope {
    module.iter().cloned().chain([name.to_owned()]).collect()
}

/// The uses by which files use each other in circles, by the files that hang together so.
pub(super) fn circles<'a>(uses: &'a [Use<'a>]) -> BTreeMap<BTreeSet<&'a Path>, Vec<&'a Use<'a>>> {
    let mut graph: BTreeMap<&Path, BTreeSet<&Path>> = BTreeMap::new();
    let uses = uses.iter().filter(|step| !step.is_name_only);
    for step in uses.clone() {
        graph.entry(step.from).or_default().insert(step.to);
    }
    let reached: BTreeMap<&Path, BTreeSet<&Path>> =
        graph.keys().map(|file| (*file, reached_from(file, &graph))).collect();
    let reaches = |from: &Path, to: &Path| reached.get(from).is_some_and(|all| all.contains(to));
    let mut circles: BTreeMap<_, Vec<_>> = BTreeMap::new();
    for step in uses.filter(|step| reaches(step.to, step.from)) {
        let mutual = reached[step.from].iter().filter(|other| reaches(other, step.from));
        circles.entry(mutual.copied().collect()).or_default().push(step);
    }
    circles
}

/// All files that a file uses, those that they use, and so on.
fn reached_from<'a>(
    file: &'a Path,
    graph: &BTreeMap<&'a Path, BTreeSet<&'a Path>>,
) -> BTreeSet<&'a Path> {
    let (mut reached, mut open) = (BTreeSet::new(), vec![file]);
    while let Some(file) = open.pop() {
        open.extend(graph.get(file).into_iter().flatten().filter(|next| reached.insert(**next)));
    }
    reached
}
