//! Renders of scenes whose radiance is known on paper, and
//! estimators against each other.

#[path = "../common/mod.rs"]
mod common;

mod bundled;
mod enclosures;
mod geometry;
mod irradiance;
mod matrix;
mod media;
mod path_reuse;
mod pictures;
mod shading;
mod sides;
mod strategies;
mod surfaces;
