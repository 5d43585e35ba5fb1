//! The statistics that decide all other tests: exact where there are published values,
//! calibrated under the null, and able to see what they look for.

mod directions;
mod distributions;
mod estimates;
mod metrics;
mod pictures;
mod random;
