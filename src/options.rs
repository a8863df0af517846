//! What may be asked of every command alike, and the numbers with which all answer.

use crate::error::{Error, ErrorKind};
use crate::number::{Rational, f64_above, f64_below};

/// A closed interval that holds a real number: `lo <= value <= hi`, both ends proved.
///
/// `hi` infinite: no upper bound is known, or none exists. `lo` infinite: the quantity is infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Enclosure {
    /// Proved lower bound.
    pub lo: f64,
    /// Proved upper bound.
    pub hi: f64,
}

impl Enclosure {
    /// The enclosure of an infinite quantity, such as a term with no pair at all.
    pub const INFINITE: Self = Self { lo: f64::INFINITY, hi: f64::INFINITY };

    pub(crate) const ZERO: Self = Self { lo: 0.0, hi: 0.0 };

    /// `hi - lo <= w hi`, or `lo = hi`.
    #[must_use]
    pub fn is_within(&self, w: f64) -> bool {
        self.lo == self.hi || (self.hi.is_finite() && self.hi - self.lo <= w * self.hi)
    }

    /// Do the two enclosures share a number?
    #[must_use]
    pub fn meets(&self, other: &Self) -> bool {
        self.lo <= other.hi && other.lo <= self.hi
    }

    /// What both say of one number.
    pub(crate) fn and(&self, other: &Self) -> Self {
        Self { lo: self.lo.max(other.lo), hi: self.hi.min(other.hi) }
    }

    pub(crate) fn of(x: &Rational) -> Self {
        Self::between(x, x)
    }

    /// Holds all from `lo` to `hi`.
    pub(crate) fn between(lo: &Rational, hi: &Rational) -> Self {
        Self { lo: f64_below(lo), hi: f64_above(hi) }
    }
}

/// Refuses a width that is none, and a processor that does not round as IEEE 754 says.
pub(crate) fn check(rel_width: f64) -> Result<(), Error> {
    if !(rel_width > 0.0 && rel_width < 1.0) {
        let message = format!("the relative width must lie between 0 and 1, not {rel_width}");
        return Err(Error::new(ErrorKind::Option, message).key("rel_width").help("use for instance 1e-9"));
    }
    if !crate::enclosure::rounding_is_sound() {
        return Err(Error::new(ErrorKind::Rounding, "floating-point rounding does not follow IEEE 754 here")
            .help("run on real hardware: emulators and valgrind are known to break directed rounding"));
    }
    Ok(())
}

/// The options of a command: those that all have, then its own, each with a setter.
macro_rules! options {
    ($(#[$meta:meta])* $name:ident { $($(#[$own_meta:meta])* $own:ident: $type:ty = $default:expr,)* }) => {
        $(#[$meta])*
        #[derive(Clone)]
        #[non_exhaustive]
        pub struct $name {
            pub(crate) rel_width: f64,
            pub(crate) certificate: bool,
            pub(crate) max_cells: u64,
            pub(crate) budget: Option<std::time::Duration>,
            pub(crate) cancel: Option<std::sync::Arc<std::sync::atomic::AtomicBool>>,
            pub(crate) progress: Option<crate::search::meter::Progress>,
            $(pub(crate) $own: $type,)*
        }

        impl std::fmt::Debug for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.debug_struct(stringify!($name))
                    .field("rel_width", &self.rel_width)
                    .field("certificate", &self.certificate)
                    .field("max_cells", &self.max_cells)
                    .field("budget", &self.budget)
                    $(.field(stringify!($own), &self.$own))*
                    .finish_non_exhaustive()
            }
        }

        impl Default for $name {
            fn default() -> Self {
                Self {
                    rel_width: 1e-9,
                    certificate: false,
                    max_cells: 20_000_000,
                    budget: None,
                    cancel: None,
                    progress: None,
                    $($own: $default,)*
                }
            }
        }

        impl $name {
            /// The defaults.
            #[must_use]
            pub fn new() -> Self {
                Self::default()
            }

            /// Sets the asked relative width: `hi - lo <= w hi` for lengths and curvatures, parameters to `w` times the
            /// length of the domain. Default 1e-9.
            #[must_use]
            pub fn rel_width(mut self, w: f64) -> Self {
                self.rel_width = w;
                self
            }

            /// Asks for the certificate. Default false.
            #[must_use]
            pub fn certificate(mut self, yes: bool) -> Self {
                self.certificate = yes;
                self
            }

            /// Sets the number of cells after which the searches stop, with what is proved by then. Default 20 million.
            #[must_use]
            pub fn max_cells(mut self, n: u64) -> Self {
                self.max_cells = n;
                self
            }

            /// Sets a wall-clock limit, which makes answers depend on the machine. None by default.
            #[must_use]
            pub fn budget(mut self, limit: std::time::Duration) -> Self {
                self.budget = Some(limit);
                self
            }

            /// Sets a flag that stops the searches early, once it is true, with what is proved by then.
            #[must_use]
            pub fn cancel(mut self, flag: std::sync::Arc<std::sync::atomic::AtomicBool>) -> Self {
                self.cancel = Some(flag);
                self
            }

            /// Sets a callback that is told the number of cells done now and then.
            #[must_use]
            pub fn progress(mut self, report: impl Fn(u64) + Send + Sync + 'static) -> Self {
                self.progress = Some(std::sync::Arc::new(report));
                self
            }

            $($(#[$own_meta])*
            #[must_use]
            pub fn $own(mut self, $own: $type) -> Self {
                self.$own = $own;
                self
            })*

            /// The limits as the searches keep them.
            pub(crate) fn meter(&self) -> crate::search::meter::Meter {
                crate::search::meter::Meter {
                    cells: 0,
                    max_cells: self.max_cells,
                    deadline: self.budget.and_then(|limit| std::time::Instant::now().checked_add(limit)),
                    cancel: self.cancel.clone(),
                    progress: self.progress.clone(),
                    stopped: None,
                }
            }
        }
    };
}
pub(crate) use options;
