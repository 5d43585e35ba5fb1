//! Bounding volume hierarchies: built here in parallel, read by the device.
//!
//! [`build_sah`] (or, for comparison, [`build_median`]) turns the bounds of a list of
//! items into a [`Bvh`]. Items are the triangles and spheres of one tree, or the
//! instances of meshes: a tree over instances is the top level, with one of them in a
//! leaf. The tree never sees the geometry; its leaves give indices into the list.
//! [`BvhNode`] says how a node is laid out, [`GridRay`] how a ray meets its boxes, and
//! [`closest_hit`] and [`any_hit`] are the traversal as the shaders do it.
//! [`triangle_hit`], [`sphere_hit`] and [`sphere_hit_anchored`] are the shaders'
//! intersection functions in the same arithmetic, and [`SpawnPoint`] is how rays leave
//! what they met. Names in `_as` take the arithmetic as a parameter: plain, or with every
//! multiplication and addition fused, as devices may.
//!
//! [`Bvh::validate`] proves a tree and measures it.

mod arithmetic;
mod binary;
mod bounds;
mod build_median;
mod build_sah;
mod builder;
mod cluster;
mod grid_ray;
mod kept;
mod layout;
mod morton;
mod node;
mod quantise;
#[cfg(test)]
mod random;
mod refit;
mod reinsert;
mod spawn;
mod sphere;
mod traverse;
mod triangle;
mod validate;

pub use bounds::Aabb;
pub use build_median::build_median;
pub use build_sah::build_sah;
pub use grid_ray::{BOX_ERROR, GridRay, MIN_DIRECTION};
pub use kept::{KeptTrees, TreeSources};
pub use node::{
    BvhChild, BvhNode, GRID_MAX, LEAF_BIT, LEAF_COUNT_MASK, LEAF_COUNT_SHIFT, LEAF_FIRST_MASK,
    LEAF_KIND_MASK, LEAF_KIND_SHIFT, Link, MAX_ITEMS, UPPER_PLANE_SHIFT,
};
pub use spawn::{SpawnPoint, spawn_offset};
pub use sphere::{AnchoredSphere, sphere_hit, sphere_hit_anchored};
pub use traverse::{
    ItemHit, Ray, TraversalCounts, any_hit, any_hit_as, closest_hit, closest_hit_as,
    closest_hit_counted,
};
pub use triangle::{TriangleHit, triangle_hit, triangle_hit_as};
pub use validate::BvhStatistics;

use glam::Vec3;

/// Bound on [`Bvh::depth`]: a traversal that keeps one entry for each node above
/// needs no larger stack.
pub const MAX_DEPTH: u32 = 48;

/// Bound on the primitives of a leaf; a leaf of instances has one.
pub const MAX_LEAF_SIZE: u32 = 4;

/// Cost of visiting a node in units of one primitive test. A node is two loads of
/// 16 bytes and a triangle three, and on the software device loads are the cost.
pub const TRAVERSAL_COST: f32 = 1.0;

/// What an item is. All items of a leaf are of one kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PrimitiveKind {
    /// A triangle.
    Triangle = 0,
    /// An analytic sphere.
    Sphere = 1,
    /// A placed tree.
    Instance = 2,
}

impl PrimitiveKind {
    /// The kind of a leaf's kind bits.
    pub fn from_bits(bits: u32) -> Option<Self> {
        [Self::Triangle, Self::Sphere, Self::Instance].get(bits as usize).copied()
    }
}

/// What a builder needs to know of an item.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BuildItem {
    /// A finite box that holds the item.
    pub bounds: Aabb,
    /// What it is.
    pub kind: PrimitiveKind,
}

/// A tree with two children a node, boxes in 16 bits a plane.
#[derive(Debug, Clone, PartialEq)]
pub struct Bvh {
    /// The nodes, depth first. The first is the root and exists always.
    pub nodes: Vec<BvhNode>,
    /// Items in the order of the leaves: indices into the list given to the builder.
    pub order: Vec<u32>,
    /// Position of plane 0 of the grid; plane q is at `grid_min + q * grid_scale`.
    pub grid_min: Vec3,
    /// Distance between planes; 0 on an axis on which the tree has no extent.
    pub grid_scale: Vec3,
    /// Nodes on the longest path from the root, the root included.
    pub depth: u32,
}
