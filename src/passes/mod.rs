//! One file for each entry shader, of the same name.

mod float_environment;
mod path_trace;
mod tuning;

pub use float_environment::FloatEnvironment;
pub use path_trace::{PathTrace, Work};
pub use tuning::Tuning;
