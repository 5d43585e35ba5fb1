//! A tree under construction: two children a node, single items as leaves, boxes in f32.

use super::{Aabb, BuildItem, PrimitiveKind};
use glam::{Vec4, Vec4Swizzles};

/// Set in all links, so that none reads as a subnormal number: arithmetic on whole vectors,
/// whose last component is a link, would slow down.
const NORMAL_BIT: u32 = 1 << 30;
const ITEM_BIT: u32 = 1 << 31;

/// A box and what is in it.
#[derive(Clone, Copy, Default)]
pub(super) struct Cluster {
    /// Least corner; the last component holds the link.
    low: Vec4,
    /// Greatest corner; the last component holds the kind.
    high: Vec4,
}

/// What a [`Cluster`] holds.
pub(super) enum Content {
    /// Index of an item.
    Item(usize),
    /// Index of a pair of clusters.
    Pair(usize),
}

impl Cluster {
    pub(super) fn of_item(index: usize, item: &BuildItem) -> Self {
        let Aabb { min, max } = item.bounds;
        let kind = f32::from_bits(NORMAL_BIT | item.kind as u32);
        Self { low: min.extend(0.0), high: max.extend(kind) }.with(ITEM_BIT | index as u32)
    }

    /// What an item is.
    pub(super) fn kind(&self) -> PrimitiveKind {
        let bits = self.high.w.to_bits() & !NORMAL_BIT;
        PrimitiveKind::from_bits(bits).expect("the kind of an item")
    }

    fn with(mut self, link: u32) -> Self {
        self.low.w = f32::from_bits(link | NORMAL_BIT);
        self
    }

    /// Both in the pair of that index.
    pub(super) fn of_pair(pair: usize, a: &Self, b: &Self) -> Self {
        a.union(b).with(pair as u32)
    }

    pub(super) fn content(&self) -> Content {
        let link = self.low.w.to_bits();
        let index = (link & !(ITEM_BIT | NORMAL_BIT)) as usize;
        if link & ITEM_BIT != 0 { Content::Item(index) } else { Content::Pair(index) }
    }

    /// The box of both; the link is neither's.
    #[inline]
    pub(super) fn union(&self, other: &Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// This content in the box of `a` and `b`.
    #[inline]
    pub(super) fn fitted(&self, a: &Self, b: &Self) -> Self {
        let mut fitted = a.union(b);
        fitted.low.w = self.low.w;
        fitted
    }

    /// Half the surface area; not a number, or infinite, where f32 does not hold it.
    #[inline]
    pub(super) fn area(&self) -> f32 {
        let e = self.high - self.low;
        let p = e * e.yzxw();
        p.x + p.y + p.z
    }

    pub(super) fn bounds(&self) -> Aabb {
        Aabb { min: self.low.truncate(), max: self.high.truncate() }
    }

    /// Twice the middle of the box.
    pub(super) fn middle(&self) -> Vec4 {
        0.5 * self.low + 0.5 * self.high
    }

    /// Whether the boxes are the same.
    #[inline]
    pub(super) fn has_box_of(&self, other: &Self) -> bool {
        self.low.xyz() == other.low.xyz() && self.high.xyz() == other.high.xyz()
    }
}

/// Slot 0 is the root; slots `2 p + 1` and `2 p + 2` are the clusters of pair p.
pub(super) struct BinaryTree {
    pub(super) slots: Vec<Cluster>,
}

impl BinaryTree {
    pub(super) fn pair_of(slot: usize) -> usize {
        (slot - 1) / 2
    }

    pub(super) fn sibling(slot: usize) -> usize {
        ((slot - 1) ^ 1) + 1
    }
}
