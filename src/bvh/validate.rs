//! Proof and measures of a tree.

use super::quantise::decode;
use super::{
    BuildItem, Bvh, BvhChild, LEAF_COUNT_MASK, Link, MAX_DEPTH, PrimitiveKind, TRAVERSAL_COST,
};

/// Measures of a valid tree.
#[derive(Debug, Clone, PartialEq)]
pub struct BvhStatistics {
    /// Nodes.
    pub node_count: usize,
    /// Leaves that are not empty.
    pub leaf_count: usize,
    /// Number of leaves with so many items.
    pub leaf_sizes: [usize; LEAF_COUNT_MASK as usize + 1],
    /// Nodes on the longest path.
    pub depth: u32,
    /// Expected work of a ray that meets the root's bounds: visited nodes times
    /// [`TRAVERSAL_COST`] plus primitive tests, by the boxes as the device sees them.
    pub sah_cost: f64,
}

/// A box decoded in f64: the lower planes and the upper planes.
type Planes = [[f64; 3]; 2];

impl Bvh {
    /// Checks that every item is in exactly one leaf, with its kind, and inside all
    /// boxes above it; that leaves are no larger and paths no longer than promised; that
    /// every node is reached once and from a node before it. Returns the tree's measures,
    /// or what is wrong.
    pub fn validate(&self, items: &[BuildItem]) -> Result<BvhStatistics, String> {
        let mut check = Check {
            bvh: self,
            items,
            item_is_found: vec![false; items.len()],
            node_is_found: vec![false; self.nodes.len()],
            statistics: BvhStatistics {
                node_count: self.nodes.len(),
                leaf_count: 0,
                leaf_sizes: [0; LEAF_COUNT_MASK as usize + 1],
                depth: 0,
                sah_cost: 0.0,
            },
        };
        if self.order.len() != items.len() {
            return Err(format!("{} items in order, {} given", self.order.len(), items.len()));
        }
        check.node(0, [[f64::NEG_INFINITY; 3], [f64::INFINITY; 3]], 1)?;
        if let Some(item) = check.item_is_found.iter().position(|found| !found) {
            return Err(format!("item {item} is in no leaf"));
        }
        if let Some(node) = check.node_is_found.iter().position(|found| !found) {
            return Err(format!("node {node} is not reached"));
        }
        let mut statistics = check.statistics;
        if statistics.depth != self.depth {
            return Err(format!("depth is {}, not {}", statistics.depth, self.depth));
        }
        statistics.sah_cost = self.sah_cost();
        Ok(statistics)
    }

    /// Expected work of a ray that meets the root's bounds: see [`BvhStatistics::sah_cost`].
    pub fn sah_cost(&self) -> f64 {
        let cost = |child: &BvhChild| match child.target() {
            Some(Link::Inner { .. }) => area(&self.planes(child)) * f64::from(TRAVERSAL_COST),
            Some(Link::Leaf { count, .. }) => area(&self.planes(child)) * f64::from(count),
            None => 0.0,
        };
        let costs: f64 = self.nodes.iter().flat_map(|node| &node.children).map(cost).sum();
        let root = self.nodes[0].children.map(|child| self.planes(&child));
        let root_area = area(&union(&root[0], &root[1]));
        let relative = if root_area > 0.0 { costs / root_area } else { 0.0 };
        f64::from(TRAVERSAL_COST) + relative
    }

    fn planes(&self, child: &BvhChild) -> Planes {
        [child.lower(), child.upper()].map(|planes| {
            std::array::from_fn(|axis| {
                decode(self.grid_min[axis], self.grid_scale[axis], planes[axis])
            })
        })
    }
}

struct Check<'a> {
    bvh: &'a Bvh,
    items: &'a [BuildItem],
    item_is_found: Vec<bool>,
    node_is_found: Vec<bool>,
    statistics: BvhStatistics,
}

impl Check<'_> {
    /// Checks `node` and all below. `within` is the common part of the boxes above.
    fn node(&mut self, node: u32, within: Planes, depth: u32) -> Result<(), String> {
        let children = match self.bvh.nodes.get(node as usize) {
            Some(found) => found.children,
            None => return Err(format!("node {node} does not exist")),
        };
        if std::mem::replace(&mut self.node_is_found[node as usize], true) {
            return Err(format!("node {node} is reached twice"));
        }
        if depth > MAX_DEPTH {
            return Err(format!("node {node} is at depth {depth}, {MAX_DEPTH} is the bound"));
        }
        self.statistics.depth = self.statistics.depth.max(depth);
        for (side, child) in children.iter().enumerate() {
            let name = format!("child {side} of node {node}");
            let planes = self.bvh.planes(child);
            let inside = intersection(&planes, &within);
            match child.target() {
                None => return Err(format!("{name}: no kind has the bits of {:#x}", child.link)),
                Some(Link::Inner { node: below }) if below <= node => {
                    return Err(format!("{name}: node {below} comes before it"));
                }
                Some(Link::Inner { node: below }) => {
                    self.node(below, inside, depth + 1)?;
                }
                Some(Link::Leaf { kind, first, count }) => {
                    self.leaf(kind, first, count, &inside).map_err(|e| format!("{name}: {e}"))?;
                }
            }
        }
        Ok(())
    }

    fn leaf(
        &mut self,
        kind: PrimitiveKind,
        first: u32,
        count: u32,
        inside: &Planes,
    ) -> Result<(), String> {
        let largest = if kind == PrimitiveKind::Instance { 1 } else { super::MAX_LEAF_SIZE };
        if count > largest {
            return Err(format!("{count} items, {largest} is the bound"));
        }
        let Some(range) = self.bvh.order.get(first as usize..(first + count) as usize) else {
            return Err(format!("items {first} to {} are beyond the order", first + count));
        };
        for &item in range {
            let Some(BuildItem { bounds, kind: of_item }) = self.items.get(item as usize) else {
                return Err(format!("item {item} does not exist"));
            };
            if *of_item != kind {
                return Err(format!("item {item} is a {of_item:?} in a leaf of {kind:?}"));
            }
            if std::mem::replace(&mut self.item_is_found[item as usize], true) {
                return Err(format!("item {item} is there twice"));
            }
            let is_outside = (0..3).any(|axis| {
                f64::from(bounds.min[axis]) < inside[0][axis]
                    || f64::from(bounds.max[axis]) > inside[1][axis]
            });
            if is_outside {
                return Err(format!("item {item} is not inside every box above it"));
            }
        }
        if count > 0 {
            self.statistics.leaf_count += 1;
            self.statistics.leaf_sizes[count as usize] += 1;
        }
        Ok(())
    }
}

fn intersection(a: &Planes, b: &Planes) -> Planes {
    std::array::from_fn(|i| {
        std::array::from_fn(|axis| {
            if i == 0 { a[i][axis].max(b[i][axis]) } else { a[i][axis].min(b[i][axis]) }
        })
    })
}

fn union(a: &Planes, b: &Planes) -> Planes {
    std::array::from_fn(|i| {
        std::array::from_fn(|axis| {
            if i == 0 { a[i][axis].min(b[i][axis]) } else { a[i][axis].max(b[i][axis]) }
        })
    })
}

fn area(planes: &Planes) -> f64 {
    let [x, y, z] = std::array::from_fn(|axis| planes[1][axis] - planes[0][axis]);
    2.0 * (x * y + y * z + z * x)
}
