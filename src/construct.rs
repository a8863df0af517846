//! Curves from numbers of a caller, and back to files. Outside the trust line: all validation is in [`Curve`] itself.

use num_traits::Zero;

use crate::certificate::{Certificate, Evidence, Tube};
use crate::claim::{Claim, Statement};
use crate::curve::{Curve, check_lengths};
use crate::error::{Error, ErrorKind};
use crate::number::{MAX_DIGITS, MAX_EXPONENT, Rational, over_limit, parse_rational};
use crate::print::exact_text;

/// What stands in a curve file besides the curve: nothing is proved about it.
#[derive(Debug, Clone, Default)]
pub(crate) struct Notes {
    pub planar: bool,
    pub name: Option<String>,
    pub source: Option<String>,
    pub unit: Option<String>,
}

impl Curve {
    /// Reads a curve file. See [`Curve::from_json_slice`].
    ///
    /// # Errors
    /// As [`Curve::from_json_slice`].
    ///
    /// ```
    /// use tubecert::{curve::Curve, error::ErrorKind};
    /// let curve = Curve::from_json_str(r#"{"degree": 1, "control_points": [[0, 0], [0.1, "1/3"]]}"#).unwrap();
    /// assert_eq!(curve.control_points()[1][1].denom(), &3.into());
    /// let error = Curve::from_json_str(r#"{"degree": 1, "control_points": [[0, 0], [1]]}"#).unwrap_err();
    /// assert_eq!((error.kind, error.index), (ErrorKind::WrongLength, Some(1)));
    /// ```
    pub fn from_json_str(text: &str) -> Result<Self, Error> {
        Self::from_json_slice(text.as_bytes())
    }

    /// The curve of this data, taken exactly. Without `weights` all are 1; without `knots` the points are one Bezier
    /// segment on [0, 1].
    ///
    /// # Errors
    /// With the key and the index of the first fault: [`ErrorKind::Limit`] (degree, number of points, a number too
    /// long), [`ErrorKind::WrongLength`], [`ErrorKind::KnotOrder`] (index of the first knot below the one before),
    /// [`ErrorKind::EmptyDomain`], [`ErrorKind::KnotMultiplicity`] (index of the first knot too many),
    /// [`ErrorKind::Number`] (a `Rational` made with the denominator 0).
    ///
    /// ```
    /// use tubecert::{curve::Curve, error::ErrorKind, number::Rational};
    /// let q = |n: i64| Rational::from_integer(n.into());
    /// let points = vec![[q(0), q(0), q(0)], [q(1), q(0), q(0)]];
    /// assert_eq!(Curve::new(1, points.clone(), None, None).unwrap().knots().len(), 4);
    /// let error = Curve::new(1, points, None, Some(vec![q(0), q(1), q(0), q(1)])).unwrap_err();
    /// assert_eq!((error.kind, error.key.as_deref(), error.index), (ErrorKind::KnotOrder, Some("knots"), Some(2)));
    /// ```
    pub fn new(
        degree: usize,
        control_points: Vec<[Rational; 3]>,
        weights: Option<Vec<Rational>>,
        knots: Option<Vec<Rational>>,
    ) -> Result<Self, Error> {
        check_lengths(degree, control_points.len(), weights.as_ref().map(Vec::len), knots.as_ref().map(Vec::len))?;
        let mut tidy_points = Vec::with_capacity(control_points.len());
        for (index, [x, y, z]) in control_points.into_iter().enumerate() {
            let tidy = |number| tidy(number, "control_points", index);
            tidy_points.push([tidy(x)?, tidy(y)?, tidy(z)?]);
        }
        let weights = weights.map(|numbers| tidy_all(numbers, "weights")).transpose()?;
        let knots = knots.map(|numbers| tidy_all(numbers, "knots")).transpose()?;
        Self::validated(degree, tidy_points, weights, knots)
    }

    /// The first and the last parameter, `knots[degree]` < `knots[points]`.
    #[must_use]
    pub fn domain(&self) -> (&Rational, &Rational) {
        // In range by the number of knots, which the constructor has checked.
        (&self.knots()[self.degree()], &self.knots()[self.control_points().len()])
    }

    /// Whether the file gave two coordinates for each point. It makes no difference to the curve or its digest.
    #[must_use]
    pub const fn is_planar_in_file(&self) -> bool {
        self.notes.planar
    }

    /// The name, free text.
    #[must_use]
    pub fn name(&self) -> Option<&str> {
        self.notes.name.as_deref()
    }

    /// Where the data comes from, free text.
    #[must_use]
    pub fn source(&self) -> Option<&str> {
        self.notes.source.as_deref()
    }

    /// The unit of length, free text.
    #[must_use]
    pub fn unit(&self) -> Option<&str> {
        self.notes.unit.as_deref()
    }

    /// The same curve with this name.
    #[must_use]
    pub fn with_name(mut self, name: impl Into<String>) -> Self {
        self.notes.name = Some(name.into());
        self
    }

    /// The same curve with this source.
    #[must_use]
    pub fn with_source(mut self, source: impl Into<String>) -> Self {
        self.notes.source = Some(source.into());
        self
    }

    /// The same curve with this unit of length.
    #[must_use]
    pub fn with_unit(mut self, unit: impl Into<String>) -> Self {
        self.notes.unit = Some(unit.into());
        self
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

    /// A curve file that [`Curve::from_json_str`] reads back as exactly this value. Numbers that are short decimals
    /// are JSON numbers, the others strings; weights and knots are always written.
    #[must_use]
    pub fn to_json(&self) -> String {
        let mut out = String::from("{\n  \"schema\": 1");
        for (key, text) in [("name", &self.notes.name), ("source", &self.notes.source), ("unit", &self.notes.unit)] {
            if let Some(text) = text {
                out.push_str(&format!(",\n  \"{key}\": {}", serde_json::Value::from(text.as_str())));
            }
        }
        out.push_str(&format!(",\n  \"degree\": {},\n  \"control_points\": [", self.degree()));
        for (index, [x, y, z]) in self.control_points().iter().enumerate() {
            out.push_str(if index == 0 { "\n    [" } else { ",\n    [" });
            push_list(&mut out, [x, y].into_iter().chain((!self.notes.planar).then_some(z)));
            out.push(']');
        }
        out.push_str("\n  ],\n  \"weights\": [");
        push_list(&mut out, self.weights());
        out.push_str("],\n  \"knots\": [");
        push_list(&mut out, self.knots());
        out.push_str("]\n}\n");
        out
    }
}

/// Writes numbers parted by commas, those that are no JSON numbers in quotes.
fn push_list<'a>(out: &mut String, numbers: impl IntoIterator<Item = &'a Rational>) {
    for (index, number) in numbers.into_iter().enumerate() {
        if index > 0 {
            out.push_str(", ");
        }
        let text = exact_text(number);
        let quoted = text.len() > 40 || text.contains('/') || text.starts_with('.') || text.starts_with("-.");
        if quoted { out.push_str(&format!("\"{text}\"")) } else { out.push_str(&text) }
    }
}

/// A caller's number in lowest terms, if it can be written within the limits.
fn tidy(number: Rational, key: &str, index: usize) -> Result<Rational, Error> {
    if number.denom().is_zero() {
        return Err(Error::new(ErrorKind::Number, "a number has the denominator 0").key(key).index(index));
    }
    // A number of b bits has at most 0.302 b + 1 digits, and one that can be written at most 10/3 bits for each
    // digit and each unit of the exponent.
    let (p, q) = (number.numer().bits(), number.denom().bits());
    let all_can = 3 * MAX_DIGITS as u64;
    let none_can = (MAX_DIGITS + MAX_EXPONENT) as u64 * 10 / 3;
    if p <= none_can && q <= none_can {
        let number = number.reduced();
        if p + q <= all_can || parse_rational(&exact_text(&number)).is_ok() {
            return Ok(number);
        }
    }
    Err(over_limit(format_args!("a fraction of {p} over {q} bits"), MAX_DIGITS, "MAX_DIGITS")
        .key(key)
        .index(index)
        .help("round the number; what is proved then holds for the rounded curve"))
}

fn tidy_all(numbers: Vec<Rational>, key: &str) -> Result<Vec<Rational>, Error> {
    numbers.into_iter().enumerate().map(|(index, number)| tidy(number, key, index)).collect()
}

impl Certificate {
    /// The strongest claim about `curve` that this evidence would prove.
    #[must_use]
    pub fn claim(&self, curve: Curve) -> Claim {
        let statement = match &self.evidence {
            Evidence::Radius(Tube { lo, hi, .. }) => Statement::Radius { lo: lo.clone(), hi: hi.clone() },
            Evidence::Pairs(pairs) => Statement::Pairs(pairs.claim.clone()),
            Evidence::Curvature(course) => Statement::Curvature(course.claim.clone()),
            Evidence::Polyline(polyline) => Statement::Polyline(polyline.claim.clone()),
            Evidence::Squares(squares) => {
                Statement::Squares(squares.segments.iter().map(|segment| segment.claim.clone()).collect())
            }
        };
        Claim { curve, statement }
    }
}
