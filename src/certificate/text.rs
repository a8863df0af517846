//! The one spelling of a certificate, and its limits: docs/certificate-format.md, section 1.

use std::collections::BTreeMap;
use std::fmt::{self, Display, Write};

use num_bigint::BigInt;
use num_traits::{One, Zero};

use super::{Certificate, EndTree, Evidence, Foot, Node, Tube, Upper, curvature, pairs, polyline, squares};
use crate::error::{Error, ErrorKind};
use crate::number::{Rational, excerpt, over_limit, to_fraction_text};

/// The most bytes of a certificate: in memory its nodes take up to thirty times as much.
pub const MAX_CERTIFICATE_BYTES: usize = 32 << 20;
/// The most digits of an integer in a certificate.
pub const MAX_CERTIFICATE_DIGITS: usize = 20_000;

const HEAD: &str = "tubecert-certificate 1";

impl Certificate {
    /// Reads a certificate. Only the canonical spelling is accepted.
    ///
    /// # Errors
    /// [`ErrorKind::Limit`] beyond [`MAX_CERTIFICATE_BYTES`] or [`MAX_CERTIFICATE_DIGITS`]; [`ErrorKind::Certificate`] with the
    /// number of the line for all else.
    pub fn decode(bytes: &[u8]) -> Result<Self, Error> {
        if bytes.len() > MAX_CERTIFICATE_BYTES {
            let what = format_args!("a text of {} bytes", bytes.len());
            return Err(over_limit(what, MAX_CERTIFICATE_BYTES, "MAX_CERTIFICATE_BYTES"));
        }
        let text = std::str::from_utf8(bytes).map_err(|e| undecodable(0, "not ASCII").offset(e.valid_up_to()))?;
        let mut lines = Lines { rest: text.split('\n').peekable(), number: 0 };
        let certificate = lines.certificate()?;
        // one value, one spelling: whatever was read loosely is found here
        let written = certificate.encode();
        if written != text {
            let same = written.lines().zip(text.lines()).take_while(|(a, b)| a == b).count();
            return Err(undecodable(same + 1, "not the canonical spelling"));
        }
        Ok(certificate)
    }

    /// The canonical text.
    #[must_use]
    pub fn encode(&self) -> String {
        let (kind, text) = match &self.evidence {
            Evidence::Radius(tube) => ("radius", tube.encode()),
            Evidence::Pairs(pairs) => ("pairs", pairs.encode()),
            Evidence::Curvature(course) => ("curvature", course.encode()),
            Evidence::Squares(squares) => ("squares", squares.encode()),
            Evidence::Polyline(polyline) => ("polyline", polyline.encode()),
        };
        format!("{HEAD} {kind}\ncurve {}\n{text}end\n", self.digest)
    }

    /// How many leaves of the trees name each rule.
    pub(crate) fn leaves(&self) -> BTreeMap<&'static str, usize> {
        match &self.evidence {
            Evidence::Radius(tube) => tube.leaves(),
            Evidence::Pairs(pairs) => counted(pairs.along.iter().chain(&pairs.tree)),
            Evidence::Curvature(course) => course.leaves(),
            Evidence::Squares(squares) => squares.parts(),
            Evidence::Polyline(polyline) => polyline.parts(),
        }
    }
}

fn counted<'a>(nodes: impl Iterator<Item = &'a Node>) -> BTreeMap<&'static str, usize> {
    let mut leaves = BTreeMap::new();
    for node in nodes.filter(|node| !matches!(node, Node::Split | Node::SplitFirst | Node::SplitSecond)) {
        *leaves.entry(node.name()).or_default() += 1;
    }
    leaves
}

/// Writes the lines of a tree after its head.
pub(super) fn push_tree(out: &mut String, head: impl Display, nodes: &[Node]) {
    // writing to a String cannot fail
    let _ = writeln!(out, "{head}");
    for node in nodes {
        let _ = writeln!(out, "{node}");
    }
}

/// Rationals parted by spaces.
pub(super) fn list(numbers: &[Rational]) -> String {
    numbers.iter().map(to_fraction_text).collect::<Vec<_>>().join(" ")
}

impl Tube {
    /// How many leaves of the trees name each rule.
    pub(super) fn leaves(&self) -> BTreeMap<&'static str, usize> {
        let ends = self.ends.iter().flatten().map(|(_, nodes)| nodes);
        counted([&self.along].into_iter().chain(&self.pairs).chain(ends).flatten())
    }

    pub(super) fn encode(&self) -> String {
        let bound = |b: &Option<Rational>| b.as_ref().map_or("inf".to_string(), to_fraction_text);
        let mut out = format!("lo {}\nhi {}\n", bound(&self.lo), bound(&self.hi));
        push_tree(&mut out, "along", &self.along);
        if let Some(pairs) = &self.pairs {
            push_tree(&mut out, "pairs", pairs);
        }
        for (name, end) in ["start", "finish"].iter().zip(self.ends.iter().flatten()) {
            let ([x, y, z], nodes) = end;
            push_tree(&mut out, format_args!("{name} {x} {y} {z}"), nodes);
        }
        out + &match &self.upper {
            Upper::None => "upper none\n".to_string(),
            Upper::Curvature { span, t } => format!("upper curvature {span} {}\n", to_fraction_text(t)),
            Upper::Corner(joint) => format!("upper corner {joint}\n"),
            Upper::Contact { x, feet } => {
                let foot = |foot: &Foot| match foot {
                    Foot::Plane(p) => format!("plane {}\n", to_fraction_text(p)),
                    Foot::Valley(p) => format!("valley {}\n", list(p)),
                };
                format!("upper contact {}\n{}", list(x), feet.iter().map(foot).collect::<String>())
            }
            Upper::Crossing { arcs, normal, first, second } => {
                let [n, e, f] = [normal, first, second].map(|v| list(v));
                format!("upper crossing {}\nnormal {n}\nfirst {e}\nsecond {f}\n", list(arcs.as_flattened()))
            }
            Upper::Mirror { arcs, normal } => {
                format!("upper mirror {}\nnormal {}\n", list(arcs.as_flattened()), list(normal))
            }
        }
    }
}

impl Node {
    /// The first word of its line.
    const fn name(&self) -> &'static str {
        match self {
            Self::Split => "/",
            Self::SplitFirst => "1",
            Self::SplitSecond => "2",
            Self::Curved => "curved",
            Self::Cone(_) => "cone",
            Self::Slab(_) => "slab",
            Self::Side(_) => "side",
            Self::Bent(_) => "bent",
            Self::Local => "local",
            Self::Share(_) => "share",
            Self::Pair(_) => "pair",
            Self::Open => "open",
        }
    }
}

impl Display for Node {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())?;
        match self {
            Self::Cone([x, y, z]) | Self::Slab([x, y, z]) => write!(f, " {x} {y} {z}"),
            Self::Side([x, y]) => write!(f, " {x} {y}"),
            Self::Bent(fields) => fields.iter().try_for_each(|field| write!(f, " {field}")),
            Self::Share(k) => write!(f, " {k}"),
            Self::Pair(k) => write!(f, " {k}"),
            _ => Ok(()),
        }
    }
}

fn undecodable(line: usize, what: impl Display) -> Error {
    Error::new(ErrorKind::Certificate, format!("line {line}: {what}"))
        .help("write the certificate anew: run the command that wrote it with --certificate FILE")
}

/// The lines of a text, read loosely: that the spelling is canonical is checked by writing it again.
pub(super) struct Lines<'a> {
    rest: std::iter::Peekable<std::str::Split<'a, char>>,
    number: usize,
}

impl<'a> Lines<'a> {
    pub(super) fn error(&self, what: impl Display) -> Error {
        undecodable(self.number, what)
    }

    /// The fields of the next line after the words it must start with.
    pub(super) fn after(&mut self, words: &str) -> Result<Vec<&'a str>, Error> {
        self.number += 1;
        let line = self.rest.next().unwrap_or("");
        let rest = line.strip_prefix(words).ok_or_else(|| self.error(format_args!("wanted {words:?}")))?;
        Ok(rest.split(' ').filter(|field| !field.is_empty()).collect())
    }

    fn certificate(&mut self) -> Result<Certificate, Error> {
        let [kind] = self.fields(HEAD)?;
        let [digest] = self.fields("curve")?;
        if digest.len() != 64 || !digest.bytes().all(|c| matches!(c, b'0'..=b'9' | b'a'..=b'f')) {
            return Err(self.error("a digest has 64 lower-case hexadecimal digits"));
        }
        let evidence = match kind {
            "radius" => Evidence::Radius(self.tube()?),
            "pairs" => Evidence::Pairs(pairs::Evidence::decode(self)?),
            "curvature" => Evidence::Curvature(curvature::Course::read(self)?),
            "squares" => Evidence::Squares(squares::Evidence::decode(self)?),
            "polyline" => Evidence::Polyline(polyline::Evidence::decode(self)?),
            _ => return Err(undecodable(1, format_args!("this version knows no certificates of {}", excerpt(kind)))),
        };
        self.after("end")?;
        Ok(Certificate { digest: digest.to_string(), evidence })
    }

    pub(super) fn tube(&mut self) -> Result<Tube, Error> {
        let lo = self.bound("lo")?;
        let hi = self.bound("hi")?;
        self.after("along")?;
        let along = self.nodes();
        let bounded = lo.as_ref().is_some_and(|lo| !lo.is_zero());
        let pairs = if bounded { Some(self.after("pairs").map(|_| self.nodes())?) } else { None };
        let open = self.next_is("start");
        let ends = if bounded && open { Some([self.end_tree("start")?, self.end_tree("finish")?]) } else { None };
        let upper = self.upper()?;
        Ok(Tube { lo, hi, along, pairs, ends, upper })
    }

    pub(super) fn fields<const N: usize>(&mut self, words: &str) -> Result<[&'a str; N], Error> {
        let fields = self.after(words)?;
        let found = fields.len();
        fields.try_into().map_err(|_| self.error(format_args!("{found} fields after {words:?}; wanted {N}")))
    }

    /// The nodes up to the first line that is none.
    pub(super) fn nodes(&mut self) -> Vec<Node> {
        let mut nodes = vec![];
        while let Some(node) = self.rest.peek().and_then(|line| node(line)) {
            nodes.push(node);
            self.rest.next();
            self.number += 1;
        }
        nodes
    }

    fn end_tree(&mut self, name: &str) -> Result<EndTree, Error> {
        let fields: [&str; 3] = self.fields(name)?;
        let axis = whole(&fields).ok_or_else(|| self.error("wanted three integers"))?;
        Ok((axis, self.nodes()))
    }

    /// Does the next line start like this?
    pub(super) fn next_is(&mut self, start: &str) -> bool {
        self.rest.peek().is_some_and(|line| line.starts_with(start))
    }

    /// Two numbers of any sign; `inf` is `None`.
    pub(super) fn bounds(&self, fields: [&str; 2]) -> Result<[Option<Rational>; 2], Error> {
        let bound = |text: &str| if text == "inf" { Ok(None) } else { self.rational(text).map(Some) };
        Ok([bound(fields[0])?, bound(fields[1])?])
    }

    fn bound(&mut self, name: &str) -> Result<Option<Rational>, Error> {
        let [text] = self.fields(name)?;
        match text {
            "inf" => Ok(None),
            _ if text.starts_with('-') => Err(self.error("a bound is not negative")),
            _ => self.rational(text).map(Some),
        }
    }

    pub(super) fn rationals<const N: usize>(&self, fields: [&str; N]) -> Result<[Rational; N], Error> {
        let mut all = std::array::from_fn(|_| Rational::zero());
        for (place, text) in all.iter_mut().zip(fields) {
            *place = self.rational(text)?;
        }
        Ok(all)
    }

    pub(super) fn rational(&self, text: &str) -> Result<Rational, Error> {
        let (p, q) = match text.split_once('/') {
            Some((p, q)) => (self.integer(p)?, self.integer(q)?),
            None => (self.integer(text)?, BigInt::one()),
        };
        if q.is_zero() { Err(self.error("the denominator 0")) } else { Ok(Rational::new(p, q)) }
    }

    pub(super) fn integer(&self, text: &str) -> Result<BigInt, Error> {
        if text.strip_prefix('-').unwrap_or(text).len() > MAX_CERTIFICATE_DIGITS {
            let what = format_args!("line {}: a number of {} characters", self.number, text.len());
            return Err(over_limit(what, MAX_CERTIFICATE_DIGITS, "MAX_CERTIFICATE_DIGITS"));
        }
        BigInt::parse_bytes(text.as_bytes(), 10)
            .ok_or_else(|| self.error(format_args!("{} is no number", excerpt(text))))
    }

    fn upper(&mut self) -> Result<Upper, Error> {
        let fields = self.after("upper")?;
        match fields[..] {
            ["none"] => Ok(Upper::None),
            ["curvature", span, t] => Ok(Upper::Curvature { span: self.index(span)?, t: self.rational(t)? }),
            ["corner", joint] => Ok(Upper::Corner(self.index(joint)?)),
            ["contact", x, y, z] => {
                let x = self.rationals([x, y, z])?;
                Ok(Upper::Contact { x, feet: [self.foot()?, self.foot()?] })
            }
            [kind @ ("crossing" | "mirror"), s0, s1, t0, t1] => {
                let [s0, s1, t0, t1] = self.rationals([s0, s1, t0, t1])?;
                let arcs = [[s0, s1], [t0, t1]];
                let mut vector = |name| self.fields(name).and_then(|fields| self.rationals(fields));
                let normal = vector("normal")?;
                if kind == "mirror" {
                    return Ok(Upper::Mirror { arcs, normal });
                }
                Ok(Upper::Crossing { arcs, normal, first: vector("first")?, second: vector("second")? })
            }
            _ => Err(self.error("no witness of this kind")),
        }
    }

    fn foot(&mut self) -> Result<Foot, Error> {
        let fields = self.after("")?;
        match fields[..] {
            ["plane", p] => Ok(Foot::Plane(self.rational(p)?)),
            ["valley", a, p, b] => Ok(Foot::Valley(self.rationals([a, p, b])?)),
            _ => Err(self.error("wanted \"plane\" or \"valley\"")),
        }
    }

    pub(super) fn index(&self, text: &str) -> Result<usize, Error> {
        text.parse().map_err(|_| self.error(format_args!("{} is no index", excerpt(text))))
    }
}

fn whole<const N: usize>(fields: &[&str]) -> Option<[i64; N]> {
    let numbers: Vec<i64> = fields.iter().map(|f| f.parse().ok()).collect::<Option<_>>()?;
    numbers.try_into().ok()
}

fn node(line: &str) -> Option<Node> {
    let fields: Vec<&str> = line.split(' ').collect();
    let (name, rest) = fields.split_first()?;
    Some(match (*name, rest) {
        ("/", []) => Node::Split,
        ("1", []) => Node::SplitFirst,
        ("2", []) => Node::SplitSecond,
        ("curved", []) => Node::Curved,
        ("cone", rest) => Node::Cone(whole(rest)?),
        ("slab", rest) => Node::Slab(whole(rest)?),
        ("side", rest) => Node::Side(whole(rest)?),
        ("bent", rest) => Node::Bent(whole(rest)?),
        ("local", []) => Node::Local,
        ("share", [k]) => Node::Share(k.parse().ok()?),
        ("pair", [k]) => Node::Pair(k.parse().ok()?),
        ("open", []) => Node::Open,
        _ => return None,
    })
}
