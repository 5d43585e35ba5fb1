//! From the scene's needs to WGSL text: [`Features`] says what, [`compose`]
//! joins the modules of `shaders/`, [`generated`] writes the numbers that Rust
//! and WGSL share. Knows no device.

mod compose;
mod features;
pub mod generated;
mod library;
mod material_features;
mod sobol;

pub use compose::{Composed, LineOrigin, compose};
pub use features::{Feature, Features};
pub use library::{Library, library};
