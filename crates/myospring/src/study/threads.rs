//! Threads for many members: never more in total than the machine has cores.

use super::StudyError;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// Threads of a study, which nothing else in the process uses. In a web page, which has one thread, that one does all.
#[derive(Debug)]
pub struct Threads(Option<ThreadPool>);

impl Threads {
    /// Creates `asked` threads; by default, and at most, as many as there are cores.
    ///
    /// # Errors
    /// The operating system refuses threads.
    pub fn new(asked: Option<usize>) -> Result<Self, StudyError> {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let threads = asked.filter(|count| *count > 0).map_or(cores, |count| count.min(cores));
        if cfg!(target_family = "wasm") {
            return Ok(Self(None));
        }
        Ok(Self(Some(ThreadPoolBuilder::new().num_threads(threads).build()?)))
    }

    /// Returns the number of threads.
    pub fn count(&self) -> usize {
        self.0.as_ref().map_or(1, ThreadPool::current_num_threads)
    }

    /// Runs a closure on these threads; parallel iterators of rayon inside it use no others.
    pub fn install<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        match &self.0 {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Threads;

    #[test]
    fn there_is_at_most_a_thread_for_every_core() {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        for (asked, expected) in [(None, cores), (Some(1), 1), (Some(0), cores), (Some(999), cores)]
        {
            assert_eq!(Threads::new(asked).unwrap().count(), expected, "asked for {asked:?}");
        }
    }
}
