//! Some cases of a large grid: the suite stays quick, and `cargo xtask test --full` takes them all.

/// Passes over most cases of a grid. The number should have no factor in common with that of the inner values, so that all of them come up.
pub(crate) struct Sample {
    one_in: usize,
    seen: usize,
}

impl Sample {
    /// Takes one case in `few`, starting with the first. With `MYOSPRING_ALL_CASES` set it takes every case.
    pub(crate) fn one_in(few: usize) -> Self {
        let all = std::env::var_os("MYOSPRING_ALL_CASES").is_some();
        Self { one_in: if all { 1 } else { few }, seen: 0 }
    }

    /// Whether the next case is left out.
    pub(crate) fn leaves_out(&mut self) -> bool {
        self.seen += 1;
        !(self.seen - 1).is_multiple_of(self.one_in)
    }
}
