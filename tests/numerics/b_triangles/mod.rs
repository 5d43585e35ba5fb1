//! Rays and triangles.

mod degenerate;
mod device;
mod edges;
mod naive;
mod points;
mod slivers;
mod ties;
