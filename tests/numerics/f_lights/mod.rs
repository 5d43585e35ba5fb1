//! Sampling of lights.
