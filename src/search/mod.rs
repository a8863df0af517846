//! Everything that finds: f64 first, exact where f64 cannot tell, budgets that only widen.

pub(crate) mod body;
pub(crate) mod curvature;
pub(crate) mod ends;
pub(crate) mod frame;
pub(crate) mod meter;
pub(crate) mod tree;
pub(crate) mod witness;
