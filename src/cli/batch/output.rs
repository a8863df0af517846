//! The file of a batch's records: new, or one that was cut off and is gone on with.

use std::fs::{File, OpenOptions};
use std::io::{self, BufRead, BufReader, Seek, SeekFrom};
use std::path::Path;

use tubecert::ErrorKind;

use super::lines::{Line, Lines};
use crate::cli::{Failure, NO_CLAIM, UNUSABLE};

/// How every record starts.
const START: &[u8] = br#"{"schema":1,"#;

/// A new file, or an empty one.
pub fn begin(path: &Path) -> Result<File, Box<Failure>> {
    let file = open(path, OpenOptions::new().write(true).create(true))?;
    if file.metadata().map_err(|error| unwritable(path, &error))?.len() > 0 {
        let help = "give --resume to go on where its records end, or the name of another file";
        return Err(refused(path, "the output exists and is not empty", help));
    }
    Ok(file)
}

/// The output behind its last complete record, and how many there are; `lines` goes behind theirs. The first and the last
/// record are made again: where `same` does not find them in the file, it is left as it is.
pub fn go_on(path: &Path, lines: &mut Lines, same: impl Fn(Line, &[u8]) -> bool) -> Result<(File, u64), Box<Failure>> {
    let mut file = open(path, OpenOptions::new().read(true).write(true).create(true))?;
    let kept = Kept::read(&file).map_err(|error| unwritable(path, &error))?;
    let mut fits = kept.count > 0 || kept.rest.iter().zip(START).all(|(a, b)| a == b);
    for k in 0..kept.count {
        let line = lines.next()?;
        fits &= match (line, k) {
            (None, _) => false,
            (Some(line), 0) => same(line, &kept.first),
            (Some(line), k) if k + 1 == kept.count => same(line, &kept.last),
            (Some(_), _) => true,
        };
        if !fits {
            break;
        }
    }
    if !fits {
        let help = "resume with the same input, task and options, or give the name of another file";
        return Err(refused(path, "the output holds records of another input, task or options", help));
    }
    let cut = file.set_len(kept.bytes).and_then(|()| file.seek(SeekFrom::Start(kept.bytes)));
    cut.map_err(|error| unwritable(path, &error))?;
    Ok((file, kept.count))
}

/// The records can be written no more.
pub fn unwritable(path: &Path, error: &io::Error) -> Box<Failure> {
    let message = format!("the records cannot be written: {error}");
    let help = Some("what was written stays true; make room, or give another file".to_string());
    let file = Some(path.display().to_string());
    Box::new(Failure { file, help, ..Failure::new(ErrorKind::Io.word(), message, NO_CLAIM) })
}

fn refused(path: &Path, message: &str, help: &str) -> Box<Failure> {
    let file = Some(path.display().to_string());
    let (message, help) = (message.to_string(), Some(help.to_string()));
    Box::new(Failure { file, help, ..Failure::new(ErrorKind::Option.word(), message, UNUSABLE) })
}

fn open(path: &Path, options: &OpenOptions) -> Result<File, Box<Failure>> {
    options.open(path).map_err(|error| unwritable(path, &error))
}

/// What a batch that was cut off has left.
#[derive(Default)]
struct Kept {
    /// The complete records and their bytes.
    count: u64,
    bytes: u64,
    first: Vec<u8>,
    last: Vec<u8>,
    /// The record that was cut off.
    rest: Vec<u8>,
}

impl Kept {
    fn read(file: &File) -> io::Result<Self> {
        let (mut reader, mut kept) = (BufReader::new(file), Self::default());
        let begin = reader.fill_buf()?;
        if !begin.iter().zip(START).all(|(a, b)| a == b) {
            // none of ours, and perhaps without an end
            kept.rest = begin.to_vec();
            return Ok(kept);
        }
        loop {
            kept.rest.clear();
            let bytes = reader.read_until(b'\n', &mut kept.rest)?;
            if kept.rest.last() != Some(&b'\n') {
                return Ok(kept);
            }
            std::mem::swap(&mut kept.last, &mut kept.rest);
            if kept.count == 0 {
                kept.first.clone_from(&kept.last);
            }
            kept.count += 1;
            kept.bytes += bytes as u64;
        }
    }
}
