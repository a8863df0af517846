//! The work on spans that do not know of each other, on the threads of the current rayon pool.

use rayon::prelude::*;

/// Shorter lists are done before another thread has woken.
const LONG: usize = 256;

/// Maps a list, in its order: the result does not depend on the number of threads.
pub(crate) fn map<T: Sync, U: Send>(list: &[T], f: impl Fn(&T) -> U + Send + Sync) -> Vec<U> {
    if list.len() < LONG {
        list.iter().map(f).collect()
    } else {
        list.par_iter().with_min_len(LONG / 4).map(f).collect()
    }
}
