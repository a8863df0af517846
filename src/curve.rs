//! The exact data of a curve: read from a file or given by a caller, validated once, never repaired.

mod read;

use num_traits::{One, Zero};
use sha2::{Digest, Sha256};

use crate::error::{Error, ErrorKind};
use crate::number::{MAX_CONTROL_POINTS, MAX_DEGREE, Rational, compare, over_limit, same, to_fraction_text};
use crate::print::shown;

/// A rational B-spline curve in space as exact data: degree, control points, weights and the full knot vector.
///
/// The curve is `sum w_i P_i N_i(t) / sum w_i N_i(t)` on [`domain`](Self::domain). What every value of this type
/// satisfies, because the constructors refuse all else:
/// - the degree is 1 to [`MAX_DEGREE`]; there are degree + 1 to [`MAX_CONTROL_POINTS`] points, a weight for each, and
///   points + degree + 1 knots, clamped or not;
/// - the knots do not decrease, the domain is not empty, no knot strictly inside it has a multiplicity above the degree;
/// - every number is in lowest terms and can be written within the limits of [`crate::number`].
///
/// Whether the denominator has a zero on the domain or the curve is regular there is not decided here.
#[derive(Debug, Clone)]
pub struct Curve {
    degree: usize,
    control_points: Vec<[Rational; 3]>,
    weights: Vec<Rational>,
    knots: Vec<Rational>,
    pub(crate) planar_in_file: bool,
    pub(crate) name: Option<String>,
    pub(crate) source: Option<String>,
    pub(crate) unit: Option<String>,
}

impl Curve {
    /// [`Curve::new`] for numbers that are in lowest terms and within the limits: the place of all other validation.
    pub(crate) fn validated(
        degree: usize,
        control_points: Vec<[Rational; 3]>,
        weights: Option<Vec<Rational>>,
        knots: Option<Vec<Rational>>,
    ) -> Result<Self, Error> {
        let points = control_points.len();
        check_lengths(degree, points, weights.as_ref().map(Vec::len), knots.as_ref().map(Vec::len))?;
        let weights = weights.unwrap_or_else(|| vec![Rational::one(); points]);
        let knots = knots.unwrap_or_else(|| {
            let mut knots = vec![Rational::zero(); degree + 1];
            knots.resize(2 * (degree + 1), Rational::one());
            knots
        });
        check_knots(degree, points, &knots)?;
        let planar_in_file = false;
        Ok(Self { degree, control_points, weights, knots, planar_in_file, name: None, source: None, unit: None })
    }

    /// The degree.
    #[must_use]
    pub const fn degree(&self) -> usize {
        self.degree
    }

    /// The control points, not multiplied by their weights.
    #[must_use]
    pub fn control_points(&self) -> &[[Rational; 3]] {
        &self.control_points
    }

    /// The weights, one for each control point; of any sign, 0 included.
    #[must_use]
    pub fn weights(&self) -> &[Rational] {
        &self.weights
    }

    /// The full knot vector: points + degree + 1 knots.
    #[must_use]
    pub fn knots(&self) -> &[Rational] {
        &self.knots
    }

    /// The text whose SHA-256 is the [`digest`](Self::digest). Lines that end in one line feed; numbers as `p` or `p/q`
    /// in lowest terms (q > 1, no sign but a leading `-`, no leading zeros), coordinates parted by one space:
    /// ```text
    /// tubecert-curve 1
    /// degree D
    /// knot T              one line for each knot
    /// point X Y Z         these two lines for each control point
    /// weight W
    /// ```
    /// Equal texts mean equal degree, knots, points and weights. Name, source and unit do not count; it is the same
    /// for z left out and z = 0, for weights left out and all 1, for a Bezier segment without and with its knots.
    #[must_use]
    pub fn canonical_text(&self) -> String {
        self.canonical_lines().collect()
    }

    /// The SHA-256 of [`canonical_text`](Self::canonical_text) as 64 lowercase hexadecimal digits.
    #[must_use]
    pub fn digest(&self) -> String {
        let mut hash = Sha256::new();
        for line in self.canonical_lines() {
            hash.update(line);
        }
        hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
    }

    fn canonical_lines(&self) -> impl Iterator<Item = String> {
        let knots = self.knots.iter().map(|knot| format!("knot {}\n", to_fraction_text(knot)));
        let points = self.control_points.iter().zip(&self.weights).map(|([x, y, z], weight)| {
            let [x, y, z, weight] = [x, y, z, weight].map(to_fraction_text);
            format!("point {x} {y} {z}\nweight {weight}\n")
        });
        std::iter::once(format!("tubecert-curve 1\ndegree {}\n", self.degree)).chain(knots).chain(points)
    }
}

/// The degree and every length, before a number is read.
pub(crate) fn check_lengths(
    degree: usize,
    points: usize,
    weights: Option<usize>,
    knots: Option<usize>,
) -> Result<(), Error> {
    if degree == 0 {
        return Err(Error::new(ErrorKind::Limit, format!("the degree is 0; it must be 1 to {MAX_DEGREE}"))
            .key("degree")
            .help("join the points by a curve of degree 1 or more"));
    }
    if degree > MAX_DEGREE {
        return Err(over_limit(format_args!("the degree {degree}"), MAX_DEGREE, "MAX_DEGREE")
            .key("degree")
            .help("split the curve into pieces of lower degree"));
    }
    if points > MAX_CONTROL_POINTS {
        return Err(over_limit(format_args!("{points} control points"), MAX_CONTROL_POINTS, "MAX_CONTROL_POINTS")
            .key("control_points")
            .help("cut the curve into several files"));
    }
    if points <= degree {
        let wanted = format_args!("at least {} for degree {degree}", degree + 1);
        return Err(wrong_length("control_points", points, wanted).help("add control points or lower the degree"));
    }
    if knots.is_none() && points != degree + 1 {
        let help = format!("add \"knots\" ({} of them) or set the degree to {}", points + degree + 1, points - 1);
        let wanted = format_args!("{} for degree {degree} without knots", degree + 1);
        return Err(wrong_length("control_points", points, wanted).help(help));
    }
    if let Some(weights) = weights
        && weights != points
    {
        let wanted = format_args!("{points}, one for each control point");
        return Err(wrong_length("weights", weights, wanted)
            .help("give every control point a weight, or leave \"weights\" out if all are 1"));
    }
    if let Some(knots) = knots
        && knots != points + degree + 1
    {
        let wanted = format_args!("{} = points + degree + 1 = {points} + {degree} + 1", points + degree + 1);
        return Err(wrong_length("knots", knots, wanted).help(
            "write every knot as often as it counts; some programs leave out the first and the last: repeat those",
        ));
    }
    Ok(())
}

fn wrong_length(key: &str, found: usize, wanted: impl std::fmt::Display) -> Error {
    Error::new(ErrorKind::WrongLength, format!("{found} entries; wanted {wanted}")).key(key)
}

/// Order, domain and multiplicity of `points + degree + 1` knots.
fn check_knots(degree: usize, points: usize, knots: &[Rational]) -> Result<(), Error> {
    let error = |kind, index, message| Error::new(kind, message).key("knots").index(index);
    for (index, (before, knot)) in knots.iter().zip(knots.iter().skip(1)).enumerate() {
        if compare(before, knot).is_gt() {
            let message = format!("{} follows {}; knots must not decrease", shown(knot), shown(before));
            return Err(
                error(ErrorKind::KnotOrder, index + 1, message).help("put the knots in order; none is moved here")
            );
        }
    }
    let (Some(start), Some(end)) = (knots.get(degree), knots.get(points)) else {
        return Err(wrong_length("knots", knots.len(), points + degree + 1));
    };
    if same(start, end) {
        let message = format!("the domain knots[{degree}] .. knots[{points}] is empty: both are {}", shown(start));
        return Err(error(ErrorKind::EmptyDomain, degree, message).help("the domain must have a positive length"));
    }
    for (index, window) in knots.windows(degree + 1).enumerate() {
        let (Some(first), Some(last)) = (window.first(), window.last()) else { continue };
        if same(first, last) && compare(start, first).is_lt() && compare(first, end).is_lt() {
            let message = format!("the knot {} stands more than {degree} times inside the domain", shown(first));
            return Err(error(ErrorKind::KnotMultiplicity, index + degree, message)
                .help("a knot may stand as often as the degree there; split a curve that jumps into two files"));
        }
    }
    Ok(())
}
