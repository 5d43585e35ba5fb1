//! Steradian, a physically based path tracer for glTF 2.0 whose light transport runs
//! in WGSL compute shaders.
//!
//! ```text
//!  glTF ─► scene ─► bvh ─► gpu ─► passes ─► film ─► image
//!            └─► shader: features, composed WGSL ──┘
//!          renderer   owns the scene on the device, the kernels and the film
//!          stopping   which pixels go on
//!          reference  from scene to film in plain f64 on the processor
//! ```
//!
//! [`scene::gltf::load_with`] reads a file into plain data. [`bvh`] builds trees over
//! it. [`shader`] decides what the scene needs ([`shader::Features`]) and composes the
//! WGSL for that. [`gpu`] turns all of it into buffers, [`passes`] run kernels, and
//! [`film`] holds the sums. [`stopping`] has the rules by which pixels stop, and measures how
//! well they keep their word. [`renderer::Renderer`] is the whole in steps; [`image`] writes
//! pictures, and [`view`] and [`layers`] make such of other things than light. [`reference`](mod@reference) computes
//! the same in another way, for tests to compare with. [`statistics`] knows numbers only; the
//! comparison of pictures, [`image::compare`], stands on it, and [`testing`] on that: image tests of
//! any renderer. [`bench`] turns renders' errors and times into curves, tables and pages. Modules earlier in the drawing never use later ones, and `scene`, `bvh`, `shader`,
//! `image`, `statistics`, `stopping`, `bench` and `reference` do not know wgpu.

pub mod bench;
pub mod bvh;
pub mod denoise;
pub mod error;
pub mod film;
pub mod gpu;
pub mod image;
pub mod layers;
pub mod layout;
pub mod passes;
pub mod reference;
pub mod renderer;
pub mod scene;
pub mod settings;
pub mod shader;
pub mod statistics;
pub mod stopping;
pub mod testing;
pub mod view;

pub use error::{Error, Result};
pub use renderer::Renderer;
pub use settings::RenderSettings;
