//! Certified roots of polynomials with rational coefficients: all of them, with multiplicities, nothing guessed.

mod common;
mod power;
mod real;

pub(crate) use common::{Place, common_zero};
pub use real::{RealRoot, real_roots};
