//! Rays and spheres.
