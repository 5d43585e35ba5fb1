//! One file for each entry shader, of the same name; `adaptive` runs five that belong together.

mod adaptive;
mod first_hit;
mod float_environment;
mod path_trace;
mod tuning;

pub use adaptive::{ActiveList, Adaptive};
pub use first_hit::{Extras, FirstHits, RayId};
pub use float_environment::FloatEnvironment;
pub use path_trace::{PathTrace, Work};
pub use tuning::Tuning;
