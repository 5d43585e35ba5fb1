//! What the builders share: subdivision of the items in parallel, leaves, the bound
//! on depth, and the nodes' order in memory.
//!
//! A builder is a rule that partitions a range of items in two. The inner node that
//! separates `[a, m)` from `[m, b)` is kept in slot `m - 1` of one array: no two
//! nodes split at the same place, so both halves of a range own disjoint parts of the
//! array and can be built at the same time without locks or allocation. The result
//! does not depend on the number of threads: every parallel step only takes
//! minima, maxima and counts.

use super::node::{BvhChild, BvhNode, leaf_link};
use super::quantise::Grid;
use super::{Aabb, BuildItem, Bvh, MAX_DEPTH, MAX_ITEMS, MAX_LEAF_SIZE, PrimitiveKind};
use glam::{Vec3, Vec3A};
use rayon::prelude::*;
use std::cmp::Ordering;

/// Ranges from this size on are scanned by several threads.
const PARALLEL_SCAN: usize = 1 << 16;
/// Ranges from this size on have their halves built by two threads.
const PARALLEL_BUILD: usize = 1 << 12;

/// An item while it is being sorted.
#[derive(Clone, Copy)]
#[repr(C)]
pub(super) struct Reference {
    min: Vec3,
    index: u32,
    max: Vec3,
    kind: PrimitiveKind,
}

impl Reference {
    /// The middle of the box; see [`Aabb::centroid`].
    #[inline]
    pub(super) fn centroid(&self) -> Vec3A {
        0.5 * self.min() + 0.5 * self.max()
    }

    #[inline]
    pub(super) fn min(&self) -> Vec3A {
        self.min.into()
    }

    #[inline]
    pub(super) fn max(&self) -> Vec3A {
        self.max.into()
    }
}

/// Bounds of a range of items and of their centroids.
#[derive(Clone, Copy)]
pub(super) struct Extent {
    pub(super) min: Vec3A,
    pub(super) max: Vec3A,
    pub(super) centroid_min: Vec3A,
    pub(super) centroid_max: Vec3A,
}

impl Extent {
    const EMPTY: Self = Self {
        min: Vec3A::INFINITY,
        max: Vec3A::NEG_INFINITY,
        centroid_min: Vec3A::INFINITY,
        centroid_max: Vec3A::NEG_INFINITY,
    };

    #[inline]
    fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
            centroid_min: self.centroid_min.min(other.centroid_min),
            centroid_max: self.centroid_max.max(other.centroid_max),
        }
    }

    fn of(references: &[Reference]) -> Self {
        scan(references, || Self::EMPTY, Self::add, Self::union)
    }

    #[inline]
    fn add(&mut self, reference: &Reference) {
        let centroid = reference.centroid();
        self.min = self.min.min(reference.min());
        self.max = self.max.max(reference.max());
        self.centroid_min = self.centroid_min.min(centroid);
        self.centroid_max = self.centroid_max.max(centroid);
    }

    fn bounds(&self) -> Aabb {
        Aabb { min: self.min.into(), max: self.max.into() }
    }
}

/// Folds a range, in parallel if it is long. `union` must not depend on order.
pub(super) fn scan<T: Send>(
    references: &[Reference],
    start: impl Fn() -> T + Sync + Send,
    add: impl Fn(&mut T, &Reference) + Sync + Send,
    union: impl Fn(T, T) -> T + Sync + Send,
) -> T {
    let fold = |part: &[Reference]| {
        let mut total = start();
        part.iter().for_each(|reference| add(&mut total, reference));
        total
    };
    if references.len() < PARALLEL_SCAN {
        return fold(references);
    }
    references.par_chunks(PARALLEL_SCAN / 4).map(fold).reduce(&start, &union)
}

/// A rule that partitions a range of at least two items and says where the
/// second part begins, or that the range is best left as a leaf. It must split a
/// range of more than `leaf_size` items.
pub(super) trait SplitRule: Sync {
    fn split(
        &self,
        references: &mut [Reference],
        extent: &Extent,
        leaf_size: usize,
    ) -> Option<usize>;
}

/// Partitions at the median of the centroids along the `axis`; equal ones go by index.
pub(super) fn split_median(references: &mut [Reference], axis: usize) -> usize {
    let middle = references.len() / 2;
    let order = |a: &Reference, b: &Reference| -> Ordering {
        a.centroid()[axis].total_cmp(&b.centroid()[axis]).then(a.index.cmp(&b.index))
    };
    references.select_nth_unstable_by(middle, order);
    middle
}

/// The axis along which `size` is greatest.
pub(super) fn longest_axis(size: Vec3A) -> usize {
    if size.x >= size.y.max(size.z) {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    }
}

/// An inner node before its place in memory is known.
#[derive(Clone, Copy)]
struct Slot {
    /// The boxes of both ranges in grid units, as in [`BvhChild`].
    boxes: [[u32; 3]; 2],
    /// Where the two ranges are split further; 0 for a leaf.
    splits: [usize; 2],
}

/// A finished range: its box in grid units, and where it is split (0 for a leaf).
struct Subtree {
    planes: [u32; 3],
    split: usize,
}

struct Subdivision<'a, R> {
    grid: Grid,
    rule: &'a R,
}

impl<R: SplitRule> Subdivision<'_, R> {
    /// Builds the range that starts at item `begin`, with `depth` inner nodes above it.
    fn build(
        &self,
        references: &mut [Reference],
        slots: &mut [Slot],
        begin: usize,
        depth: u32,
    ) -> Subtree {
        let extent = Extent::of(references);
        let planes = self.grid.encode(extent.bounds());
        let Some(middle) = self.split(references, &extent, depth) else {
            return Subtree { planes, split: 0 };
        };
        debug_assert!(0 < middle && middle < references.len());
        let (left, right) = references.split_at_mut(middle);
        let (left_slots, rest) = slots.split_at_mut(middle - 1);
        let (slot, right_slots) = rest.split_first_mut().expect("one slot for each split");
        let parallel = left.len() + right.len() >= PARALLEL_BUILD;
        let mut build_left = || self.build(left, left_slots, begin, depth + 1);
        let mut build_right = || self.build(right, right_slots, begin + middle, depth + 1);
        let (left, right) = if parallel {
            rayon::join(build_left, build_right)
        } else {
            (build_left(), build_right())
        };
        slot.boxes = [left.planes, right.planes];
        slot.splits = [left.split, right.split];
        Subtree { planes, split: begin + middle }
    }

    /// Where to split; `None` for a leaf.
    fn split(&self, references: &mut [Reference], extent: &Extent, depth: u32) -> Option<usize> {
        let count = references.len();
        if count == 1 {
            return None;
        }
        let axis = longest_axis(extent.centroid_max - extent.centroid_min);
        // Halving down to single items takes log2(count) levels, rounded up. When
        // no more are left, the range is halved, which keeps this true of both halves.
        if depth + count.next_power_of_two().ilog2() >= MAX_DEPTH {
            return Some(split_median(references, axis));
        }
        let kind = references[0].kind;
        let leaf_size = match kind {
            PrimitiveKind::Instance => 1,
            _ if count > MAX_LEAF_SIZE as usize => 1,
            _ if references.iter().any(|r| r.kind != kind) => 1,
            _ => MAX_LEAF_SIZE as usize,
        };
        self.rule.split(references, extent, leaf_size)
    }
}

/// Builds a tree over `items` with the given rule.
///
/// # Panics
/// If there are more than [`MAX_ITEMS`] items.
pub(super) fn build(items: &[BuildItem], rule: &impl SplitRule) -> Bvh {
    assert!(items.len() <= MAX_ITEMS, "{} items, {MAX_ITEMS} fit a tree", items.len());
    let mut references: Vec<Reference> = items.par_iter().enumerate().map(reference).collect();
    if items.is_empty() {
        return empty();
    }
    let grid = Grid::new(Extent::of(&references).bounds());
    let mut slots = vec![Slot { boxes: [[0; 3]; 2], splits: [0; 2] }; items.len() - 1];
    let root = Subdivision { grid, rule }.build(&mut references, &mut slots, 0, 0);
    let nodes = Vec::with_capacity(items.len());
    let mut layout = Layout { references: &references, slots: &slots, nodes, depth: 1 };
    if root.split == 0 {
        let leaf = layout.child(root.planes, 0, 0..items.len(), 1);
        layout.nodes.push(BvhNode { children: [leaf, empty_leaf()] });
    } else {
        layout.inner(root.split, 0..items.len(), 1);
    }
    let Layout { mut nodes, depth, .. } = layout;
    nodes.shrink_to_fit();
    Bvh {
        nodes,
        order: references.iter().map(|r| r.index).collect(),
        grid_min: grid.min,
        grid_scale: grid.scale,
        depth,
    }
}

/// A root with nothing in it.
pub(super) fn empty() -> Bvh {
    Bvh {
        nodes: vec![BvhNode { children: [empty_leaf(); 2] }],
        order: Vec::new(),
        grid_min: Vec3::ZERO,
        grid_scale: Vec3::ZERO,
        depth: 1,
    }
}

fn reference((index, item): (usize, &BuildItem)) -> Reference {
    let bounds = item.bounds;
    debug_assert!(bounds.min.is_finite() && bounds.max.is_finite(), "item {index} is not finite");
    debug_assert!(!bounds.is_empty(), "item {index} is empty");
    Reference { min: bounds.min, index: index as u32, max: bounds.max, kind: item.kind }
}

/// A leaf of no primitives with a box of no extent. A box with its planes
/// exchanged would not do: the test for a hit sorts them.
pub(super) fn empty_leaf() -> BvhChild {
    BvhChild { x: 0, y: 0, z: 0, link: leaf_link(PrimitiveKind::Triangle, 0, 0) }
}

/// Writes the nodes depth first: a node, all of its first child, all of its second.
struct Layout<'a> {
    references: &'a [Reference],
    slots: &'a [Slot],
    nodes: Vec<BvhNode>,
    depth: u32,
}

impl Layout<'_> {
    /// Appends the node that splits `range` at `split`, and all below; returns its index.
    fn inner(&mut self, split: usize, range: std::ops::Range<usize>, depth: u32) -> u32 {
        self.depth = self.depth.max(depth);
        let index = self.nodes.len();
        self.nodes.push(BvhNode { children: [empty_leaf(); 2] });
        let Slot { boxes, splits } = self.slots[split - 1];
        let first = self.child(boxes[0], splits[0], range.start..split, depth);
        let second = self.child(boxes[1], splits[1], split..range.end, depth);
        self.nodes[index].children = [first, second];
        index as u32
    }

    fn child(
        &mut self,
        [x, y, z]: [u32; 3],
        split: usize,
        range: std::ops::Range<usize>,
        depth: u32,
    ) -> BvhChild {
        let link = if split == 0 {
            leaf_link(self.references[range.start].kind, range.start, range.len())
        } else {
            self.inner(split, range, depth + 1)
        };
        BvhChild { x, y, z, link }
    }
}
