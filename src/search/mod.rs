//! Everything that finds: f64 first, exact where f64 cannot tell, budgets that only widen.

pub(crate) mod apart;
pub(crate) mod body;
pub(crate) mod contact;
pub(crate) mod critical;
pub(crate) mod curvature;
pub(crate) mod dyadic;
pub(crate) mod ends;
pub(crate) mod evidence;
pub(crate) mod follow;
pub(crate) mod frame;
pub(crate) mod kappa;
pub(crate) mod meter;
pub(crate) mod newton;
pub(crate) mod pairs;
pub(crate) mod polyline;
pub(crate) mod rims;
pub(crate) mod rules;
pub(crate) mod squares;
pub(crate) mod stationary;
pub(crate) mod strand;
pub(crate) mod tree;
pub(crate) mod twist;
pub(crate) mod witness;
