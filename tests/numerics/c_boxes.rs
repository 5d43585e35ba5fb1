//! Rays, boxes and trees.
