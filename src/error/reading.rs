//! The words of the reader: what is wrong with a number or a curve file, and what to do about it. Outside the trust
//! line: what is refused has been decided where these are called; here it is only told.

use std::fmt::Display;

use super::{Error, ErrorKind};
use crate::number::{MAX_BYTES, MAX_CONTROL_POINTS, MAX_DEGREE, MAX_DIGITS, MAX_EXPONENT, Rational, compare, same};
use crate::print::shown;

/// The error for a limit that is passed: `what` is found, at most `most` (the constant `name`) is read.
pub(crate) fn over_limit(what: impl Display, most: usize, name: &str) -> Error {
    Error::new(ErrorKind::Limit, format!("{what}; the limit {name} is {most}"))
}

/// The start of a text from outside, quoted and made harmless, for messages.
pub(crate) fn excerpt(text: &str) -> String {
    let start: String = text.chars().take(40).collect();
    let dots = if start.len() < text.len() { "..." } else { "" };
    format!("{start:?}{dots}")
}

/// Why [`parse_rational`](crate::number::parse_rational) refuses `text`.
pub(crate) fn not_a_number(text: &str) -> Error {
    let unsigned = text.strip_prefix(['-', '+']).unwrap_or(text);
    let digits = |part: &str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    let parts = unsigned.split_once('/').filter(|_| !text.starts_with('+'));
    let (mantissa, exponent) = unsigned.split_once(['e', 'E']).unwrap_or((unsigned, "0"));
    let exponent = exponent.strip_prefix(['-', '+']).unwrap_or(exponent);
    let well_formed = match parts {
        Some((p, q)) => digits(p) && digits(q),
        None => digits(&mantissa.replacen('.', "", 1)) && digits(exponent),
    };
    let count = mantissa.bytes().filter(u8::is_ascii_digit).count();
    if !well_formed {
        Error::new(ErrorKind::Number, format!("{} is not a number", excerpt(text)))
    } else if count > MAX_DIGITS {
        over_limit(format_args!("a number of {count} digits"), MAX_DIGITS, "MAX_DIGITS")
    } else if parts.is_some() {
        Error::new(ErrorKind::Number, format!("{} has the denominator 0", excerpt(text)))
            .help("write a fraction whose denominator is not 0")
    } else {
        over_limit(format_args!("the exponent {}", excerpt(exponent)), MAX_EXPONENT, "MAX_EXPONENT")
    }
}

// JSON.

pub(crate) fn too_many_bytes(count: usize) -> Error {
    over_limit(format_args!("a text of {count} bytes"), MAX_BYTES, "MAX_BYTES")
}

pub(crate) fn not_utf8(error: std::str::Utf8Error) -> Error {
    Error::new(ErrorKind::Syntax, "the text is not UTF-8").offset(error.valid_up_to()).help("save the file as UTF-8")
}

/// The byte offset in `file` of `part`, a piece of it.
pub(crate) fn offset(file: &str, part: &str) -> usize {
    (part.as_ptr() as usize).saturating_sub(file.as_ptr() as usize)
}

/// `part`, a piece of `file`, is no JSON, as serde_json says in its own words.
pub(crate) fn not_json(file: &str, part: &str, error: &serde_json::Error) -> Error {
    let mut at = if error.is_eof() { part.len() } else { error_offset(part, error) };
    let said = error.to_string();
    let said = said.rsplit_once(" at line ").map_or(said.as_str(), |(said, _)| said);
    let found = part.get(at..).and_then(|rest| rest.chars().next());
    let expected = |wanted: &str| match found {
        Some(found) => format!("expected {wanted}, found {found:?}"),
        None => format!("expected {wanted}"),
    };
    const NUMBERS: &str = "JSON numbers look like -1.5e-3; any other spelling goes in quotes, as \"+.5\"";
    let (message, help) = match (said, found) {
        (_, Some('\u{feff}')) => {
            ("the text starts with a byte-order mark".to_string(), "save the file as UTF-8 without a mark")
        }
        ("expected value", Some('+' | '.' | 'N' | 'I')) => (expected("a value"), NUMBERS),
        ("expected value", _) => (expected("a value"), ""),
        ("invalid number", Some('0'..='9')) => ("a number has a leading zero".to_string(), NUMBERS),
        ("invalid number", _) => (expected("a digit"), NUMBERS),
        ("key must be a string", _) => (expected("a key in quotation marks"), ""),
        ("trailing characters", _) => ("there is text after the end of the JSON value".to_string(), ""),
        ("invalid escape", _) => (
            "a backslash starts no known escape".to_string(),
            "write a backslash as \\\\; after \\u stand four hexadecimal digits",
        ),
        _ if said.starts_with("control character") => {
            ("a control character stands in a string".to_string(), "escape it")
        }
        _ if said.contains("hex escape") => {
            at = part.get(..at).and_then(|before| before.rfind('\\')).unwrap_or(at);
            ("an escape is half of a surrogate pair".to_string(), "write both halves, or the character itself")
        }
        _ => match (said.strip_prefix("EOF while parsing "), said.strip_prefix("expected ")) {
            (Some(part), _) => (format!("the text ends before {part} is complete"), ""),
            (_, Some(wanted)) => (expected(&wanted.replace('`', "'")), ""),
            _ => (said.to_string(), ""),
        },
    };
    let error = Error::new(ErrorKind::Syntax, message).offset(offset(file, part) + at);
    if help.is_empty() { error } else { error.help(help) }
}

/// The byte that serde_json stopped at, from its line and its column, which is the number of bytes read in it.
fn error_offset(text: &str, error: &serde_json::Error) -> usize {
    let lines = text.split_inclusive('\n').take(error.line().saturating_sub(1));
    let read = lines.map(str::len).sum::<usize>() + error.column();
    // a control character is seen before it is read
    let read = read + usize::from(error.to_string().starts_with("control character"));
    (0..read).rev().find(|at| text.is_char_boundary(*at)).unwrap_or(0)
}

/// What JSON value `text` spells.
fn kind_of(text: &str) -> &'static str {
    match text.bytes().next() {
        Some(b'n') => "null",
        Some(b't' | b'f') => "a boolean",
        Some(b'"') => "a string",
        Some(b'[') => "an array",
        Some(b'{') => "an object",
        _ => "a number",
    }
}

/// A value of a curve file as it is spelled, and where it stands: of which file, under which key, at which index.
#[derive(Clone, Copy)]
pub(crate) struct Value<'a> {
    pub file: &'a str,
    pub key: &'a str,
    pub index: Option<usize>,
    pub text: &'a str,
}

impl Value<'_> {
    /// `error` with the place of this value.
    fn at(self, error: Error) -> Error {
        Error { index: self.index, ..error.key(self.key).offset(offset(self.file, self.text)) }
    }

    pub(crate) fn not_an_object(self) -> Error {
        Error::new(ErrorKind::WrongType, format!("a curve file is an object, not {}", kind_of(self.text)))
            .offset(offset(self.file, self.text))
            .help("write {\"degree\": ..., \"control_points\": [...]}")
    }

    /// This is a key.
    pub(crate) fn unknown_key(self) -> Error {
        self.key_error(ErrorKind::UnknownKey, "is unknown").help(
            "known are degree, control_points, weights, knots, name, source, unit, schema; keys of your own start with x-",
        )
    }

    /// This is a key.
    pub(crate) fn duplicate_key(self) -> Error {
        self.key_error(ErrorKind::DuplicateKey, "stands twice in one object").help("remove one of the two")
    }

    fn key_error(self, kind: ErrorKind, what: &str) -> Error {
        let key: String = serde_json::from_str(self.text).unwrap_or_default();
        let message = format!("the key {} {what}", excerpt(&key));
        Error::new(kind, message).key(key).offset(offset(self.file, self.text))
    }

    pub(crate) fn wrong_type(self, wanted: &str) -> Error {
        self.at(Error::new(ErrorKind::WrongType, format!("wanted {wanted}, found {}", kind_of(self.text))))
    }

    pub(crate) fn not_a_string(self, error: &serde_json::Error) -> Error {
        if self.text.starts_with('"') { not_json(self.file, self.text, error) } else { self.wrong_type("a string") }
    }

    /// `error`: why the text of this value is no number.
    pub(crate) fn not_a_number(self, error: Error) -> Error {
        match kind_of(self.text) {
            "a number" | "a string" => self.at(error),
            _ => self.wrong_type("a number, or a string that spells one"),
        }
    }

    /// This spells the number of a schema.
    pub(crate) fn unknown_schema(self) -> Error {
        let message = format!("schema {} is not known; this version reads 1", self.shown());
        self.at(Error::new(ErrorKind::Schema, message).help("update tubecert, or write the file for schema 1"))
    }

    /// This spells a number that is not whole, or negative, or beyond all limits.
    pub(crate) fn not_a_degree(self) -> Error {
        let degree = self.shown();
        if degree.starts_with(|c: char| c.is_ascii_digit()) && !degree.contains(['.', '/', '-']) {
            return degree_above_limit(&degree);
        }
        self.at(Error::new(ErrorKind::Number, format!("the degree {degree} is not a whole number"))
            .help(format!("give a degree of 1 to {MAX_DEGREE}")))
    }

    /// The number that is spelled here.
    fn shown(self) -> String {
        let number = self.number().map(|number| shown(&number));
        number.unwrap_or_else(|_| excerpt(self.text))
    }

    /// A point of `found` coordinates; the first point has `first`.
    pub(crate) fn wrong_dimension(self, found: usize, first: usize) -> Error {
        let wanted = if found == first { "2 or 3".to_string() } else { format!("{first} as in the first point") };
        self.at(Error::new(ErrorKind::WrongLength, format!("a point of {found} coordinates; wanted {wanted}"))
            .help("give every point 2 coordinates (z = 0) or every point 3; weights go into \"weights\""))
    }
}

pub(crate) fn missing_key(key: &str) -> Error {
    Error::new(ErrorKind::MissingKey, format!("the key \"{key}\" is missing"))
        .key(key)
        .help("a curve file needs \"degree\" and \"control_points\"")
}

// Curves.

/// What is wrong with a degree and lengths that do not fit.
pub(crate) fn wrong_lengths(degree: usize, points: usize, weights: Option<usize>, knots: Option<usize>) -> Error {
    if degree == 0 {
        return Error::new(ErrorKind::Limit, format!("the degree is 0; it must be 1 to {MAX_DEGREE}"))
            .key("degree")
            .help("join the points by a curve of degree 1 or more");
    }
    if degree > MAX_DEGREE {
        return degree_above_limit(degree);
    }
    if points > MAX_CONTROL_POINTS {
        return over_limit(format_args!("{points} control points"), MAX_CONTROL_POINTS, "MAX_CONTROL_POINTS")
            .key("control_points")
            .help("cut the curve into several files");
    }
    if points <= degree {
        let wanted = format_args!("at least {} for degree {degree}", degree + 1);
        return wrong_length("control_points", points, wanted).help("add control points or lower the degree");
    }
    let all = points + degree + 1;
    if knots.is_none() && points != degree + 1 {
        let wanted = format_args!("{} for degree {degree} without knots", degree + 1);
        return wrong_length("control_points", points, wanted)
            .help(format!("add \"knots\" ({all} of them) or set the degree to {}", points - 1));
    }
    if let Some(weights) = weights
        && weights != points
    {
        return wrong_length("weights", weights, format_args!("{points}, one for each control point"))
            .help("give every control point a weight, or leave \"weights\" out if all are 1");
    }
    let wanted = format_args!("{all} = points + degree + 1 = {points} + {degree} + 1");
    wrong_length("knots", knots.unwrap_or(0), wanted)
        .help("write every knot as often as it counts; some programs leave out the first and the last: repeat those")
}

fn degree_above_limit(degree: impl Display) -> Error {
    over_limit(format_args!("the degree {degree}"), MAX_DEGREE, "MAX_DEGREE")
        .key("degree")
        .help("split the curve into pieces of lower degree")
}

fn wrong_length(key: &str, found: usize, wanted: impl Display) -> Error {
    Error::new(ErrorKind::WrongLength, format!("{found} entries; wanted {wanted}")).key(key)
}

/// What is wrong with `points` + `degree` + 1 knots that are no knot vector.
pub(crate) fn wrong_knots(degree: usize, points: usize, knots: &[Rational]) -> Error {
    let error = |kind, index, message| Error::new(kind, message).key("knots").index(index);
    let mut pairs = knots.iter().zip(knots.iter().skip(1)).enumerate();
    if let Some((index, (before, knot))) = pairs.find(|(_, (before, knot))| compare(before, knot).is_gt()) {
        let message = format!("{} follows {}; knots must not decrease", shown(knot), shown(before));
        return error(ErrorKind::KnotOrder, index + 1, message).help("put the knots in order; none is moved here");
    }
    let (start, end) = (&knots[degree], &knots[points]);
    if same(start, end) {
        let message = format!("the domain knots[{degree}] .. knots[{points}] is empty: both are {}", shown(start));
        return error(ErrorKind::EmptyDomain, degree, message).help("the domain must have a positive length");
    }
    let mut ends = knots.iter().zip(knots.iter().skip(degree)).enumerate();
    let crowd = ends.find(|(_, (a, b))| same(a, b) && compare(start, a).is_lt() && compare(a, end).is_lt());
    let (index, knot) = crowd.map_or((degree, start), |(index, (knot, _))| (index + degree, knot));
    let message = format!("the knot {} stands more than {degree} times inside the domain", shown(knot));
    error(ErrorKind::KnotMultiplicity, index, message)
        .help("a knot may stand as often as the degree there; split a curve that jumps into two files")
}
