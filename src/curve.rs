//! The exact data of a curve: read from a file or given by a caller, validated once, never repaired.
#![deny(clippy::float_arithmetic, clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]

use num_traits::{One, ToPrimitive, Zero};
use serde::de::{Deserializer, MapAccess, Visitor};
use serde_json::{from_str, value::RawValue};
use sha2::{Digest, Sha256};

use crate::construct::Notes;
use crate::error::{Result, reading, reading::Value};
use crate::number::{MAX_BYTES, MAX_CONTROL_POINTS, MAX_DEGREE, Rational, compare, parse_rational, same};

/// A rational B-spline curve in space as exact data: degree, control points, weights and the full knot vector.
///
/// The curve is `sum w_i P_i N_i(t) / sum w_i N_i(t)` on [`domain`](Self::domain). Whether the denominator has a zero
/// or the curve is regular there is not decided here. What every value of this type satisfies:
/// - the degree is 1 to [`MAX_DEGREE`]; there are degree + 1 to [`MAX_CONTROL_POINTS`] points, a weight for each, and
///   points + degree + 1 knots, clamped or not;
/// - the knots do not decrease, the domain is not empty, no knot strictly inside it has a multiplicity above the degree;
/// - every number is in lowest terms and can be written within the limits of [`crate::number`].
#[derive(Debug, Clone)]
pub struct Curve {
    degree: usize,
    control_points: Vec<[Rational; 3]>,
    weights: Vec<Rational>,
    knots: Vec<Rational>,
    pub(crate) notes: Notes,
}

impl Curve {
    /// Reads a curve file (docs/interface.md). Every number is the rational it spells, never its nearest f64.
    ///
    /// # Errors
    /// With key, index and byte offset where there are such: those of [`parse_rational`] and [`Curve::new`]; `Limit` for
    /// more than [`MAX_BYTES`]; `Syntax`, `UnknownKey`, `DuplicateKey`, `MissingKey`, `WrongType`, `Schema`.
    pub fn from_json_slice(bytes: &[u8]) -> Result<Self> {
        if bytes.len() > MAX_BYTES {
            return Err(reading::too_many_bytes(bytes.len()));
        }
        let file = str::from_utf8(bytes).map_err(reading::not_utf8)?;
        let root: &RawValue = from_str(file).map_err(|error| reading::not_json(file, file, &error))?;
        let root = Value { file, key: "", index: None, text: root.get() };
        let known = ["degree", "control_points", "weights", "knots", "name", "source", "unit", "schema"];
        let members = serde_json::Deserializer::from_str(root.text).deserialize_map(Members);
        let mut values = std::collections::BTreeMap::new();
        for (name, value) in members.map_err(|_| root.not_an_object())? {
            let name = Value { text: name.get(), ..root };
            let key = name.string()?;
            if !known.contains(&key.as_str()) && !key.starts_with("x-") {
                return Err(name.unknown_key());
            }
            if values.insert(key, value.get()).is_some() {
                return Err(name.duplicate_key());
            }
        }
        let value = |key| values.get(key).map(|text| Value { key, text, ..root });

        match value("schema") {
            Some(schema) if !schema.number()?.is_one() => return Err(schema.unknown_schema()),
            _ => {}
        }
        let degree = value("degree").ok_or_else(|| reading::missing_key("degree"))?;
        let whole = Some(degree.number()?).filter(Rational::is_integer).and_then(|degree| degree.to_usize());
        let degree = whole.ok_or_else(|| degree.not_a_degree())?;
        let mut points =
            value("control_points").ok_or_else(|| reading::missing_key("control_points"))?.items()?.peekable();
        let weights = value("weights").map(Value::items).transpose()?;
        let knots = value("knots").map(Value::items).transpose()?;
        check_lengths(degree, points.len(), weights.as_ref().map(|w| w.len()), knots.as_ref().map(|k| k.len()))?;

        let dimension = points.peek().map(|first| first.items()).transpose()?.map_or(0, |first| first.len());
        let point = |point: Value| match (point.items()?.collect::<Vec<_>>().as_slice(), dimension) {
            ([x, y], 2) => Ok([x.number()?, y.number()?, Rational::zero()]),
            ([x, y, z], 3) => Ok([x.number()?, y.number()?, z.number()?]),
            (found, _) => Err(point.wrong_dimension(found.len(), dimension)),
        };
        let points = points.map(point).collect::<Result<_>>()?;
        let weights = weights.map(|weights| weights.map(Value::number).collect::<Result<_>>()).transpose()?;
        let knots = knots.map(|knots| knots.map(Value::number).collect::<Result<_>>()).transpose()?;
        let text = |key| value(key).map(Value::string).transpose();
        let notes = Notes { planar: dimension == 2, name: text("name")?, source: text("source")?, unit: text("unit")? };
        Ok(Self { notes, ..Self::validated(degree, points, weights, knots)? })
    }

    /// The curve of numbers that are in lowest terms and within the limits: the place of all other validation.
    pub(crate) fn validated(
        degree: usize,
        control_points: Vec<[Rational; 3]>,
        weights: Option<Vec<Rational>>,
        knots: Option<Vec<Rational>>,
    ) -> Result<Self> {
        let points = control_points.len();
        check_lengths(degree, points, weights.as_ref().map(Vec::len), knots.as_ref().map(Vec::len))?;
        let weights = weights.unwrap_or_else(|| vec![Rational::one(); points]);
        let knots = knots.unwrap_or_else(|| [Rational::zero(), Rational::one()].map(|x| vec![x; degree + 1]).concat());
        if !knots_fit(degree, points, &knots) {
            return Err(reading::wrong_knots(degree, points, &knots));
        }
        Ok(Self { degree, control_points, weights, knots, notes: Notes::default() })
    }

    /// The degree.
    pub const fn degree(&self) -> usize {
        self.degree
    }

    /// The control points, not multiplied by their weights.
    pub fn control_points(&self) -> &[[Rational; 3]] {
        &self.control_points
    }

    /// The weights, one for each control point; of any sign, 0 included.
    pub fn weights(&self) -> &[Rational] {
        &self.weights
    }

    /// The full knot vector: points + degree + 1 knots.
    pub fn knots(&self) -> &[Rational] {
        &self.knots
    }

    /// The SHA-256, in hexadecimal, of the canonical text (docs/certificate-format.md, section 1) in its lines.
    pub fn digest(&self) -> String {
        let hash = self.canonical_lines().fold(Sha256::new(), |hash, line| hash.chain_update(line));
        hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
    }

    pub(crate) fn canonical_lines(&self) -> impl Iterator<Item = String> {
        let knots = self.knots.iter().map(|knot| format!("knot {knot}\n"));
        let points = self.control_points.iter().zip(&self.weights);
        let points = points.map(|([x, y, z], weight)| format!("point {x} {y} {z}\nweight {weight}\n"));
        std::iter::once(format!("tubecert-curve 1\ndegree {}\n", self.degree)).chain(knots).chain(points)
    }
}

/// Whether degree and lengths fit one another and the limits: asked before a number is read.
pub(crate) fn check_lengths(degree: usize, points: usize, weights: Option<usize>, knots: Option<usize>) -> Result<()> {
    let fit = (1..=MAX_DEGREE).contains(&degree)
        && (degree + 1..=MAX_CONTROL_POINTS).contains(&points)
        && weights.is_none_or(|weights| weights == points)
        && knots.map_or(points == degree + 1, |knots| knots == points + degree + 1);
    if fit { Ok(()) } else { Err(reading::wrong_lengths(degree, points, weights, knots)) }
}

/// Order, domain and multiplicity of `points + degree + 1` knots.
fn knots_fit(degree: usize, points: usize, knots: &[Rational]) -> bool {
    let Some(domain @ [start, .., end]) = knots.get(degree..=points) else { return false };
    let crowded = |run: &[Rational]| matches!(run, [a, .., b] if same(a, b) && !same(a, start) && !same(b, end));
    let ordered = knots.is_sorted_by(|before, knot| compare(before, knot).is_le());
    ordered && !same(start, end) && !domain.windows(degree + 1).any(crowded)
}

impl<'a> Value<'a> {
    /// The values of an array; those of an array in an array have the index of that.
    fn items(self) -> Result<impl ExactSizeIterator<Item = Self>> {
        let items = from_str::<Vec<&'a RawValue>>(self.text).map_err(|_| self.wrong_type("an array"))?.into_iter();
        Ok(items.enumerate().map(move |(i, raw)| Self { index: self.index.or(Some(i)), text: raw.get(), ..self }))
    }

    fn string(self) -> Result<String> {
        from_str(self.text).map_err(|error| self.not_a_string(&error))
    }

    /// What a JSON number is or a string spells; no other value spells one.
    pub(crate) fn number(self) -> Result<Rational> {
        let read = if self.text.starts_with('"') { parse_rational(&self.string()?) } else { parse_rational(self.text) };
        read.map_err(|error| self.not_a_number(error))
    }
}

/// Collects the members of an object: keys and values as they are spelled.
struct Members;

impl<'a> Visitor<'a> for Members {
    type Value = Vec<(&'a RawValue, &'a RawValue)>;

    fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<A: MapAccess<'a>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        std::iter::from_fn(|| map.next_entry().transpose()).collect()
    }
}
