//! The node as the device reads it.
//!
//! A node holds the boxes of its two children, so that one load decides about
//! both and a leaf costs no node of its own. A child is one `vec4<u32>`: three
//! words of box planes on the tree's 16-bit grid and one of link.

use super::PrimitiveKind;
use bytemuck::{Pod, Zeroable};

/// Set in a link to a leaf.
pub const LEAF_BIT: u32 = 1 << 31;
/// Position of the leaf's [`PrimitiveKind`], two bits.
pub const LEAF_KIND_SHIFT: u32 = 29;
/// The kind after shifting.
pub const LEAF_KIND_MASK: u32 = 3;
/// Position of the leaf's primitive count, four bits.
pub const LEAF_COUNT_SHIFT: u32 = 25;
/// The count after shifting.
pub const LEAF_COUNT_MASK: u32 = 15;
/// The leaf's first index into [`super::Bvh::order`].
pub const LEAF_FIRST_MASK: u32 = (1 << LEAF_COUNT_SHIFT) - 1;
/// Items that one tree can hold: as many as a leaf can address.
pub const MAX_ITEMS: usize = LEAF_FIRST_MASK as usize + 1;
/// Position of the upper plane in a word of [`BvhChild`].
pub const UPPER_PLANE_SHIFT: u32 = 16;
/// Greatest plane of the grid.
pub const GRID_MAX: u32 = 0xFFFF;

/// Two children; 32 bytes, read as two `vec4<u32>`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
pub struct BvhNode {
    /// The children; the builders put no order on them.
    pub children: [BvhChild; 2],
}

/// The box of a child and what is in it.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
pub struct BvhChild {
    /// Planes across x: bits 0 to 15 the lower one, bits 16 to 31 the upper one,
    /// in units of the grid (`grid_min + q * grid_scale`).
    pub x: u32,
    /// Planes across y.
    pub y: u32,
    /// Planes across z.
    pub z: u32,
    /// A leaf has [`LEAF_BIT`] set; bits 29 and 30 hold the kind, bits 25 to 28 the count
    /// and bits 0 to 24 the first index into [`super::Bvh::order`]. For example
    /// `0xA600_0007` is a leaf of three spheres, order 7, 8 and 9. Count 0 is the
    /// empty second child of a root that has one leaf only. Without the bit the link
    /// is the index of a node, greater than that of the node that holds it.
    pub link: u32,
}

/// What a [`BvhChild`] leads to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Link {
    /// A node.
    Inner {
        /// Its index.
        node: u32,
    },
    /// Primitives of one kind.
    Leaf {
        /// What they are.
        kind: PrimitiveKind,
        /// First index into [`super::Bvh::order`].
        first: u32,
        /// How many.
        count: u32,
    },
}

impl BvhChild {
    /// Lower planes of the three axes, in grid units.
    pub fn lower(&self) -> [u32; 3] {
        [self.x, self.y, self.z].map(|word| word & GRID_MAX)
    }

    /// Upper planes of the three axes, in grid units.
    pub fn upper(&self) -> [u32; 3] {
        [self.x, self.y, self.z].map(|word| word >> UPPER_PLANE_SHIFT)
    }

    /// The decoded link; `None` if its kind is not one.
    pub fn target(&self) -> Option<Link> {
        if self.link & LEAF_BIT == 0 {
            return Some(Link::Inner { node: self.link });
        }
        Some(Link::Leaf {
            kind: PrimitiveKind::from_bits(self.link >> LEAF_KIND_SHIFT & LEAF_KIND_MASK)?,
            first: self.link & LEAF_FIRST_MASK,
            count: self.link >> LEAF_COUNT_SHIFT & LEAF_COUNT_MASK,
        })
    }
}

/// The link of a leaf.
pub(super) fn leaf_link(kind: PrimitiveKind, first: usize, count: usize) -> u32 {
    debug_assert!(first <= LEAF_FIRST_MASK as usize && count <= LEAF_COUNT_MASK as usize);
    LEAF_BIT | (kind as u32) << LEAF_KIND_SHIFT | (count as u32) << LEAF_COUNT_SHIFT | first as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_where_the_documentation_says() {
        assert_eq!(size_of::<BvhNode>(), 32);
        assert_eq!(leaf_link(PrimitiveKind::Sphere, 7, 3), 0xA600_0007);
        let child = BvhChild { x: 0x0004_0001, y: 0xFFFF_0002, z: 0x0006_0003, link: 0xA600_0007 };
        assert_eq!(child.lower(), [1, 2, 3]);
        assert_eq!(child.upper(), [4, 0xFFFF, 6]);
        let leaf = Link::Leaf { kind: PrimitiveKind::Sphere, first: 7, count: 3 };
        assert_eq!(child.target(), Some(leaf));
        assert_eq!(BvhChild { link: 9, ..child }.target(), Some(Link::Inner { node: 9 }));
        assert_eq!(BvhChild { link: u32::MAX, ..child }.target(), None);
    }
}
