//! A tree with four children a node, made of a binary one.
//!
//! Which nodes of the binary tree stay, and which of its subtrees become leaves, is what costs
//! least by the surface area heuristic, found by dynamic programming (Ylitie, Karras & Laine
//! 2017, "Efficient incoherent ray traversal on GPUs through compressed wide BVHs", 3.1).

use crate::bvh::{
    Bvh, BvhChild, LEAF_BIT, LEAF_COUNT_MASK, LEAF_COUNT_SHIFT, LEAF_FIRST_MASK, LEAF_KIND_MASK,
    LEAF_KIND_SHIFT, MAX_LEAF_SIZE, PrimitiveKind,
};

/// Children of a node.
const WIDTH: usize = 4;

/// Cost of visiting a node in units of one primitive test, as a packet pays it: 600 machine
/// instructions against 450.
const NODE_COST: f32 = 1.35;

/// A child that no ray meets, with nothing in it: its lower planes are above its upper ones.
const EMPTY: BvhChild = BvhChild {
    x: 0xFFFF,
    y: 0xFFFF,
    z: 0xFFFF,
    link: LEAF_BIT | (PrimitiveKind::Triangle as u32) << LEAF_KIND_SHIFT,
};

/// A tree of nodes of four children.
pub(super) struct WideTree {
    /// The first is the root. Links of inner children count these nodes.
    pub(super) nodes: Vec<[BvhChild; WIDTH]>,
    /// Levels.
    pub(super) depth: u32,
}

impl WideTree {
    /// The cheapest for the leaves of `bvh` or what joins of them.
    pub(super) fn new(bvh: &Bvh) -> Self {
        Collapse::new(bvh).run()
    }
}

/// What is known of a binary node.
#[derive(Clone, Copy)]
struct Entry {
    /// Least cost of what is below in 2, 3 or 4 places.
    places: [f32; WIDTH - 1],
    /// The link of one leaf for all that is below, if that can be.
    leaf: Option<u32>,
}

struct Collapse<'a> {
    bvh: &'a Bvh,
    /// By binary node.
    entries: Vec<Entry>,
}

impl<'a> Collapse<'a> {
    fn new(bvh: &'a Bvh) -> Self {
        let none = Entry { places: [0.0; WIDTH - 1], leaf: None };
        let mut collapse = Self { bvh, entries: vec![none; bvh.nodes.len()] };
        // Children come after their nodes.
        for (index, node) in bvh.nodes.iter().enumerate().rev() {
            let [a, b] = node.children.map(|c| collapse.costs(&c));
            let places = std::array::from_fn(|k| split(&a, &b, k + 2).1);
            let [a, b] = node.children.map(|c| collapse.leaf(&c));
            let leaf = a.zip(b).and_then(|(a, b)| joined(a, b));
            collapse.entries[index] = Entry { places, leaf };
        }
        collapse
    }

    fn run(&self) -> WideTree {
        let mut nodes = vec![[EMPTY; WIDTH]];
        let mut depth = 1;
        // (binary node, wide node that it becomes, its level)
        let mut pending = vec![(0, 0, 1)];
        while let Some((binary, wide, level)) = pending.pop() {
            depth = depth.max(level);
            let mut children = [EMPTY; WIDTH];
            let mut count = 0;
            self.place(binary, WIDTH, &mut |mut child, inner| {
                if let Some(below) = inner {
                    child.link = nodes.len() as u32;
                    pending.push((below, nodes.len(), level + 1));
                    nodes.push([EMPTY; WIDTH]);
                }
                children[count] = child;
                count += 1;
            });
            nodes[wide] = children;
        }
        WideTree { nodes, depth }
    }

    /// Gives the children that stand for what is below the binary `node` in so many `places`, the
    /// inner ones with their binary nodes.
    fn place(&self, node: u32, places: usize, give: &mut impl FnMut(BvhChild, Option<u32>)) {
        let children = self.bvh.nodes[node as usize].children;
        let costs = children.map(|c| self.costs(&c));
        let (first, _) = split(&costs[0], &costs[1], places);
        for ((child, costs), places) in children.into_iter().zip(costs).zip([first, places - first])
        {
            if child.link & LEAF_BIT != 0 {
                give(child, None);
            } else if costs[places - 1] < costs[0] {
                // The fewest that do.
                let enough = costs.iter().position(|&c| c <= costs[places - 1]);
                self.place(child.link, enough.map_or(places, |k| k + 1), give);
            } else {
                let leaf = self.leaf(&child).filter(|&l| self.leaf_cost(&child, l) <= costs[0]);
                match leaf {
                    Some(link) => give(BvhChild { link, ..child }, None),
                    None => give(child, Some(child.link)),
                }
            }
        }
    }

    /// Least cost of a child in 1, 2, 3 or 4 places at most.
    fn costs(&self, child: &BvhChild) -> [f32; WIDTH] {
        if child.link & LEAF_BIT != 0 {
            return [self.leaf_cost(child, child.link); WIDTH];
        }
        let Entry { places, leaf } = self.entries[child.link as usize];
        let inner = self.area(child) * NODE_COST + places[WIDTH - 2];
        let one = leaf.map_or(inner, |link| inner.min(self.leaf_cost(child, link)));
        let mut costs = [one; WIDTH];
        for k in 1..WIDTH {
            costs[k] = costs[k - 1].min(places[k - 1]);
        }
        costs
    }

    /// The link of one leaf for all of a child, if that can be.
    fn leaf(&self, child: &BvhChild) -> Option<u32> {
        if child.link & LEAF_BIT != 0 {
            Some(child.link)
        } else {
            self.entries[child.link as usize].leaf
        }
    }

    fn leaf_cost(&self, child: &BvhChild, link: u32) -> f32 {
        self.area(child) * count(link) as f32
    }

    /// Half the surface area of a child's box.
    fn area(&self, child: &BvhChild) -> f32 {
        let (low, high) = (child.lower(), child.upper());
        let step = self.bvh.grid_scale.to_array();
        let [x, y, z] = std::array::from_fn(|k| (high[k] - low[k]) as f32 * step[k]);
        x * y + y * z + z * x
    }
}

/// How many of so many `places` the first of two children best has, and what both then cost.
fn split(a: &[f32; WIDTH], b: &[f32; WIDTH], places: usize) -> (usize, f32) {
    let cost = |first: usize| a[first - 1] + b[places - first - 1];
    let mut best = (1, cost(1));
    for first in 2..places {
        if cost(first) < best.1 {
            best = (first, cost(first));
        }
    }
    best
}

fn count(link: u32) -> u32 {
    link >> LEAF_COUNT_SHIFT & LEAF_COUNT_MASK
}

/// One leaf for the items of both, which follow each other.
fn joined(a: u32, b: u32) -> Option<u32> {
    let kind = |link: u32| link >> LEAF_KIND_SHIFT & LEAF_KIND_MASK;
    let total = count(a) + count(b);
    let fits = kind(a) == kind(b)
        && kind(a) != PrimitiveKind::Instance as u32
        && (1..=MAX_LEAF_SIZE).contains(&total);
    let first = (a & LEAF_FIRST_MASK).min(b & LEAF_FIRST_MASK);
    fits.then_some(
        a & !(LEAF_FIRST_MASK | LEAF_COUNT_MASK << LEAF_COUNT_SHIFT)
            | total << LEAF_COUNT_SHIFT
            | first,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::{Aabb, BuildItem, Link, build_sah};
    use glam::Vec3;

    /// The expected cost of a wide tree, times the area of its root.
    fn cost(tree: &WideTree, collapse: &Collapse<'_>) -> f64 {
        let costs = tree.nodes.iter().flatten().filter(|c| c.x != EMPTY.x).map(|c| {
            let of_node = f64::from(NODE_COST);
            let each = if c.link & LEAF_BIT == 0 { of_node } else { f64::from(count(c.link)) };
            f64::from(collapse.area(c)) * each
        });
        costs.sum()
    }

    #[test]
    fn every_item_is_in_one_leaf_and_the_cost_is_the_one_found() {
        let mut state = 1_u32;
        let mut unit = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / 16_777_216.0
        };
        let mut point = || Vec3::new(unit(), unit(), unit());
        for size in [1, 2, 3, 4, 5, 9, 100, 2000] {
            let items: Vec<_> = (0..size)
                .map(|i| {
                    let (a, b) = (point(), point());
                    let kind = [PrimitiveKind::Triangle, PrimitiveKind::Instance][i % 7 / 6];
                    BuildItem { bounds: Aabb::of_points(&[a, a + 0.1 * b]), kind }
                })
                .collect();
            let bvh = build_sah(&items);
            let collapse = Collapse::new(&bvh);
            let tree = collapse.run();
            let mut found = vec![0; size];
            for child in tree.nodes.iter().flatten() {
                if let Some(Link::Leaf { kind, first, count }) = child.target() {
                    for &item in &bvh.order[first as usize..(first + count) as usize] {
                        found[item as usize] += 1;
                        assert_eq!(items[item as usize].kind, kind);
                    }
                }
            }
            assert_eq!(found, vec![1; size]);
            let expected = f64::from(collapse.entries[0].places[WIDTH - 2]);
            let cost = cost(&tree, &collapse);
            assert!((cost - expected).abs() <= 1e-4 * expected, "{cost}, {expected} expected");
        }
    }
}
