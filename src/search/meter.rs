//! How much work a search may do. Running out never changes an answer, it only leaves it wider.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

pub(crate) type Progress = Arc<dyn Fn(u64) + Send + Sync>;

/// Why a search stopped before it was done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Stop {
    /// The number of cells allowed was used up.
    MaxCells,
    /// The wall-clock budget was used up.
    Budget,
    /// The cancellation flag was set.
    Cancelled,
}

pub(crate) struct Meter {
    pub(crate) cells: u64,
    pub(crate) max_cells: u64,
    pub(crate) deadline: Option<Instant>,
    pub(crate) cancel: Option<Arc<AtomicBool>>,
    pub(crate) progress: Option<Progress>,
    pub(crate) stopped: Option<Stop>,
}

impl Meter {
    /// Is it time to end what is no search, such as writing evidence?
    pub(crate) fn is_late(&self) -> bool {
        let cancelled = self.cancel.as_ref().is_some_and(|c| c.load(Ordering::Relaxed));
        cancelled || self.deadline.is_some_and(|d| Instant::now() >= d)
    }

    /// Counts one cell; false when the work must stop.
    pub(crate) fn tick(&mut self) -> bool {
        if self.cells >= self.max_cells {
            self.stopped.get_or_insert(Stop::MaxCells);
        }
        if self.stopped.is_some() {
            return false;
        }
        self.cells += 1;
        // cells of high degree take milliseconds: the clock is looked at every time, if at all
        if self.deadline.is_some_and(|d| Instant::now() >= d) {
            self.stopped = Some(Stop::Budget);
        }
        if self.cancel.as_ref().is_some_and(|c| c.load(Ordering::Relaxed)) {
            self.stopped = Some(Stop::Cancelled);
        }
        if let Some(report) = self.progress.as_ref().filter(|_| self.cells.is_multiple_of(64)) {
            report(self.cells);
        }
        true
    }
}
