//! The key `id` of a line: not a key of a curve file, so that it is taken out before the line is read as one.

use std::fmt;
use std::ops::Range;

use serde::de::{Deserializer, MapAccess, Visitor};
use serde_json::value::RawValue;
use tubecert::ErrorKind;

use crate::cli::{Failure, UNUSABLE};

const KEY: &str = "\"id\"";
/// What the reader ignores. As long as the key, so that the offsets in errors are those in the line.
const IGNORED: &[u8] = b"\"x-\"";
const MAX_ID_BYTES: usize = 1_000;

/// The value of the key `id`, as it is spelled. A line that is no object is left to the reader, whose error is better.
pub fn take(line: &mut [u8]) -> Result<Option<Box<RawValue>>, Box<Failure>> {
    let Some((key, id)) = find(line)? else { return Ok(None) };
    line[key].copy_from_slice(IGNORED);
    Ok(Some(id))
}

/// Where the key stands, and the value.
type Found = (Range<usize>, Box<RawValue>);

fn find(line: &[u8]) -> Result<Option<Found>, Box<Failure>> {
    let Ok(text) = str::from_utf8(line) else { return Ok(None) };
    let ids = serde_json::Deserializer::from_str(text).deserialize_map(Ids).unwrap_or_default();
    let offset = |part: &RawValue| part.get().as_ptr() as usize - text.as_ptr() as usize;
    match ids.as_slice() {
        [] => Ok(None),
        [(key, id)] => {
            check(id).map_err(|(kind, message)| refused(kind, message, offset(id)))?;
            Ok(Some((offset(key)..offset(key) + KEY.len(), (*id).to_owned())))
        }
        [_, (key, _), ..] => Err(refused(ErrorKind::DuplicateKey, "the key id stands twice", offset(key))),
    }
}

fn check(id: &RawValue) -> Result<(), (ErrorKind, &'static str)> {
    let text = id.get();
    // of a string, half a surrogate pair is refused as well: it could not be read back
    let fine = if text.starts_with('"') {
        serde_json::from_str::<String>(text).is_ok()
    } else {
        text.starts_with(|first: char| first == '-' || first.is_ascii_digit())
    };
    if !fine {
        Err((ErrorKind::WrongType, "an id is a string or a number"))
    } else if text.len() > MAX_ID_BYTES {
        Err((ErrorKind::Limit, "an id has at most 1000 bytes"))
    } else {
        Ok(())
    }
}

fn refused(kind: ErrorKind, message: &str, offset: usize) -> Box<Failure> {
    let help = Some("give each line one id, a short string or a number, or none".to_string());
    let key = Some("id".to_string());
    Box::new(Failure { key, offset: Some(offset), help, ..Failure::new(kind.word(), message.to_string(), UNUSABLE) })
}

/// Collects the members of an object whose key is `id`, keys and values as they are spelled.
struct Ids;

impl<'a> Visitor<'a> for Ids {
    type Value = Vec<(&'a RawValue, &'a RawValue)>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<A: MapAccess<'a>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut ids = vec![];
        while let Some((key, value)) = map.next_entry::<&RawValue, &RawValue>()? {
            if key.get() == KEY {
                ids.push((key, value));
            }
        }
        Ok(ids)
    }
}
