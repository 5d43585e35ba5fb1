//! One file for each entry shader, of the same name.

mod path_trace;

pub use path_trace::{PathTrace, Work};
