//! The work on spans that do not know of each other, on the threads of the current rayon pool.

use std::cell::Cell;

use rayon::prelude::*;

/// Shorter lists are done before another thread has woken.
const LONG: usize = 256;

thread_local! {
    /// Does this thread wait for others? Then it may have taken up work of a caller, such as the next curve of a batch: to
    /// wait in there again would nest one curve in another without end.
    static WAITS: Cell<bool> = const { Cell::new(false) };
}

/// Maps a list, in its order: the result does not depend on the number of threads.
pub(crate) fn map<T: Sync, U: Send>(list: &[T], f: impl Fn(&T) -> U + Send + Sync) -> Vec<U> {
    if list.len() < LONG || WAITS.replace(true) {
        return list.iter().map(f).collect();
    }
    let all = list.par_iter().with_min_len(LONG / 4).map(f).collect();
    WAITS.set(false);
    all
}
