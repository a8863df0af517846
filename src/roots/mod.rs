//! Certified roots of polynomials with rational coefficients: all of them, with multiplicities, nothing guessed.

mod common;
mod complex;
mod fast;
mod power;
mod real;

pub(crate) use common::{Place, common_factor, common_zero, halves};
pub(crate) use complex::complex_roots_while;
pub use complex::{ComplexRoot, complex_roots};
pub(crate) use power::to_bernstein;
pub(crate) use real::roots_inside;
pub use real::{RealRoot, real_roots};
