//! Traversal as the shaders do it, for tests and for counting.

use super::{Bvh, BvhChild, GridRay, Link, MAX_DEPTH, PrimitiveKind};
use glam::Vec3;

/// A ray `o + t d` with `0 < t < t_max`; `d` need not be a unit vector.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Origin.
    pub o: Vec3,
    /// Direction, not zero.
    pub d: Vec3,
    /// End of the interval, not in it.
    pub t_max: f32,
}

/// The item that a ray meets first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ItemHit {
    /// Ray parameter.
    pub t: f32,
    /// Index into the list given to the builder.
    pub item: u32,
}

impl ItemHit {
    /// The order of hits: by t and, where two are equal, by item. So the result does
    /// not depend on the order in which a tree presents them.
    pub fn is_before(&self, other: &Self) -> bool {
        self.t < other.t || (self.t == other.t && self.item < other.item)
    }
}

/// What a traversal touched.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct TraversalCounts {
    /// Nodes visited; each costs a test of two boxes.
    pub nodes: u64,
    /// Items tested.
    pub items: u64,
}

/// The first hit along `ray`. `intersect` gets a kind, an item and `t_max` and gives the
/// item's nearest t below it.
pub fn closest_hit(
    bvh: &Bvh,
    ray: &Ray,
    intersect: impl FnMut(PrimitiveKind, u32, f32) -> Option<f32>,
) -> Option<ItemHit> {
    closest_hit_as::<false>(bvh, ray, intersect)
}

/// [`closest_hit`]; with `FUSED`, boxes are met in fused arithmetic.
pub fn closest_hit_as<const FUSED: bool>(
    bvh: &Bvh,
    ray: &Ray,
    intersect: impl FnMut(PrimitiveKind, u32, f32) -> Option<f32>,
) -> Option<ItemHit> {
    closest_hit_counted::<FUSED>(bvh, ray, intersect).0
}

/// [`closest_hit_as`], and what it touched.
pub fn closest_hit_counted<const FUSED: bool>(
    bvh: &Bvh,
    ray: &Ray,
    mut intersect: impl FnMut(PrimitiveKind, u32, f32) -> Option<f32>,
) -> (Option<ItemHit>, TraversalCounts) {
    let mut best: Option<ItemHit> = None;
    let mut items = 0;
    let nodes = traverse::<FUSED>(bvh, ray, |kind, item, cull| {
        items += 1;
        if let Some(t) = intersect(kind, item, ray.t_max) {
            let hit = ItemHit { t, item };
            if best.is_none_or(|b| hit.is_before(&b)) {
                best = Some(hit);
                *cull = t;
            }
        }
        true
    });
    (best, TraversalCounts { nodes, items })
}

/// Whether there is any hit along `ray`; `intersect` as for [`closest_hit`].
pub fn any_hit(
    bvh: &Bvh,
    ray: &Ray,
    intersect: impl FnMut(PrimitiveKind, u32, f32) -> Option<f32>,
) -> bool {
    any_hit_as::<false>(bvh, ray, intersect)
}

/// [`any_hit`]; with `FUSED`, boxes are met in fused arithmetic.
pub fn any_hit_as<const FUSED: bool>(
    bvh: &Bvh,
    ray: &Ray,
    mut intersect: impl FnMut(PrimitiveKind, u32, f32) -> Option<f32>,
) -> bool {
    let mut found = false;
    traverse::<FUSED>(bvh, ray, |kind, item, _| {
        found = intersect(kind, item, ray.t_max).is_some();
        !found
    });
    found
}

/// Calls `visit` for the items in all boxes that the ray meets, nearer child first.
/// `visit` may lower the t beyond which boxes are skipped, and ends the traversal
/// with `false`. Gives the number of nodes visited.
fn traverse<const FUSED: bool>(
    bvh: &Bvh,
    ray: &Ray,
    mut visit: impl FnMut(PrimitiveKind, u32, &mut f32) -> bool,
) -> u64 {
    let grid_ray = GridRay::<FUSED>::prepare(bvh, ray.o, ray.d);
    let mut cull = ray.t_max;
    let mut stack = [0; MAX_DEPTH as usize];
    let mut stack_size = 0;
    let mut node = 0;
    let mut node_count = 0;
    loop {
        node_count += 1;
        let mut next: Option<(u32, f32)> = None;
        for child in &bvh.nodes[node as usize].children {
            let Some(t) = grid_ray.entry(child, cull) else { continue };
            match child.target() {
                Some(Link::Inner { node }) => match next {
                    Some((other, other_t)) => {
                        let (near, far) = if t < other_t { (node, other) } else { (other, node) };
                        next = Some((near, t.min(other_t)));
                        stack[stack_size] = far;
                        stack_size += 1;
                    }
                    None => next = Some((node, t)),
                },
                Some(Link::Leaf { kind, first, count }) => {
                    for &item in &bvh.order[first as usize..(first + count) as usize] {
                        if !visit(kind, item, &mut cull) {
                            return node_count;
                        }
                    }
                }
                None => unreachable!("{}", invalid_link(child)),
            }
        }
        node = match next {
            Some((near, _)) => near,
            None if stack_size == 0 => return node_count,
            None => {
                stack_size -= 1;
                stack[stack_size]
            }
        };
    }
}

fn invalid_link(child: &BvhChild) -> String {
    format!("link {:#010x} has a kind that no builder writes", child.link)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::{Aabb, BuildItem, build_sah};

    #[test]
    fn counts_are_those_of_the_nodes_and_items_on_the_way() {
        // Sixteen unit boxes in a row along x, each of which is met at its near face.
        let bounds = |i: usize| {
            let min = Vec3::new(2.0 * i as f32, 0.0, 0.0);
            Aabb { min, max: min + Vec3::ONE }
        };
        let items: Vec<_> = (0..16)
            .map(|i| BuildItem { bounds: bounds(i), kind: PrimitiveKind::Triangle })
            .collect();
        let bvh = build_sah(&items);
        let count = |o, d, meets: bool| {
            let ray = Ray { o, d, t_max: f32::INFINITY };
            closest_hit_counted::<false>(&bvh, &ray, |_, item, _| {
                meets.then(|| (items[item as usize].bounds.min.x - o.x) / d.x)
            })
        };
        let beside = count(Vec3::new(-1.0, 5.0, 0.5), Vec3::X, true);
        assert_eq!(beside, (None, TraversalCounts { nodes: 1, items: 0 }));
        // Nothing stops the ray, so every node and every item is on its way.
        let (_, all) = count(Vec3::new(-1.0, 0.5, 0.5), Vec3::X, false);
        assert_eq!(all, TraversalCounts { nodes: bvh.nodes.len() as u64, items: 16 });
        // The first leaf ends it: one node a level and its sibling, popped later, and that
        // leaf's items.
        let (hit, first) = count(Vec3::new(-1.0, 0.5, 0.5), Vec3::X, true);
        assert_eq!(hit, Some(ItemHit { t: 1.0, item: 0 }));
        assert!(first.nodes < 2 * u64::from(bvh.depth), "{first:?}");
        assert!((1..=u64::from(crate::bvh::MAX_LEAF_SIZE)).contains(&first.items), "{first:?}");
    }
}
