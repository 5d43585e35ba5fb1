//! Rays and triangles.
