//! The one error type: what is wrong, at which key and index, and what to do about it.

pub(crate) mod reading;

use std::fmt;

/// What kind of thing is wrong. Stable words for machines are given by [`ErrorKind::word`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorKind {
    /// A file cannot be read.
    Io,
    /// The text is not strict JSON (bad UTF-8, a byte-order mark, trailing data and so on).
    Syntax,
    /// A key that the format does not know.
    UnknownKey,
    /// A key that stands twice in one object.
    DuplicateKey,
    /// A key that must be there is not.
    MissingKey,
    /// A `schema` that this version does not read.
    Schema,
    /// A value of the wrong JSON type.
    WrongType,
    /// A number that is not one of the accepted spellings.
    Number,
    /// A documented limit is passed (digits, exponent, degree, points, bytes).
    Limit,
    /// An array of the wrong length.
    WrongLength,
    /// Knots that decrease.
    KnotOrder,
    /// An interior knot of multiplicity above the degree.
    KnotMultiplicity,
    /// The domain `knots[degree] .. knots[points]` is empty.
    EmptyDomain,
    /// The denominator `w` has a zero on the domain.
    WeightZero,
    /// The hodograph vanishes somewhere on the domain.
    Irregular,
    /// An option out of its range.
    Option,
    /// A certificate that cannot be decoded.
    Certificate,
    /// What was asked for does not exist, whatever the limits.
    Impossible,
    /// Floating-point rounding is broken on this machine (an emulator, for instance); nothing is claimed.
    Rounding,
}

impl ErrorKind {
    /// The word used for this kind in JSON output.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Io => "io",
            Self::Syntax => "syntax",
            Self::UnknownKey => "unknown_key",
            Self::DuplicateKey => "duplicate_key",
            Self::MissingKey => "missing_key",
            Self::Schema => "schema",
            Self::WrongType => "wrong_type",
            Self::Number => "number",
            Self::Limit => "limit",
            Self::WrongLength => "wrong_length",
            Self::KnotOrder => "knot_order",
            Self::KnotMultiplicity => "knot_multiplicity",
            Self::EmptyDomain => "empty_domain",
            Self::WeightZero => "weight_zero",
            Self::Irregular => "irregular",
            Self::Option => "option",
            Self::Certificate => "certificate",
            Self::Impossible => "impossible",
            Self::Rounding => "rounding",
        }
    }
}

/// What can fail with an [`Error`].
pub(crate) type Result<T, E = Error> = std::result::Result<T, E>;

/// Why an input is unusable. The place is given as fields, never only inside the message.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Error {
    /// The kind, for callers that act on it.
    pub kind: ErrorKind,
    /// The key of the curve file (or the argument of the constructor) at fault.
    pub key: Option<String>,
    /// The index of the offending element under that key.
    pub index: Option<usize>,
    /// The byte offset in the text, where the fault stands at one place in it.
    pub offset: Option<usize>,
    /// What is wrong, as one sentence without a full stop.
    pub message: String,
    /// What to do next; may be empty.
    pub help: String,
}

impl Error {
    pub(crate) fn new(kind: ErrorKind, message: impl Into<String>) -> Self {
        // what to do where nothing nearer to the fault is said
        let help = match kind {
            ErrorKind::Syntax => "write the file as strict JSON, in UTF-8",
            ErrorKind::Limit => "stay within the limits (docs/interface.md, Numbers), or split the curve",
            ErrorKind::Number => "write a decimal such as -1.5e-3 or, in quotes, a fraction such as \"1/3\"",
            ErrorKind::WrongType => "see the keys of a curve file in docs/interface.md",
            _ => "",
        };
        Self { kind, key: None, index: None, offset: None, message: message.into(), help: help.to_string() }
    }

    pub(crate) fn key(mut self, key: impl Into<String>) -> Self {
        self.key = Some(key.into());
        self
    }

    pub(crate) fn index(mut self, index: usize) -> Self {
        self.index = Some(index);
        self
    }

    pub(crate) fn offset(mut self, offset: usize) -> Self {
        self.offset = Some(offset);
        self
    }

    pub(crate) fn help(mut self, help: impl Into<String>) -> Self {
        self.help = help.into();
        self
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (&self.key, self.index) {
            (Some(key), Some(index)) => write!(f, "{key}[{index}]: ")?,
            (Some(key), None) => write!(f, "{key}: ")?,
            _ => {}
        }
        f.write_str(&self.message)?;
        if let Some(offset) = self.offset {
            write!(f, " (byte {offset})")?;
        }
        Ok(())
    }
}

impl std::error::Error for Error {}

/// Why a claim is not proved by a certificate. It says nothing about whether the claim is true.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Rejection {
    /// The section of the certificate: "curve", "lo", "hi", "along", "pairs", "start", "finish", "upper".
    pub section: &'static str,
    /// The number of the node in the section, from 1.
    pub node: Option<usize>,
    /// The line of the node.
    pub rule: String,
    /// What is wrong.
    pub why: String,
}

impl fmt::Display for Rejection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.section)?;
        if let Some(node) = self.node {
            write!(f, ", node {node} ({})", self.rule)?;
        }
        write!(f, ": {}", self.why)
    }
}

impl std::error::Error for Rejection {}

impl Rejection {
    pub(crate) fn of(section: &'static str, why: &str) -> Self {
        Self { section, node: None, rule: String::new(), why: why.to_string() }
    }

    pub(crate) fn at(self, node: usize, rule: &impl fmt::Display) -> Self {
        Self { node: Some(node), rule: rule.to_string(), ..self }
    }
}
