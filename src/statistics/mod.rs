//! Distributions, estimates and tests: numbers only, no pictures.
//!
//! A test of a random result states the rate of its false alarms, and whether it could
//! have seen what it looks for: [`Verdict::Inconclusive`] is not a pass.
//!
//! To test that drawn directions have the density that goes with them:
//!
//! ```
//! use steradian::statistics::{DirectionGrid, FALSE_ALARM, Verdict};
//!
//! // Of every 1000 numbers here a direction, cosine weighted; None is a draw that failed.
//! let draws = (0..100_000).map(|i| {
//!     let (u, v) = ((i as f64 * 0.754_877_666).fract(), (i as f64 * 0.569_840_29).fract());
//!     let phi = std::f64::consts::TAU * v;
//!     Some([u.sqrt() * phi.cos(), u.sqrt() * phi.sin(), (1.0 - u).sqrt()])
//! });
//! let grid = DirectionGrid::hemisphere([0.0, 0.0, 1.0], 16, 32);
//! let fit = grid.test(draws, |d| d[2] / std::f64::consts::PI);
//! assert_eq!(fit.verdict(FALSE_ALARM), Verdict::Agrees, "{fit}");
//! ```

mod chi_square;
mod direction_grid;
mod distribution;
mod estimate;
mod level;
mod quadrature;

pub use chi_square::{GoodnessOfFit, LEAST_EXPECTED};
pub use direction_grid::DirectionGrid;
pub use distribution::{
    binomial_survival, chi_square_survival, normal_cdf, normal_quantile, normal_survival,
    student_t_cdf, student_t_quantile, student_t_survival,
};
pub use estimate::{Criterion, Estimate, Welch};
pub use level::{CHANCE, FALSE_ALARM, sidak, wilson_interval};
pub use quadrature::integrate_rectangle;

/// What a test found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// No difference beyond what chance explains, and one of the size in question would show.
    Agrees,
    /// More than chance explains.
    Differs,
    /// No difference seen, but too little data for one to show.
    Inconclusive,
}
