//! Renders of scenes whose radiance is known on paper (NUMERICS 5.2 to 5.4), and
//! estimators against each other.

#[path = "../common/mod.rs"]
mod common;

mod bundled;
mod enclosures;
mod geometry;
mod irradiance;
mod shading;
mod strategies;
mod surfaces;
