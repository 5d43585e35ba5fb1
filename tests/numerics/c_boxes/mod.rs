//! Rays, boxes and trees. C6 has no test: no tree here is built from Morton codes.

mod device;
mod few;
mod garbage;
mod grid;
mod layers;
mod naive;
mod segments;
mod trees;
