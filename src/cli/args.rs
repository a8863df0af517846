//! What may be typed. A command or flag that does not work yet does not stand here.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Parser, Subcommand};
use clap_complete::Shell;

/// Proves geometric facts about tubes around rational space curves
#[derive(Debug, Parser)]
#[command(
    name = "tubecert",
    version,
    arg_required_else_help = true,
    after_help = "\
Exit codes: 0 answered and proved; 1 rejected; 2 unusable input or usage; 3 undecided within the limits (what is
printed is still true, only wider); 4 output not writable or floating point broken (nothing is claimed)."
)]
pub struct Args {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Encloses delta, the largest radius for which the solid tube does not self-intersect
    #[cfg(feature = "search")]
    Radius(RadiusArgs),
    /// The greatest curvature and every critical point of curvature
    #[cfg(feature = "search")]
    Curvature(CurvatureArgs),
    /// Every stationary pair of the squared distance of two points, each proved to be alone in its box
    #[cfg(feature = "search")]
    Pairs(PairsArgs),
    /// Roots of |C'|^2, and all ways to write it as a sum of two squares
    #[cfg(feature = "search")]
    Squares(SquaresArgs),
    /// A polyline within a tolerance of the curve and isotopic to it
    #[cfg(feature = "search")]
    Polyline(PolylineArgs),
    /// Answers for every line of files of curves (NDJSON), in order, on many threads; can be cut off and resumed
    #[cfg(feature = "search")]
    Batch(BatchArgs),
    /// Certifies or refutes a polyline made elsewhere: is it within a tolerance of the curve and isotopic to it?
    #[cfg(feature = "search")]
    Check(CheckArgs),
    /// Replays a certificate in exact arithmetic: does it prove the claim about the curve?
    Verify(VerifyArgs),
    /// Prints the completion script of a shell
    Completions {
        /// The shell
        shell: Shell,
    },
}

#[derive(Debug, clap::Args)]
pub struct VerifyArgs {
    /// The curve file (JSON); - is standard input
    pub curve: PathBuf,
    /// The certificate
    pub certificate: PathBuf,
    /// The claim: the JSON answer of a command; without it, the strongest that the certificate proves
    #[arg(long, value_name = "ANSWER")]
    pub answer: Option<PathBuf>,
    /// The polyline that is claimed: .json, .csv or .obj
    #[arg(long, value_name = "FILE")]
    pub polyline: Option<PathBuf>,
    /// Print the verdict as JSON; a failure too
    #[arg(long)]
    pub json: bool,
    /// Stop after so many seconds without a verdict
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true)]
    pub budget: Option<Duration>,
}

/// What all commands that search take.
#[cfg(feature = "search")]
#[derive(Debug, clap::Args)]
pub struct Common {
    /// The curve file (JSON); - is standard input
    pub curve: PathBuf,
    /// Print the answer as JSON; a failure too
    #[arg(long)]
    pub json: bool,
    /// Write the evidence to FILE, after replaying it; `tubecert verify` checks it
    #[arg(long, value_name = "FILE")]
    pub certificate: Option<PathBuf>,
    #[command(flatten)]
    pub limits: Limits,
}

/// How narrow an answer is to be, and what it may cost.
#[cfg(feature = "search")]
#[derive(Debug, Clone, clap::Args)]
pub struct Limits {
    /// The asked relative width, between 0 and 1: hi - lo <= W hi
    #[arg(long, value_name = "W", default_value = "1e-9", value_parser = rel_width, allow_negative_numbers = true)]
    pub rel_width: f64,
    /// Stop after N cells with what is proved by then
    #[arg(long, value_name = "N", default_value_t = 20_000_000, allow_negative_numbers = true)]
    pub max_cells: u64,
    /// Stop after so many seconds with what is proved by then; answers then depend on the machine
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true)]
    pub budget: Option<Duration>,
    /// Work on so many threads; all cores without it. The answer does not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
}

#[cfg(feature = "search")]
#[derive(Debug, clap::Args)]
pub struct RadiusArgs {
    #[command(flatten)]
    pub common: Common,
    #[command(flatten)]
    pub terms: Terms,
}

#[cfg(feature = "search")]
#[derive(Debug, Clone, clap::Args)]
pub struct Terms {
    /// Enclose every term, also those that cannot bind, and the rim terms; can take much longer
    #[arg(long)]
    pub all_terms: bool,
}

#[cfg(feature = "search")]
#[derive(Debug, clap::Args)]
pub struct CurvatureArgs {
    #[command(flatten)]
    pub common: Common,
}

#[cfg(feature = "search")]
#[derive(Debug, clap::Args)]
pub struct PairsArgs {
    #[command(flatten)]
    pub common: Common,
}

#[cfg(feature = "search")]
#[derive(Debug, clap::Args)]
pub struct SquaresArgs {
    #[command(flatten)]
    pub common: Common,
    /// List at most N decompositions of a segment
    #[arg(long, value_name = "N", default_value_t = 64, allow_negative_numbers = true)]
    pub limit: usize,
}

#[cfg(feature = "search")]
#[derive(Debug, clap::Args)]
pub struct PolylineArgs {
    #[command(flatten)]
    pub common: Common,
    /// The greatest Frechet distance, in the curve's unit
    #[arg(long, value_name = "T", value_parser = length, allow_negative_numbers = true)]
    pub tolerance: f64,
    /// Write the polyline to FILE, which ends in .json, .csv or .obj
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

#[cfg(feature = "search")]
#[derive(Debug, clap::Args)]
pub struct CheckArgs {
    #[command(flatten)]
    pub common: Common,
    /// The polyline: .json (a list of points, or an answer), .csv (x,y,z) or .obj (v and l lines)
    pub polyline: PathBuf,
    /// The greatest Frechet distance, in the curve's unit
    #[arg(long, value_name = "T", value_parser = length, allow_negative_numbers = true)]
    pub tolerance: f64,
}

#[cfg(feature = "search")]
#[derive(Debug, clap::Args)]
pub struct BatchArgs {
    /// What to ask of every curve
    #[arg(long)]
    pub task: Task,
    /// Files with a curve file, on one line, on each line; - or none is standard input
    #[arg(value_name = "FILE", default_value = "-")]
    pub files: Vec<PathBuf>,
    /// Write the records to FILE, which must be empty or new without --resume
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Go on where the records in the output end; begin if there are none
    #[arg(long, requires = "output")]
    pub resume: bool,
    /// Of all lines only every N-th, from the I-th on; the shards 1/N .. N/N are all lines
    #[arg(long, value_name = "I/N", value_parser = shard, default_value = "1/1")]
    pub shard: Shard,
    #[command(flatten)]
    pub limits: Limits,
    #[command(flatten, next_help_heading = "Options of the task radius")]
    pub terms: Terms,
    /// The greatest Frechet distance, in the curve's unit
    #[arg(long, value_name = "T", value_parser = length, allow_negative_numbers = true)]
    #[arg(required_if_eq("task", "polyline"), help_heading = "Options of the task polyline")]
    pub tolerance: Option<f64>,
}

/// The commands that can be asked of many curves.
#[cfg(feature = "search")]
#[derive(Debug, Clone, Copy, PartialEq, clap::ValueEnum)]
pub enum Task {
    Radius,
    Curvature,
    Pairs,
    Polyline,
}

/// Of the lines k = 0, 1, .. those with k mod `of` = `index`.
#[cfg(feature = "search")]
#[derive(Debug, Clone, Copy)]
pub struct Shard {
    pub index: u64,
    pub of: u64,
}

#[cfg(feature = "search")]
fn shard(text: &str) -> Result<Shard, String> {
    let parts = text.split_once('/').and_then(|(i, n)| Some((i.parse::<u64>().ok()?, n.parse().ok()?)));
    let shard = parts.filter(|(i, n)| (1..=*n).contains(i)).map(|(i, of)| Shard { index: i - 1, of });
    shard.ok_or_else(|| "a share I/N with 1 <= I <= N is wanted, for instance 3/16".to_string())
}

/// The greatest f64 that is not above the number that is spelled.
#[cfg(feature = "search")]
fn length(text: &str) -> Result<f64, String> {
    let length = tubecert::number::parse_rational(text).ok().map(|x| tubecert::number::f64_below(&x));
    let fine = length.filter(|x| *x > 0.0 && x.is_finite());
    fine.ok_or_else(|| "a positive number that f64 can hold is wanted, for instance 0.001".to_string())
}

#[cfg(feature = "search")]
fn rel_width(text: &str) -> Result<f64, String> {
    let width = text.parse().ok().filter(|w: &f64| *w > 0.0 && *w < 1.0);
    width.ok_or_else(|| "a number between 0 and 1 is wanted, for instance 1e-9".to_string())
}

fn seconds(text: &str) -> Result<Duration, String> {
    let seconds = text.parse().ok().filter(|s: &f64| *s > 0.0);
    let limit = seconds.and_then(|s| Duration::try_from_secs_f64(s).ok());
    limit.ok_or_else(|| "a positive number of seconds is wanted, below 1e19".to_string())
}
