//! One file for each entry shader, of the same name.

mod path_trace;
mod tuning;

pub use path_trace::{PathTrace, Work};
pub use tuning::Tuning;
