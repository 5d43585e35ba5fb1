//! The presets of the `obvhs` crate: PLOC with parallel reinsertion; the slow ones with
//! triangles split beforehand.

use crate::tree::{Child, Tree};
use glam::Vec3;
use obvhs::BvhBuildParams;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::triangle::Triangle;
use std::time::Duration;
use steradian::bvh::Aabb;

/// By name, fastest first.
pub(crate) const PRESETS: [(&str, BvhBuildParams); 6] = [
    ("fastest", BvhBuildParams::fastest_build()),
    ("very fast", BvhBuildParams::very_fast_build()),
    ("fast", BvhBuildParams::fast_build()),
    ("medium", BvhBuildParams::medium_build()),
    ("slow", BvhBuildParams::slow_build()),
    ("very slow", BvhBuildParams::very_slow_build()),
];

/// On one thread.
pub(crate) fn build(triangles: &[[Vec3; 3]], params: BvhBuildParams) -> Tree {
    let corners = |t: &[Vec3; 3]| {
        let [v0, v1, v2] = t.map(Into::into);
        Triangle { v0, v1, v2 }
    };
    let theirs: Vec<_> = triangles.iter().map(corners).collect();
    let tree = build_bvh2_from_tris(&theirs, params, &mut Duration::default());
    let mut nodes = Vec::new();
    // (their first child, our node)
    let mut pending = vec![(tree.nodes[0].first_index, 0)];
    nodes.push([(Aabb::empty(), Child::Leaf(0, 0)); 2]);
    while let Some((first, at)) = pending.pop() {
        for side in 0..2 {
            let child = &tree.nodes[first as usize + side];
            let bounds = child.aabb();
            let bounds = Aabb { min: bounds.min.into(), max: bounds.max.into() };
            let link = if child.is_leaf() {
                Child::Leaf(child.first_index, child.prim_count)
            } else {
                nodes.push([(Aabb::empty(), Child::Leaf(0, 0)); 2]);
                pending.push((child.first_index, nodes.len() - 1));
                Child::Inner(nodes.len() as u32 - 1)
            };
            nodes[at][side] = (bounds, link);
        }
    }
    Tree { nodes, order: tree.primitive_indices }
}
