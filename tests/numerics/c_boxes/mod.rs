//! Boxes and trees.
