//! The command `batch`: a record for each line of files of curves, in the order of the lines whatever the threads do.

mod id;
mod lines;
mod output;

use std::io::{self, BufWriter, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;
use serde_json::Value;

use super::args::{BatchArgs, Common, CurvatureArgs, PairsArgs, PolylineArgs, RadiusArgs, Task};
use super::job::{Job, pool};
use super::json::{self, Origin};
use super::{DONE, Failure, NO_CLAIM, Said, UNDECIDED, curvature, fail, pairs, polyline, radius};
use lines::{CHUNK_BYTES, Line, Lines};

/// Enough to keep a thread busy between two waits for the slowest, few enough that little is lost when a batch is killed.
const LINES_PER_THREAD: usize = 256;

pub fn run(args: &BatchArgs) -> ExitCode {
    match finished(args) {
        Ok(summary) => {
            // nobody is left to tell if that fails
            let _ = io::stderr().write_all(summary.as_bytes());
            ExitCode::from(DONE)
        }
        Err(failure) => fail(&failure, false),
    }
}

/// Does the work; one line about it. A closed pipe ends it without a word.
fn finished(args: &BatchArgs) -> Result<String, Box<Failure>> {
    let BatchArgs { files, output, resume, shard, limits, .. } = args;
    let asked = Asked::new(args)?;
    let pool = pool(limits)?;
    let mut lines = Lines::new(files, *shard)?;
    let (mut to, kept): (Box<dyn Write>, u64) = match output {
        None => (Box::new(BufWriter::new(io::stdout())), 0),
        Some(path) if *resume => {
            let (file, kept) = output::go_on(path, &mut lines, |line, record| asked.is_answered_by(line, record))?;
            (Box::new(BufWriter::new(file)), kept)
        }
        Some(path) => (Box::new(BufWriter::new(output::begin(path)?)), 0),
    };
    let mut tally = Tally::new(kept, &lines);
    let threads = pool.current_num_threads();
    let mut most = threads;
    loop {
        let chunk = lines.chunk(most)?;
        if chunk.is_empty() {
            return Ok(tally.summary());
        }
        let records: Vec<Record> =
            pool.install(|| chunk.into_par_iter().with_max_len(1).map(|line| asked.record(line)).collect());
        let bytes: usize = records.iter().map(|record| record.text.len()).sum();
        // of long records, as far as these tell, so many at once as a chunk has bytes
        most =
            (2 * most).min(LINES_PER_THREAD * threads).min((CHUNK_BYTES * records.len() / bytes.max(1)).max(threads));
        let mut each = records.iter();
        match each.try_for_each(|record| to.write_all(record.text.as_bytes())).and_then(|()| to.flush()) {
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => return Ok(String::new()),
            written => written.map_err(|error| {
                output::unwritable(output.as_deref().unwrap_or(Path::new("standard output")), &error)
            })?,
        }
        tally.add(&records, lines.bytes);
    }
}

/// A line of output, and the exit code that its command would have.
struct Record {
    text: String,
    code: u8,
}

/// The command that is asked of every curve, as if it had been typed for each.
enum Asked {
    Radius(RadiusArgs),
    Curvature(CurvatureArgs),
    Pairs(PairsArgs),
    Polyline(PolylineArgs),
}

impl Asked {
    fn new(args: &BatchArgs) -> Result<Self, Box<Failure>> {
        let (terms, tolerance) = (args.terms.clone(), args.tolerance);
        if terms.all_terms && args.task != Task::Radius {
            return Err(Failure::option("--all-terms", "--all-terms is an option of the task radius alone"));
        }
        if tolerance.is_some() && args.task != Task::Polyline {
            return Err(Failure::option("--tolerance", "--tolerance is an option of the task polyline alone"));
        }
        let common = Common { curve: PathBuf::new(), json: true, certificate: None, limits: args.limits.clone() };
        Ok(match args.task {
            Task::Radius => Self::Radius(RadiusArgs { common, terms }),
            Task::Curvature => Self::Curvature(CurvatureArgs { common }),
            Task::Pairs => Self::Pairs(PairsArgs { common }),
            Task::Polyline => {
                let tolerance =
                    tolerance.ok_or_else(|| Failure::option("--tolerance", "the task polyline needs --tolerance T"))?;
                Self::Polyline(PolylineArgs { common, tolerance, output: None })
            }
        })
    }

    fn common(&self) -> &Common {
        match self {
            Self::Radius(args) => &args.common,
            Self::Curvature(args) => &args.common,
            Self::Pairs(args) => &args.common,
            Self::Polyline(args) => &args.common,
        }
    }

    fn answer(&self, file: &str, curve: &[u8]) -> Said {
        let job = Job::of_line(self.common(), file, curve)?;
        match self {
            Self::Radius(args) => radius::answer(&job, args),
            Self::Curvature(args) => curvature::answer(&job, args),
            Self::Pairs(args) => pairs::answer(&job, args),
            Self::Polyline(args) => polyline::answer(&job, args),
        }
    }

    fn record(&self, line: Line) -> Record {
        let file: &str = &line.file;
        let mut id = None;
        let said = line.text.ok_or_else(|| Failure::too_long("line", file)).and_then(|mut text| {
            id = id::take(&mut text)
                .map_err(|failure| Box::new(Failure { file: Some(file.to_string()), ..*failure }))?;
            guarded(|| self.answer(file, &text))
        });
        let origin = Origin { id: id.as_deref(), file, line: line.number };
        match said {
            Ok((answer, code)) => Record { text: json::record(&origin, &answer), code },
            Err(failure) => Record { text: json::failed_record(&origin, &failure), code: failure.code },
        }
    }

    /// Is this the record of the line? With a budget answers differ from run to run: then, whether it is about that line.
    fn is_answered_by(&self, line: Line, record: &[u8]) -> bool {
        let own = self.record(line).text;
        let value = |text: &[u8]| serde_json::from_slice::<Value>(text).unwrap_or_default();
        let about = |value: Value| ["command", "tubecert", "curve", "id", "file", "line"].map(|key| value[key].clone());
        match self.common().limits.budget {
            None => own.as_bytes() == record,
            Some(_) => about(value(own.as_bytes())) == about(value(record)),
        }
    }
}

/// A fault of the program ends its curve and no other.
fn guarded(work: impl FnOnce() -> Said) -> Said {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
        let message = format!("the program is at fault: {}", text.unwrap_or("it does not say how"));
        let help = Some("please report this curve; nothing is claimed about it".to_string());
        Err(Box::new(Failure { help, ..Failure::new("internal", message, NO_CLAIM) }))
    })
}

/// What is done, shown on a terminal while it is being done.
struct Tally {
    start: Instant,
    bar: ProgressBar,
    kept: u64,
    done: u64,
    failed: u64,
    undecided: u64,
}

impl Tally {
    fn new(kept: u64, lines: &Lines) -> Self {
        // drawn on a terminal only, and first after a second
        let (bar, template) = match lines.all_bytes {
            Some(bytes) => (ProgressBar::new(bytes), "{wide_bar} {percent}%, {msg}, {eta} left"),
            None => (ProgressBar::no_length(), "{spinner} {msg}"),
        };
        bar.set_style(ProgressStyle::with_template(template).unwrap_or(ProgressStyle::default_bar()));
        Self { start: Instant::now(), bar, kept, done: 0, failed: 0, undecided: 0 }
    }

    fn add(&mut self, records: &[Record], bytes: u64) {
        let count = |fits: fn(u8) -> bool| records.iter().filter(|record| fits(record.code)).count() as u64;
        self.done += records.len() as u64;
        self.undecided += count(|code| code == UNDECIDED);
        self.failed += count(|code| ![DONE, UNDECIDED].contains(&code));
        if self.start.elapsed() > Duration::from_secs(1) {
            self.bar.set_message(format!("{} curves, {:.0} a second", self.done, self.rate()));
            self.bar.set_position(bytes);
        }
    }

    fn rate(&self) -> f64 {
        self.done as f64 / self.start.elapsed().as_secs_f64()
    }

    fn summary(&self) -> String {
        self.bar.finish_and_clear();
        let Self { kept, done, failed, undecided, .. } = self;
        let kept = if *kept > 0 { format!(" after {kept} that were there") } else { String::new() };
        let (seconds, rate) = (self.start.elapsed().as_secs_f64(), self.rate());
        format!("{done} records{kept}: {failed} errors, {undecided} undecided; {seconds:.1} s, {rate:.0} a second\n")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_of_the_program_is_an_error_of_its_curve() {
        let failure = guarded(|| panic!("{} went wrong", "this")).unwrap_err();
        assert_eq!((failure.kind, failure.message.as_str()), ("internal", "the program is at fault: this went wrong"));
    }
}
