//! A strict JSON reader (RFC 8259) that keeps the text of numbers and the byte offset of every value.
//!
//! Numbers are not converted here: `Value::Number` is the spelling in the file, so that reading stays exact.

use std::borrow::Cow;

use crate::error::{Error, ErrorKind};
use crate::number::{MAX_BYTES, MAX_NESTING, excerpt, over_limit};
pub use crate::print::quote;

/// A JSON value and where it stands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Node<'a> {
    /// What it is.
    pub value: Value<'a>,
    /// The byte offset of its first character.
    pub offset: usize,
}

/// A JSON value. Texts are borrowed from the file wherever they contain no escape.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Value<'a> {
    /// `null`
    Null,
    /// `true` or `false`
    Bool(bool),
    /// A number as it is spelled.
    Number(&'a str),
    /// A string, escapes decoded.
    String(Cow<'a, str>),
    /// An array.
    Array(Vec<Node<'a>>),
    /// An object: its members in the order of the file, no key twice.
    Object(Vec<(Key<'a>, Node<'a>)>),
}

/// A key of an object and where it stands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Key<'a> {
    /// The key, escapes decoded.
    pub text: Cow<'a, str>,
    /// The byte offset of its quotation mark.
    pub offset: usize,
}

impl Value<'_> {
    /// What the value is, for messages: "an array", "null" and so on.
    #[must_use]
    pub const fn what(&self) -> &'static str {
        match self {
            Self::Null => "null",
            Self::Bool(_) => "a boolean",
            Self::Number(_) => "a number",
            Self::String(_) => "a string",
            Self::Array(_) => "an array",
            Self::Object(_) => "an object",
        }
    }
}

/// Reads one JSON text.
///
/// # Errors
/// All carry the byte offset, except that for the size. [`ErrorKind::Limit`]: more than [`MAX_BYTES`] bytes or
/// [`MAX_NESTING`] levels. [`ErrorKind::DuplicateKey`]: a key twice in one object. [`ErrorKind::Syntax`]: all else,
/// among it a byte-order mark, bad UTF-8, text after the value, `+1`, `.5`, `01`, `NaN`, control characters in a
/// string, half a surrogate pair.
///
/// ```
/// use tubecert::{error::ErrorKind, json};
/// let error = json::parse(b"[1, 2] 3").unwrap_err();
/// assert_eq!((error.kind, error.offset), (ErrorKind::Syntax, Some(7)));
/// ```
pub fn parse(bytes: &[u8]) -> Result<Node<'_>, Error> {
    if bytes.len() > MAX_BYTES {
        return Err(over_limit(format_args!("a text of {} bytes", bytes.len()), MAX_BYTES, "MAX_BYTES"));
    }
    if bytes.starts_with(b"\xef\xbb\xbf") {
        return Err(syntax(0, "the text starts with a byte-order mark").help("save the file as UTF-8 without a mark"));
    }
    let text = std::str::from_utf8(bytes)
        .map_err(|error| syntax(error.valid_up_to(), "the text is not UTF-8").help("save the file as UTF-8"))?;
    let mut reader = Reader { text, at: 0, pending: Vec::new() };
    let node = reader.value(0)?;
    reader.space();
    match reader.peek() {
        None => Ok(node),
        Some(_) => Err(syntax(reader.at, "there is text after the end of the JSON value")),
    }
}

fn syntax(offset: usize, message: impl Into<String>) -> Error {
    Error::new(ErrorKind::Syntax, message).offset(offset)
}

struct Reader<'a> {
    text: &'a str,
    at: usize,
    /// The items so far of the arrays that are open, so that each array is allocated once, at its length.
    pending: Vec<Node<'a>>,
}

impl<'a> Reader<'a> {
    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    /// Steps over `byte` if it is next.
    fn eat(&mut self, byte: u8) -> bool {
        let found = self.peek() == Some(byte);
        self.at += usize::from(found);
        found
    }

    fn skip(&mut self, wanted: impl Fn(u8) -> bool) {
        while self.peek().is_some_and(&wanted) {
            self.at += 1;
        }
    }

    fn space(&mut self) {
        self.skip(|byte| matches!(byte, b' ' | b'\t' | b'\n' | b'\r'));
    }

    /// The text from `start` up to here.
    fn since(&self, start: usize) -> Result<&'a str, Error> {
        self.text.get(start..self.at).ok_or_else(|| syntax(start, "a character is cut"))
    }

    /// The error that `wanted` does not stand here.
    fn expected(&self, wanted: &str) -> Error {
        match self.text.get(self.at..).and_then(|rest| rest.chars().next()) {
            Some(c) => syntax(self.at, format!("expected {wanted}, found {c:?}")),
            None => syntax(self.at, format!("expected {wanted}, found the end of the text")),
        }
    }

    /// One value; `depth` arrays and objects are open around it.
    fn value(&mut self, depth: usize) -> Result<Node<'a>, Error> {
        self.space();
        let offset = self.at;
        let value = match self.peek() {
            Some(b'[' | b'{') if depth >= MAX_NESTING => {
                let what = format_args!("arrays and objects {} levels deep", depth + 1);
                return Err(over_limit(what, MAX_NESTING, "MAX_NESTING").offset(offset));
            }
            Some(b'[') => self.array(depth + 1)?,
            Some(b'{') => self.object(depth + 1)?,
            Some(b'"') => Value::String(self.string()?),
            Some(b'-' | b'0'..=b'9') => Value::Number(self.number()?),
            Some(b'a'..=b'z') => self.word()?,
            Some(b'+' | b'.' | b'N' | b'I') => {
                let help = "JSON numbers look like -1.5e-3; any other spelling goes in quotes, as \"+.5\"";
                return Err(self.expected("a value").help(help));
            }
            _ => return Err(self.expected("a value")),
        };
        Ok(Node { value, offset })
    }

    fn word(&mut self) -> Result<Value<'a>, Error> {
        let start = self.at;
        self.skip(|byte| byte.is_ascii_alphanumeric());
        match self.since(start)? {
            "null" => Ok(Value::Null),
            "true" => Ok(Value::Bool(true)),
            "false" => Ok(Value::Bool(false)),
            other => Err(syntax(start, format!("{} is not a JSON value", excerpt(other)))),
        }
    }

    fn array(&mut self, depth: usize) -> Result<Value<'a>, Error> {
        self.at += 1;
        let start = self.pending.len();
        self.space();
        if !self.eat(b']') {
            loop {
                let item = self.value(depth)?;
                self.pending.push(item);
                self.space();
                if self.eat(b']') {
                    break;
                }
                if !self.eat(b',') {
                    return Err(self.expected("',' or ']'"));
                }
            }
        }
        let items = match start {
            0 => std::mem::take(&mut self.pending),
            _ => self.pending.drain(start..).collect(),
        };
        Ok(Value::Array(items))
    }

    fn object(&mut self, depth: usize) -> Result<Value<'a>, Error> {
        self.at += 1;
        let mut members = Vec::new();
        self.space();
        if !self.eat(b'}') {
            loop {
                self.space();
                let offset = self.at;
                if self.peek() != Some(b'"') {
                    return Err(self.expected("a key in quotation marks"));
                }
                let key = Key { text: self.string()?, offset };
                self.space();
                if !self.eat(b':') {
                    return Err(self.expected("':'"));
                }
                members.push((key, self.value(depth)?));
                self.space();
                if self.eat(b'}') {
                    break;
                }
                if !self.eat(b',') {
                    return Err(self.expected("',' or '}'"));
                }
            }
        }
        refuse_duplicates(&members)?;
        Ok(Value::Object(members))
    }

    /// `-?(0|[1-9]\d*)(\.\d+)?([eE][+-]?\d+)?`
    fn number(&mut self) -> Result<&'a str, Error> {
        let start = self.at;
        self.eat(b'-');
        let zero = self.at;
        self.digits()?;
        if self.since(zero)?.len() > 1 && self.since(zero)?.starts_with('0') {
            return Err(syntax(start, "a number has a leading zero"));
        }
        if self.eat(b'.') {
            self.digits()?;
        }
        if self.eat(b'e') || self.eat(b'E') {
            let _ = self.eat(b'+') || self.eat(b'-');
            self.digits()?;
        }
        self.since(start)
    }

    /// One digit or more.
    fn digits(&mut self) -> Result<(), Error> {
        if !self.peek().is_some_and(|byte| byte.is_ascii_digit()) {
            return Err(self.expected("a digit"));
        }
        self.skip(|byte| byte.is_ascii_digit());
        Ok(())
    }

    fn string(&mut self) -> Result<Cow<'a, str>, Error> {
        self.at += 1;
        let mut decoded = String::new();
        let mut start = self.at;
        let mut escaped = false;
        loop {
            self.skip(|byte| byte >= b' ' && byte != b'"' && byte != b'\\');
            let plain = self.since(start)?;
            match self.peek() {
                Some(b'"') => {
                    self.at += 1;
                    if !escaped {
                        return Ok(Cow::Borrowed(plain));
                    }
                    decoded.push_str(plain);
                    return Ok(Cow::Owned(decoded));
                }
                Some(b'\\') => {
                    decoded.push_str(plain);
                    decoded.push(self.escape()?);
                    escaped = true;
                    start = self.at;
                }
                Some(_) => return Err(syntax(self.at, "a control character stands in a string").help("escape it")),
                None => return Err(self.expected("the end of a string")),
            }
        }
    }

    /// The character of one escape sequence, two if they are a surrogate pair.
    fn escape(&mut self) -> Result<char, Error> {
        let start = self.at;
        self.at += 1;
        let simple = match self.peek() {
            Some(byte @ (b'"' | b'\\' | b'/')) => char::from(byte),
            Some(b'b') => '\u{8}',
            Some(b'f') => '\u{c}',
            Some(b'n') => '\n',
            Some(b'r') => '\r',
            Some(b't') => '\t',
            Some(b'u') => return self.unicode_escape(start),
            _ => return Err(syntax(start, "a backslash starts no known escape").help("write a backslash as \\\\")),
        };
        self.at += 1;
        Ok(simple)
    }

    /// The rest of `\uXXXX` or of a surrogate pair, from the `u` on; the backslash is at `start`.
    fn unicode_escape(&mut self, start: usize) -> Result<char, Error> {
        let first = self.code_unit(start)?;
        let mut code = first;
        if (0xd800..0xdc00).contains(&first) && self.eat(b'\\') && self.peek() == Some(b'u') {
            let second = self.code_unit(start)?;
            if (0xdc00..0xe000).contains(&second) {
                code = 0x1_0000 + ((first - 0xd800) << 10) + (second - 0xdc00);
            }
        }
        char::from_u32(code).ok_or_else(|| syntax(start, "an escape is half of a surrogate pair"))
    }

    /// The four hexadecimal digits after the `u` that is next.
    fn code_unit(&mut self, start: usize) -> Result<u32, Error> {
        self.at += 1;
        let digits = self.text.get(self.at..self.at + 4).filter(|digits| digits.bytes().all(|b| b.is_ascii_hexdigit()));
        self.at += 4;
        digits
            .and_then(|digits| u32::from_str_radix(digits, 16).ok())
            .ok_or_else(|| syntax(start, "\\u is not followed by four hexadecimal digits"))
    }
}

/// The first key that stands twice is an error. By sorting, for an object may have millions.
fn refuse_duplicates(members: &[(Key, Node)]) -> Result<(), Error> {
    let mut keys: Vec<_> = members.iter().map(|(key, _)| (key.text.as_ref(), key.offset)).collect();
    keys.sort_unstable();
    let again = keys.iter().zip(keys.iter().skip(1)).filter(|(a, b)| a.0 == b.0).map(|(_, b)| *b);
    match again.min_by_key(|(_, offset)| *offset) {
        None => Ok(()),
        Some((key, offset)) => {
            let message = format!("the key {} stands twice in one object", excerpt(key));
            Err(Error::new(ErrorKind::DuplicateKey, message).key(key).offset(offset).help("remove one of the two"))
        }
    }
}
