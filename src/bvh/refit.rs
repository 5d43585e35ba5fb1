//! A tree over items that have moved.

use super::quantise::Grid;
use super::{Aabb, BuildItem, Bvh, BvhChild, Link};
use rayon::prelude::*;

impl Bvh {
    /// The same nodes and leaves over items elsewhere: links, order and depth stay, grid and boxes
    /// are made anew. It holds what a new tree would hold; how good it is, [`Self::sah_cost`]
    /// tells. `None` if the items are not as many, or not of the kinds, that it was built over.
    pub fn refitted(&self, items: &[BuildItem]) -> Option<Self> {
        if items.len() != self.order.len() {
            return None;
        }
        if items.is_empty() {
            return Some(self.clone());
        }
        let leaves: Option<Vec<Aabb>> =
            self.nodes.par_iter().map(|node| self.leaf_bounds(&node.children, items)).collect();
        let mut bounds = leaves?;
        // Children come after their parents.
        for (index, node) in self.nodes.iter().enumerate().rev() {
            for below in node.children.iter().filter_map(inner) {
                bounds[index] = bounds[index].union(bounds[below]);
            }
        }
        let grid = Grid::new(bounds[0]);
        let nodes = self.nodes.par_iter().map(|node| {
            let mut node = *node;
            for child in &mut node.children {
                let of_child = match inner(child) {
                    Some(below) => bounds[below],
                    None => self.leaf_bounds(std::slice::from_ref(child), items)?,
                };
                if !of_child.is_empty() {
                    [child.x, child.y, child.z] = grid.encode(of_child);
                }
            }
            Some(node)
        });
        let nodes = nodes.collect::<Option<_>>()?;
        let order = self.order.clone();
        Some(Self { nodes, order, grid_min: grid.min, grid_scale: grid.scale, depth: self.depth })
    }

    /// Bounds of the items in those of the children that are leaves.
    fn leaf_bounds(&self, children: &[BvhChild], items: &[BuildItem]) -> Option<Aabb> {
        let mut bounds = Aabb::empty();
        for child in children {
            let Link::Leaf { kind, first, count } = child.target()? else { continue };
            for &item in &self.order[first as usize..(first + count) as usize] {
                let item = items.get(item as usize).filter(|item| item.kind == kind)?;
                bounds = bounds.union(item.bounds);
            }
        }
        Some(bounds)
    }
}

/// The node that the child is, if it is one.
fn inner(child: &BvhChild) -> Option<usize> {
    match child.target() {
        Some(Link::Inner { node }) => Some(node as usize),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use crate::bvh::random::Random;
    use crate::bvh::{Aabb, BuildItem, PrimitiveKind, build_median, build_sah};
    use glam::Vec3;

    fn items(count: u32, random: &mut Random) -> Vec<BuildItem> {
        let mut point = || Vec3::from([0; 3].map(|_| random.unit()));
        let kind = |k| if k % 5 == 0 { PrimitiveKind::Sphere } else { PrimitiveKind::Triangle };
        let item = |k| {
            let (a, b) = (point(), 0.05 * point());
            BuildItem { bounds: Aabb { min: a, max: a + b }, kind: kind(k) }
        };
        (0..count).map(item).collect()
    }

    #[test]
    fn where_nothing_moved_it_is_the_tree_that_was_built() {
        let mut random = Random::new(3);
        for count in [0, 1, 2, 3, 7, 5_000, 40_000] {
            let items = items(count, &mut random);
            for tree in [build_sah(&items), build_median(&items)] {
                assert_eq!(tree.refitted(&items), Some(tree), "{count} items");
            }
        }
    }

    #[test]
    fn it_holds_what_moved() {
        let mut random = Random::new(4);
        let before = items(3_000, &mut random);
        let tree = build_sah(&before);
        for distance in [1e-3, 1.0, 1e6] {
            let mut items = before.clone();
            for BuildItem { bounds, .. } in &mut items {
                let by = distance * Vec3::from([0; 3].map(|_| random.unit() - 0.5));
                *bounds = Aabb { min: bounds.min + by, max: bounds.max + by };
            }
            let refitted = tree.refitted(&items).unwrap();
            let measured = refitted.validate(&items).unwrap();
            assert_eq!(measured.depth, tree.depth);
        }
    }

    #[test]
    fn other_items_have_a_tree_of_their_own() {
        let items = items(100, &mut Random::new(5));
        let tree = build_sah(&items);
        assert_eq!(tree.refitted(&items[..99]), None);
        let mut others = items;
        others[50].kind = PrimitiveKind::Triangle;
        assert_eq!(tree.refitted(&others), None);
    }
}
