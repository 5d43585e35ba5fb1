//! Trees of low surface area cost.
//!
//! The cost of a tree is the expected work of a random ray that meets its root's box:
//! [`super::TRAVERSAL_COST`] for every node that it visits and 1 for every primitive that it
//! is tested against, boxes being met in proportion to their areas. Neighbours
//! along a space-filling curve are joined from below, subtrees are moved to where they cost
//! less, and what is cheaper as a leaf becomes one. `docs/tree.md` has figures, and those of what
//! was tried beside.

use super::binary::Cluster;
use super::cluster::agglomerate;
use super::layout::lay_out;
use super::reinsert::reinsert;
use super::{Aabb, BuildItem, Bvh, MAX_ITEMS, builder, morton};
use rayon::prelude::*;

/// Places along the curve within which clusters look for neighbours.
const RADIUS: usize = 6;
/// The same in trees of up to [`SMALL`] items, which take little time in any case.
const SMALL_RADIUS: usize = 12;
/// Items of a small tree at most.
const SMALL: usize = 1 << 18;
/// Rounds of reinsertion. Round k takes the share of the first divided by `1 + 2 k`.
const ROUNDS: usize = 16;
/// Subtrees that the first round of reinsertion tries, in parts of all.
const SHARE: f32 = 0.02;
/// Of trees so small that time hardly matters, the share with which it tries so many.
const TRIED: f32 = 60_000.0;
/// And that share at most.
const LARGEST_SHARE: f32 = 0.25;

/// Builds a tree with low surface area cost, in parallel; the same tree for any
/// number of threads. Bounds must be finite. Where a path would become deeper than
/// [`super::MAX_DEPTH`], halves replace the heuristic.
///
/// # Panics
/// If there are more than [`super::MAX_ITEMS`] items.
pub fn build_sah(items: &[BuildItem]) -> Bvh {
    assert!(items.len() <= MAX_ITEMS, "{} items, {MAX_ITEMS} fit a tree", items.len());
    if items.is_empty() {
        return builder::empty();
    }
    let radius = if items.len() <= SMALL { SMALL_RADIUS } else { RADIUS };
    let mut tree = agglomerate(along_curve(items), radius);
    let shares = shares(tree.slots.len());
    reinsert(&mut tree, &shares);
    lay_out(&tree)
}

/// One cluster an item.
fn along_curve(items: &[BuildItem]) -> Vec<Cluster> {
    let bounds = items.par_iter().map(|item| item.bounds).reduce(Aabb::empty, Aabb::union);
    let order = morton::order(items, bounds);
    order.into_par_iter().map(|i| Cluster::of_item(i as usize, &items[i as usize])).collect()
}

/// Of each round of reinsertion in a tree of so many subtrees.
fn shares(count: usize) -> [f32; ROUNDS] {
    let share = (TRIED / count as f32).clamp(SHARE, LARGEST_SHARE);
    std::array::from_fn(|k| share / (1 + 2 * k) as f32)
}
