//! Where the lines of a journal are, by the names of their members: a hash table on the disk, so that memory does not grow with the
//! members that are done.

use crate::output::files::Scratch;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io;
use std::path::{Path, PathBuf};

/// The line of a finished member.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Line {
    /// Its first byte.
    pub(super) start: u64,
    /// Number of its bytes.
    pub(super) length: u64,
    /// Short hash of the hash of its input, enough to detect a changed input.
    input: u64,
}

impl Line {
    /// `key` is the hash of its input.
    pub(super) fn new(start: u64, length: usize, key: &str) -> Self {
        Self { start, length: length as u64, input: digest(key) }
    }

    pub(super) fn is_of(self, key: &str) -> bool {
        self.input == digest(key)
    }
}

fn digest(text: &str) -> u64 {
    let mut hasher = DefaultHasher::new();
    text.hash(&mut hasher);
    hasher.finish()
}

/// Bytes of a slot: the digest of a member's name, then its line. Length 0 means no line: the member was removed, or, if the digest is 0,
/// too, the slot was never used.
const SLOT: usize = 32;
/// Slots of an empty table; a power of 2.
const FIRST: u64 = 1 << 12;
/// Factor by which a table grows that is two thirds full; a power of 2.
const MORE: u64 = 4;
/// Slots that are read at a time; most searches read once.
const AT_ONCE: u64 = 8;

/// Lines by the names of their members. A name is known by its digest: two that share one are taken for one, which the reader of the
/// line notices.
pub(super) struct Lines {
    folder: PathBuf,
    file: Scratch,
    /// How many there are; a power of 2.
    slots: u64,
    /// How many of them are in use, with those of removed members.
    taken: u64,
}

/// A place in the table, and what is there.
struct Slot {
    place: u64,
    /// Of a name: 0 if nothing is there.
    digest: u64,
    line: Line,
}

impl Lines {
    /// An empty table, in a file without a name in a folder.
    pub(super) fn new(folder: &Path) -> io::Result<Self> {
        Self::with_slots(folder, FIRST)
    }

    fn with_slots(folder: &Path, slots: u64) -> io::Result<Self> {
        let file = Scratch::new(folder, slots * SLOT as u64)?;
        Ok(Self { folder: folder.to_owned(), file, slots, taken: 0 })
    }

    /// The line of a member.
    pub(super) fn get(&mut self, name: &str) -> io::Result<Option<Line>> {
        if self.taken == 0 {
            return Ok(None);
        }
        Ok(Some(self.find(of_name(name))?.line).filter(|line| line.length > 0))
    }

    /// Sets the line of a member.
    pub(super) fn insert(&mut self, name: &str, line: Line) -> io::Result<()> {
        self.set(of_name(name), line)
    }

    /// Removes the line of a member; whether it had one.
    pub(super) fn remove(&mut self, name: &str) -> io::Result<bool> {
        let found = self.find(of_name(name))?;
        let had = found.line.length > 0;
        if had {
            self.write(&Slot { line: Line { length: 0, ..found.line }, ..found })?;
        }
        Ok(had)
    }

    fn set(&mut self, digest: u64, line: Line) -> io::Result<()> {
        let mut found = self.find(digest)?;
        let is_new = found.digest == 0;
        // Before anything is written: there is a free slot also after an error.
        if is_new && 3 * (self.taken + 1) > 2 * self.slots {
            self.grow()?;
            found = self.find(digest)?;
        }
        self.write(&Slot { digest, line, ..found })?;
        self.taken += u64::from(is_new);
        Ok(())
    }

    /// The slot of a digest, or the free one where it would be.
    fn find(&mut self, digest: u64) -> io::Result<Slot> {
        let mut bytes = [0; AT_ONCE as usize * SLOT];
        let mut first = digest & (self.slots - 1);
        loop {
            let count = AT_ONCE.min(self.slots - first);
            let some = &mut bytes[..count as usize * SLOT];
            self.file.read(first * SLOT as u64, some)?;
            let slots = (first..).zip(some.as_chunks().0).map(|(place, slot)| read(place, slot));
            if let Some(found) = slots.into_iter().find(|slot| [0, digest].contains(&slot.digest)) {
                return Ok(found);
            }
            first = (first + count) & (self.slots - 1);
        }
    }

    fn write(&mut self, Slot { place, digest, line }: &Slot) -> io::Result<()> {
        let mut bytes = [0; SLOT];
        let words = [*digest, line.start, line.length, line.input];
        for (to, word) in bytes.as_chunks_mut().0.iter_mut().zip(words) {
            *to = word.to_le_bytes();
        }
        self.file.write(place * SLOT as u64, &bytes)
    }

    fn grow(&mut self) -> io::Result<()> {
        let mut larger = Self::with_slots(&self.folder, MORE * self.slots)?;
        let mut bytes = vec![0; FIRST.min(self.slots) as usize * SLOT];
        for first in (0..self.slots).step_by(bytes.len() / SLOT) {
            self.file.read(first * SLOT as u64, &mut bytes)?;
            for slot in bytes.as_chunks().0 {
                let Slot { digest, line, .. } = read(first, slot);
                if line.length > 0 {
                    larger.set(digest, line)?;
                }
            }
        }
        *self = larger;
        Ok(())
    }
}

/// The digest of a name: not 0.
fn of_name(name: &str) -> u64 {
    digest(name).max(1)
}

fn read(place: u64, bytes: &[u8; SLOT]) -> Slot {
    let word = |at: usize| {
        let word = bytes.as_chunks().0.get(at).copied();
        u64::from_le_bytes(word.unwrap_or_default())
    };
    Slot { place, digest: word(0), line: Line { start: word(1), length: word(2), input: word(3) } }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeMap;
    use std::fs;

    /// What happens to the line of a member.
    #[derive(Debug, Clone)]
    enum Change {
        Insert(u16, u64),
        Remove(u16),
    }

    fn changes() -> impl Strategy<Value = Vec<Change>> {
        let change = prop_oneof![
            4 => (0..300_u16, 1..1000_u64).prop_map(|(name, start)| Change::Insert(name, start)),
            1 => (0..300_u16).prop_map(Change::Remove),
        ];
        proptest::collection::vec(change, 0..600)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn they_are_what_a_map_in_memory_has(changes in changes()) {
            let folder = tempfile::tempdir().unwrap();
            // So few slots that they grow, and that searches go on from the last slot to the first.
            let mut lines = Lines::with_slots(folder.path(), 2).unwrap();
            let mut map = BTreeMap::new();
            for change in changes {
                match change {
                    Change::Insert(name, start) => {
                        let name = name.to_string();
                        let line = Line::new(start, 7, &name);
                        lines.insert(&name, line).unwrap();
                        map.insert(name, line);
                    }
                    Change::Remove(name) => {
                        let name = name.to_string();
                        prop_assert_eq!(lines.remove(&name).unwrap(), map.remove(&name).is_some());
                    }
                }
            }
            for name in (0..300).map(|name: u16| name.to_string()) {
                prop_assert_eq!(lines.get(&name).unwrap(), map.get(&name).copied());
            }
            prop_assert!(3 * lines.taken <= 2 * lines.slots && lines.taken >= map.len() as u64);
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_table_that_cannot_grow_stays_as_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let within = folder.path().join("within");
        fs::create_dir(&within).unwrap();
        let mut lines = Lines::with_slots(&within, 4).unwrap();
        fs::remove_dir(&within).unwrap();
        let line = Line::new(3, 5, "key");
        assert!(["a", "b"].iter().all(|name| lines.insert(name, line).is_ok()));
        for name in ["c", "d", "e", "f"] {
            assert!(lines.insert(name, line).is_err());
            assert_eq!(lines.get(name).unwrap(), None);
        }
        lines.insert("a", Line::new(4, 5, "key")).unwrap();
        assert_eq!(lines.get("a").unwrap().unwrap().start, 4);
    }

    #[test]
    fn their_file_has_no_name() {
        let folder = tempfile::tempdir().unwrap();
        let mut lines = Lines::new(folder.path()).unwrap();
        lines.insert("a", Line::new(3, 5, "key")).unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        let line = lines.get("a").unwrap().unwrap();
        assert_eq!((line.start, line.length), (3, 5));
        assert!(line.is_of("key") && !line.is_of("other"));
    }
}
