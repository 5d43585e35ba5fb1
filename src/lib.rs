//! Steradian, a physically based path tracer for glTF 2.0.
pub mod error;
pub mod scene;
pub mod settings;
pub use error::{Error, Result};
