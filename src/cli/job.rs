//! What the commands that search do alike: load, limit, show progress, write the certificate.

use std::path::Path;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use rayon::{ThreadPool, ThreadPoolBuilder};
use tubecert::{Certificate, Claim, Curve, Error, ErrorKind, Spine, Statement, Stop};

use super::args::{Common, Limits};
use super::verify::{Verdict, within};
use super::{Failure, NO_CLAIM, Said, read};

/// That of a main thread on most systems: a curve is as deep on every thread.
const STACK_BYTES: usize = 8 << 20;

/// The threads that were asked for; all cores if none were.
pub fn pool(limits: &Limits) -> Result<ThreadPool, Box<Failure>> {
    let threads = limits.threads.map_or(0, usize::from);
    let pool = ThreadPoolBuilder::new().num_threads(threads).stack_size(STACK_BYTES).build();
    pool.map_err(|error| Failure::option("--threads", &format!("the threads cannot be started: {error}")))
}

/// Runs a command; without --threads the library starts its own where a curve is long.
pub fn on_threads(args: &Common, run: impl FnOnce() -> Said + Send) -> Said {
    if args.limits.threads.is_none() { run() } else { pool(&args.limits)?.install(run) }
}

/// The work that one command was started for.
pub struct Job<'a> {
    args: &'a Common,
    file: String,
    pub spine: Spine,
    start: Instant,
    bar: ProgressBar,
}

impl<'a> Job<'a> {
    pub fn load(args: &'a Common) -> Result<Self, Box<Failure>> {
        let start = Instant::now();
        let file = args.curve.display().to_string();
        let bytes = read(&args.curve, &file)?;
        // drawn on a terminal only, and first after a second
        let bar = ProgressBar::no_length();
        bar.set_style(
            ProgressStyle::with_template("{spinner} {human_pos} cells").unwrap_or(ProgressStyle::default_spinner()),
        );
        Self::new(args, start, file, &bytes, bar)
    }

    /// One of many: its progress is not shown.
    pub fn of_line(args: &'a Common, file: &str, bytes: &[u8]) -> Result<Self, Box<Failure>> {
        Self::new(args, Instant::now(), file.to_string(), bytes, ProgressBar::hidden())
    }

    fn new(
        args: &'a Common,
        start: Instant,
        file: String,
        bytes: &[u8],
        bar: ProgressBar,
    ) -> Result<Self, Box<Failure>> {
        let spine = Curve::from_json_slice(bytes).and_then(Spine::from_curve);
        let spine = spine.map_err(|error| Box::new(Failure::of(file.clone(), error)))?;
        Ok(Self { args, file, spine, start, bar })
    }

    /// What is to be told of the number of cells done.
    pub fn progress(&self) -> impl Fn(u64) + Send + Sync + 'static {
        let (start, bar) = (self.start, self.bar.clone());
        move |cells| {
            if start.elapsed() > Duration::from_secs(1) {
                bar.set_position(cells);
            }
        }
    }

    /// What is left of the budget; without one, as good as for ever.
    pub fn budget(&self) -> Duration {
        self.args.limits.budget.map_or(Duration::MAX, |limit| limit.saturating_sub(self.start.elapsed()))
    }

    /// The answer of the library, or why there is none.
    pub fn done<T>(&self, answer: Result<T, Error>) -> Result<T, Box<Failure>> {
        self.bar.finish_and_clear();
        answer.map_err(|error| Box::new(Failure::of(self.file.clone(), error)))
    }

    /// Writes the certificate, if it was asked for, once the checker has verified exactly what will be printed.
    pub fn certify(&self, certificate: Option<&Certificate>, statement: Statement) -> Result<(), Box<Failure>> {
        let Some(path) = &self.args.certificate else { return Ok(()) };
        let claim = Claim { curve: self.spine.curve().clone(), statement };
        let limit = self.args.limits.budget.map(|_| self.budget());
        replayed(certificate, &claim, limit).and_then(|text| written(path, &text)).map_err(|message| {
            let width = format!("raise --rel-width (now {:e}), wider bounds need less", self.args.limits.rel_width);
            let help = Some(format!("nothing is claimed: {width}; or run without --certificate"));
            let file = Some(path.display().to_string());
            Box::new(Failure { file, help, ..Failure::new(ErrorKind::Certificate.word(), message, NO_CLAIM) })
        })
    }

    /// What to raise to have an answer narrower.
    pub fn limit(&self, stopped: Option<Stop>) -> String {
        match (stopped, self.args.limits.budget) {
            (Some(Stop::MaxCells), _) => format!("raise --max-cells (now {})", self.args.limits.max_cells),
            (Some(_), Some(limit)) => format!("raise --budget (now {} seconds)", limit.as_secs_f64()),
            _ => format!("raise --rel-width (now {:e})", self.args.limits.rel_width),
        }
    }
}

/// The text of the certificate, if it proves the claim.
fn replayed(certificate: Option<&Certificate>, claim: &Claim, limit: Option<Duration>) -> Result<String, String> {
    let text = certificate
        .ok_or("no evidence was written: it is too long, or part of the answer is not told narrowly enough, or --budget ended")?
        .encode();
    let certificate = Certificate::decode(text.as_bytes()).map_err(|error| error.to_string())?;
    match within(limit, claim, certificate) {
        Verdict::Verified(_) => Ok(text),
        Verdict::Rejected(rejection) => Err(format!("the checker rejects the answer: {rejection}")),
        Verdict::Undecided(_) => Err("checking the certificate takes longer than --budget".to_string()),
    }
}

fn written(path: &Path, text: &str) -> Result<(), String> {
    std::fs::write(path, text).map_err(|error| format!("the certificate cannot be written: {error}"))
}
