//! The lines of a batch, from file after file: no more of them in memory than a chunk has.

use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::slice;
use std::sync::Arc;

use tubecert::number::MAX_BYTES;

use crate::cli::Failure;
use crate::cli::args::Shard;

/// A chunk has so many bytes and its last line, which may be as long as a curve file.
pub const CHUNK_BYTES: usize = 8 << 20;

/// A line that is not blank.
pub struct Line {
    /// The name of its file as it was given.
    pub file: Arc<str>,
    /// From 1; blank lines count.
    pub number: u64,
    /// `None`: longer than a curve file may be.
    pub text: Option<Vec<u8>>,
}

/// What is left of the lines of a shard.
pub struct Lines<'a> {
    files: slice::Iter<'a, PathBuf>,
    open: Option<Open>,
    shard: Shard,
    /// The lines so far that are not blank, those of other shards too.
    count: u64,
    /// The bytes read so far, and those of all files if they are known.
    pub bytes: u64,
    pub all_bytes: Option<u64>,
}

struct Open {
    name: Arc<str>,
    from: Box<dyn BufRead>,
    number: u64,
}

fn is_stdin(path: &Path) -> bool {
    path == Path::new("-")
}

impl<'a> Lines<'a> {
    /// Refuses files that are not there, before any work is done. Each is opened when its turn has come: it may be a pipe.
    pub fn new(files: &'a [PathBuf], shard: Shard) -> Result<Self, Box<Failure>> {
        let mut all_bytes = Some(0);
        for path in files {
            let length = if is_stdin(path) { None } else { length(path)? };
            all_bytes = all_bytes.zip(length).map(|(all, length)| all + length);
        }
        Ok(Self { files: files.iter(), open: None, shard, count: 0, bytes: 0, all_bytes })
    }

    /// The next lines of the shard, at most so many; none at the end.
    pub fn chunk(&mut self, most: usize) -> Result<Vec<Line>, Box<Failure>> {
        let (mut chunk, mut bytes) = (vec![], 0);
        while chunk.len() < most && bytes < CHUNK_BYTES {
            let Some(line) = self.next()? else { break };
            bytes += line.text.as_ref().map_or(0, Vec::len);
            chunk.push(line);
        }
        Ok(chunk)
    }

    /// The next line of the shard.
    pub fn next(&mut self) -> Result<Option<Line>, Box<Failure>> {
        while let Some(line) = self.next_of_all()? {
            if line.text.as_ref().is_some_and(|text| text.trim_ascii().is_empty()) {
                continue;
            }
            let wanted = self.count % self.shard.of == self.shard.index;
            self.count += 1;
            if wanted {
                return Ok(Some(line));
            }
        }
        Ok(None)
    }

    fn next_of_all(&mut self) -> Result<Option<Line>, Box<Failure>> {
        loop {
            if let Some(open) = &mut self.open {
                let line = open.line().map_err(|error| Failure::unreadable(&open.name, &error))?;
                if let Some((line, bytes)) = line {
                    self.bytes += bytes;
                    return Ok(Some(line));
                }
            }
            let Some(path) = self.files.next() else { return Ok(None) };
            self.open = Some(Open::new(path)?);
        }
    }
}

/// Of a regular file its length.
fn length(path: &Path) -> Result<Option<u64>, Box<Failure>> {
    let unreadable = |error| Failure::unreadable(&path.display().to_string(), &error);
    let data = fs::metadata(path).map_err(unreadable)?;
    if data.is_dir() {
        return Err(unreadable(io::ErrorKind::IsADirectory.into()));
    }
    Ok(data.is_file().then_some(data.len()))
}

impl Open {
    fn new(path: &Path) -> Result<Self, Box<Failure>> {
        let name: Arc<str> = path.display().to_string().into();
        let from: Box<dyn BufRead> = if is_stdin(path) {
            Box::new(io::stdin().lock())
        } else {
            let file = File::open(path).map_err(|error| Failure::unreadable(&name, &error))?;
            Box::new(BufReader::with_capacity(1 << 16, file))
        };
        Ok(Self { name, from, number: 0 })
    }

    /// The next line and the number of its bytes; what is beyond the limit is passed over, not kept.
    fn line(&mut self) -> io::Result<Option<(Line, u64)>> {
        let mut text = Vec::new();
        let mut bytes = self.from.by_ref().take(MAX_BYTES as u64 + 1).read_until(b'\n', &mut text)?;
        if bytes == 0 {
            return Ok(None);
        }
        text.pop_if(|last| *last == b'\n');
        let long = text.len() > MAX_BYTES;
        if long {
            bytes += self.from.skip_until(b'\n')?;
        }
        self.number += 1;
        let text = (!long).then_some(text);
        Ok(Some((Line { file: self.name.clone(), number: self.number, text }, bytes as u64)))
    }
}
