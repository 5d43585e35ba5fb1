//! From a tree under construction to the one that is traced: leaves, the bound on depth, boxes
//! on the grid, nodes in their order.

use super::binary::{BinaryTree, Cluster, Content};
use super::builder::empty_leaf;
use super::node::{BvhChild, BvhNode, leaf_link};
use super::quantise::Grid;
use super::{Bvh, LEAF_BIT, MAX_DEPTH, MAX_ITEMS, MAX_LEAF_SIZE, PrimitiveKind, TRAVERSAL_COST};
use rayon::prelude::*;
use std::collections::HashMap;

/// Nodes down to this depth may have any shape: below, halving any number of items still fits.
const FREE_DEPTH: u32 = MAX_DEPTH - MAX_ITEMS.ilog2();
/// Trees of so many items are laid out in parts, in parallel.
const PARALLEL: usize = 1 << 14;
/// About how many parts, whatever the number of threads.
const PARTS: usize = 128;

/// Lays out `tree`.
pub(super) fn lay_out(tree: &BinaryTree) -> Bvh {
    let slots = &tree.slots[..];
    let grid = Grid::new(slots[0].bounds());
    let mut layout = Layout::new(grid);
    if slots.len() > PARALLEL {
        let lay_out = |(slot, depth)| {
            let mut part = Layout::new(grid);
            let root = part.subtree(slots, slot, depth);
            (slot, (part, root))
        };
        layout.parts = parts(slots).into_par_iter().map(lay_out).collect();
        layout.nodes.reserve_exact(layout.parts.values().map(|(p, _)| p.nodes.len()).sum());
        layout.order.reserve_exact(slots.len() / 2 + 1);
    }
    let root = layout.subtree(slots, 0, 1);
    if layout.nodes.is_empty() {
        let leaf = layout.child(&slots[0], root.link);
        layout.nodes.push(BvhNode { children: [leaf, empty_leaf()] });
    }
    let Layout { mut nodes, order, .. } = layout;
    nodes.shrink_to_fit();
    let depth = depth(&nodes);
    Bvh { nodes, order, grid_min: grid.min, grid_scale: grid.scale, depth }
}

/// Subtrees that make up the tree but for its top: their slots and depths.
fn parts(slots: &[Cluster]) -> Vec<(usize, u32)> {
    let mut parts = vec![(0, 1)];
    let mut next = 0;
    // Each step replaces one by two, level by level.
    while parts.len() < PARTS && next < parts.len() {
        let (slot, depth) = parts[next];
        match slots[slot].content() {
            Content::Pair(pair) if depth < FREE_DEPTH => {
                parts.remove(next);
                parts.extend([(2 * pair + 1, depth + 1), (2 * pair + 2, depth + 1)]);
            }
            _ => next += 1,
        }
    }
    parts
}

fn depth(nodes: &[BvhNode]) -> u32 {
    // Parents come first.
    let mut depths = vec![1_u8; nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        for child in node.children.iter().filter(|c| c.link & LEAF_BIT == 0) {
            depths[child.link as usize] = depths[index] + 1;
        }
    }
    depths.into_iter().max().map_or(1, u32::from)
}

struct Layout {
    grid: Grid,
    nodes: Vec<BvhNode>,
    order: Vec<u32>,
    /// What is laid out already, by slot.
    parts: HashMap<usize, (Layout, Subtree)>,
}

/// A subtree that was laid out.
#[derive(Clone, Copy)]
struct Subtree {
    link: u32,
    /// Expected work of a ray that meets the root's box, times that box's area.
    cost: f32,
    /// Kind of all items, if it is one.
    kind: Option<PrimitiveKind>,
    count: usize,
}

impl Layout {
    fn new(grid: Grid) -> Self {
        Self { grid, nodes: Vec::new(), order: Vec::new(), parts: HashMap::new() }
    }

    fn child(&self, cluster: &Cluster, link: u32) -> BvhChild {
        let [x, y, z] = self.grid.encode(cluster.bounds());
        BvhChild { x, y, z, link }
    }

    /// Appends the nodes and items of the subtree at `slot`.
    fn subtree(&mut self, slots: &[Cluster], slot: usize, depth: u32) -> Subtree {
        if !self.parts.is_empty()
            && let Some((part, root)) = self.parts.remove(&slot)
        {
            return self.append(part, root);
        }
        let cluster = &slots[slot];
        let area = cluster.area();
        let first = self.order.len();
        let pair = match cluster.content() {
            Content::Item(index) => {
                let kind = cluster.kind();
                self.order.push(index as u32);
                return Subtree {
                    link: leaf_link(kind, first, 1),
                    cost: area,
                    kind: Some(kind),
                    count: 1,
                };
            }
            Content::Pair(pair) => pair,
        };
        if depth == FREE_DEPTH
            && let Some(balanced) = balanced(slots, pair)
        {
            // Deeper by one, so that its height is not asked for again.
            return self.subtree(&balanced, 0, depth + 1);
        }
        let node = self.nodes.len();
        self.nodes.push(BvhNode { children: [empty_leaf(); 2] });
        let sides = [2 * pair + 1, 2 * pair + 2];
        let [a, b] = sides.map(|slot| self.subtree(slots, slot, depth + 1));
        let count = a.count + b.count;
        let kind = a.kind.filter(|_| a.kind == b.kind);
        let cost = TRAVERSAL_COST * area + a.cost + b.cost;
        let leaf_cost = area * count as f32;
        if let Some(kind) = kind
            && kind != PrimitiveKind::Instance
            && count <= MAX_LEAF_SIZE as usize
            && leaf_cost <= cost
        {
            self.nodes.truncate(node);
            let link = leaf_link(kind, first, count);
            return Subtree { link, cost: leaf_cost, kind: Some(kind), count };
        }
        self.nodes[node].children =
            [self.child(&slots[sides[0]], a.link), self.child(&slots[sides[1]], b.link)];
        Subtree { link: node as u32, cost, kind, count }
    }

    /// Appends a part.
    fn append(&mut self, part: Layout, root: Subtree) -> Subtree {
        let (node_base, order_base) = (self.nodes.len() as u32, self.order.len() as u32);
        // The index is in the low bits of both sorts of links.
        let moved = |link: u32| link + if link & LEAF_BIT == 0 { node_base } else { order_base };
        self.nodes.extend(part.nodes.into_iter().map(|node| BvhNode {
            children: node.children.map(|c| BvhChild { link: moved(c.link), ..c }),
        }));
        self.order.extend(part.order);
        Subtree { link: moved(root.link), ..root }
    }
}

/// If the subtree of `pair` has more levels than are left below [`FREE_DEPTH`]: a tree of
/// its items that has not, by halving; its root is slot 0.
fn balanced(slots: &[Cluster], pair: usize) -> Option<Vec<Cluster>> {
    let mut pending = vec![(pair, 1)];
    let (mut leaves, mut height) = (Vec::new(), 0);
    while let Some((pair, level)) = pending.pop() {
        height = height.max(level);
        for slot in [2 * pair + 1, 2 * pair + 2] {
            match slots[slot].content() {
                Content::Item(_) => leaves.push(slots[slot]),
                Content::Pair(below) => pending.push((below, level + 1)),
            }
        }
    }
    if height <= MAX_DEPTH - FREE_DEPTH {
        return None;
    }
    let mut balanced = vec![Cluster::default()];
    balanced[0] = halve(&mut leaves, &mut balanced);
    Some(balanced)
}

/// Appends halves of `leaves`, and what is below; gives the cluster of all.
fn halve(leaves: &mut [Cluster], slots: &mut Vec<Cluster>) -> Cluster {
    if let [leaf] = leaves {
        return *leaf;
    }
    let all = leaves.iter().skip(1).fold(leaves[0], |all, c| all.union(c)).bounds();
    let axis = (all.max - all.min).max_position();
    let index = |c: &Cluster| match c.content() {
        Content::Item(index) | Content::Pair(index) => index,
    };
    let middle = leaves.len() / 2;
    leaves.select_nth_unstable_by(middle, |a, b| {
        a.middle()[axis].total_cmp(&b.middle()[axis]).then(index(a).cmp(&index(b)))
    });
    let (left, right) = leaves.split_at_mut(middle);
    let pair = slots.len() / 2;
    slots.extend([Cluster::default(); 2]);
    let (a, b) = (halve(left, slots), halve(right, slots));
    slots[2 * pair + 1] = a;
    slots[2 * pair + 2] = b;
    Cluster::of_pair(pair, &a, &b)
}
