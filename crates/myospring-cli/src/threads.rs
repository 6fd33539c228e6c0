//! Threads of work on many cells: never more in all than the machine has cores.

use crate::failure::Failure;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// Threads for so many cells at a time, each moved by one of them; without a wish as many as there are
/// cores, and never more.
pub(crate) fn pool(asked: Option<usize>) -> Result<ThreadPool, Failure> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = asked.filter(|count| *count > 0).map_or(cores, |count| count.min(cores));
    ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|error| Failure::new(format!("no threads: {error}")))
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_pool_has_at_most_a_thread_for_every_core() {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        for (asked, expected) in [(None, cores), (Some(1), 1), (Some(0), cores), (Some(999), cores)]
        {
            let pool = super::pool(asked).ok().map(|pool| pool.current_num_threads());
            assert_eq!(pool, Some(expected.min(cores)), "asked for {asked:?}");
        }
    }
}
