//! Rays that leave surfaces.
