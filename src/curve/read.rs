//! The reader of curve files: finds each key, reads each number exactly, and leaves validation to [`Curve`].

use num_traits::{One, Signed, ToPrimitive, Zero};

use super::{Curve, check_lengths};
use crate::error::{Error, ErrorKind};
use crate::json::{self, Node, Value};
use crate::number::{MAX_DEGREE, Rational, excerpt, parse_rational};
use crate::print::shown;

impl Curve {
    /// Reads a curve file. See [`Curve::from_json_slice`].
    ///
    /// # Errors
    /// As [`Curve::from_json_slice`].
    pub fn from_json_str(text: &str) -> Result<Self, Error> {
        Self::from_json_slice(text.as_bytes())
    }

    /// Reads a curve file. Every number is the rational it spells, never its nearest f64.
    ///
    /// Keys: `degree` and `control_points` (each of 2 coordinates, z being 0, or each of 3) must be there;
    /// `weights`, `knots`, `name`, `source`, `unit`, `schema` (1) may be; those that start with `x-` are ignored.
    ///
    /// # Errors
    /// With key, index and byte offset where there are such: those of [`json::parse`],
    /// [`parse_rational`] and [`Curve::new`], and [`ErrorKind::UnknownKey`], [`ErrorKind::MissingKey`],
    /// [`ErrorKind::WrongType`], [`ErrorKind::Schema`].
    ///
    /// ```
    /// use tubecert::{curve::Curve, error::ErrorKind};
    /// let curve = Curve::from_json_str(r#"{"degree": 1, "control_points": [[0, 0], [0.1, "1/3"]]}"#).unwrap();
    /// assert_eq!(curve.control_points()[1][1].denom(), &3.into());
    /// let error = Curve::from_json_str(r#"{"degree": 1, "control_points": [[0, 0], [1]]}"#).unwrap_err();
    /// assert_eq!((error.kind, error.index), (ErrorKind::WrongLength, Some(1)));
    /// ```
    pub fn from_json_slice(bytes: &[u8]) -> Result<Self, Error> {
        let file = FileKeys::of(json::parse(bytes)?)?;
        if let Some(node) = file.schema {
            check_schema(&node)?;
        }
        let degree = degree_of(&required(file.degree, "degree")?)?;
        let points = items(required(file.control_points, "control_points")?, "control_points")?;
        let weights = file.weights.map(|node| items(node, "weights")).transpose()?;
        let knots = file.knots.map(|node| items(node, "knots")).transpose()?;
        check_lengths(degree, points.len(), weights.as_ref().map(Vec::len), knots.as_ref().map(Vec::len))?;

        let (points, planar) = points_of(points)?;
        let weights = weights.map(|nodes| numbers_of(nodes, "weights")).transpose()?;
        let knots = knots.map(|nodes| numbers_of(nodes, "knots")).transpose()?;
        let mut curve = Self::validated(degree, points, weights, knots)?;
        curve.planar_in_file = planar;
        curve.name = file.name.map(|node| text_of(node, "name")).transpose()?;
        curve.source = file.source.map(|node| text_of(node, "source")).transpose()?;
        curve.unit = file.unit.map(|node| text_of(node, "unit")).transpose()?;
        Ok(curve)
    }
}

/// The values of a curve file by key.
#[derive(Default)]
struct FileKeys<'a> {
    schema: Option<Node<'a>>,
    degree: Option<Node<'a>>,
    control_points: Option<Node<'a>>,
    weights: Option<Node<'a>>,
    knots: Option<Node<'a>>,
    name: Option<Node<'a>>,
    source: Option<Node<'a>>,
    unit: Option<Node<'a>>,
}

impl<'a> FileKeys<'a> {
    fn of(root: Node<'a>) -> Result<Self, Error> {
        let Value::Object(members) = root.value else {
            let message = format!("a curve file is an object, not {}", root.value.what());
            return Err(Error::new(ErrorKind::WrongType, message)
                .offset(root.offset)
                .help("write {\"degree\": ..., \"control_points\": [...]}"));
        };
        let mut file = Self::default();
        for (key, node) in members {
            let place = match key.text.as_ref() {
                "schema" => &mut file.schema,
                "degree" => &mut file.degree,
                "control_points" => &mut file.control_points,
                "weights" => &mut file.weights,
                "knots" => &mut file.knots,
                "name" => &mut file.name,
                "source" => &mut file.source,
                "unit" => &mut file.unit,
                other if other.starts_with("x-") => continue,
                other => {
                    let message = format!("the key {} is unknown", excerpt(other));
                    return Err(Error::new(ErrorKind::UnknownKey, message).key(other).offset(key.offset).help(
                        "known are degree, control_points, weights, knots, name, source, unit, schema; keys of \
                         your own start with x-",
                    ));
                }
            };
            *place = Some(node);
        }
        Ok(file)
    }
}

fn required<'a>(node: Option<Node<'a>>, key: &str) -> Result<Node<'a>, Error> {
    node.ok_or_else(|| {
        Error::new(ErrorKind::MissingKey, format!("the key \"{key}\" is missing"))
            .key(key)
            .help("a curve file needs \"degree\" and \"control_points\"")
    })
}

fn wrong_type(node: &Node, key: &str, wanted: &str) -> Error {
    Error::new(ErrorKind::WrongType, format!("wanted {wanted}, found {}", node.value.what()))
        .key(key)
        .offset(node.offset)
}

fn items<'a>(node: Node<'a>, key: &str) -> Result<Vec<Node<'a>>, Error> {
    match node.value {
        Value::Array(items) => Ok(items),
        _ => Err(wrong_type(&node, key, "an array")),
    }
}

fn text_of(node: Node, key: &str) -> Result<String, Error> {
    match node.value {
        Value::String(text) => Ok(text.into_owned()),
        _ => Err(wrong_type(&node, key, "a string")),
    }
}

fn number_of(node: &Node, key: &str) -> Result<Rational, Error> {
    let text = match &node.value {
        Value::Number(text) => text,
        Value::String(text) => text.as_ref(),
        _ => return Err(wrong_type(node, key, "a number, or a string that spells one")),
    };
    parse_rational(text).map_err(|error| error.key(key).offset(node.offset))
}

fn numbers_of(nodes: Vec<Node>, key: &str) -> Result<Vec<Rational>, Error> {
    let read = |(index, node): (usize, Node)| number_of(&node, key).map_err(|error| error.index(index));
    nodes.into_iter().enumerate().map(read).collect()
}

/// The control points, and whether each has two coordinates.
fn points_of(nodes: Vec<Node>) -> Result<(Vec<[Rational; 3]>, bool), Error> {
    const KEY: &str = "control_points";
    let mut points = Vec::with_capacity(nodes.len());
    let mut dimension = None;
    for (index, node) in nodes.into_iter().enumerate() {
        let offset = node.offset;
        let coordinates = items(node, KEY).map_err(|error| error.index(index))?;
        let found = coordinates.len();
        if found != dimension.unwrap_or(found) || !(2..=3).contains(&found) {
            let wanted =
                dimension.map_or("2 or 3".to_string(), |first: usize| format!("{first} as in the first point"));
            return Err(Error::new(ErrorKind::WrongLength, format!("a point of {found} coordinates; wanted {wanted}"))
                .key(KEY)
                .index(index)
                .offset(offset)
                .help("give every point 2 coordinates (z = 0) or every point 3; weights go into \"weights\""));
        }
        dimension = Some(found);
        let mut point = [Rational::zero(), Rational::zero(), Rational::zero()];
        for (coordinate, node) in point.iter_mut().zip(&coordinates) {
            *coordinate = number_of(node, KEY).map_err(|error| error.index(index))?;
        }
        points.push(point);
    }
    Ok((points, dimension == Some(2)))
}

fn degree_of(node: &Node) -> Result<usize, Error> {
    let degree = number_of(node, "degree")?;
    if !degree.is_integer() || degree.is_negative() {
        return Err(Error::new(ErrorKind::Number, format!("the degree {} is not a whole number", shown(&degree)))
            .key("degree")
            .offset(node.offset)
            .help(format!("give a degree of 1 to {MAX_DEGREE}")));
    }
    // A degree too large for a usize is over the limit like usize::MAX.
    Ok(degree.numer().to_usize().unwrap_or(usize::MAX))
}

fn check_schema(node: &Node) -> Result<(), Error> {
    let schema = number_of(node, "schema")?;
    if schema.is_one() {
        return Ok(());
    }
    Err(Error::new(ErrorKind::Schema, format!("schema {} is not known; this version reads 1", shown(&schema)))
        .key("schema")
        .offset(node.offset)
        .help("update tubecert, or write the file for schema 1"))
}
