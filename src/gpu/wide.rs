//! A tree with four children a node: two levels of a binary one in each.

use crate::bvh::{Bvh, BvhChild, BvhNode, LEAF_BIT, LEAF_KIND_SHIFT, PrimitiveKind};

/// A child that no ray meets, with nothing in it: its lower planes are above its upper ones.
const EMPTY: BvhChild = BvhChild {
    x: 0xFFFF,
    y: 0xFFFF,
    z: 0xFFFF,
    link: LEAF_BIT | (PrimitiveKind::Triangle as u32) << LEAF_KIND_SHIFT,
};

/// Nodes of four children; the first is the root. Links of inner children count these nodes.
pub(super) fn collapse(bvh: &Bvh) -> Vec<[BvhChild; 4]> {
    let mut nodes = vec![[EMPTY; 4]];
    // (binary node, wide node that it becomes)
    let mut pending = vec![(0_u32, 0_usize)];
    while let Some((binary, wide)) = pending.pop() {
        let mut children = expand(bvh, binary);
        for child in &mut children {
            if child.link & LEAF_BIT == 0 {
                nodes.push([EMPTY; 4]);
                pending.push((child.link, nodes.len() - 1));
                child.link = nodes.len() as u32 - 1;
            }
        }
        nodes[wide][..children.len()].copy_from_slice(&children);
    }
    nodes
}

/// Levels of [`collapse`]'s tree.
pub(super) fn depth(bvh: &Bvh) -> u32 {
    let mut deepest = 0;
    let mut pending = vec![(0_u32, 1_u32)];
    while let Some((binary, level)) = pending.pop() {
        deepest = deepest.max(level);
        let inner = expand(bvh, binary).into_iter().filter(|c| c.link & LEAF_BIT == 0);
        pending.extend(inner.map(|c| (c.link, level + 1)));
    }
    deepest
}

/// A node's children, of which the largest inner ones are replaced by their own children.
fn expand(bvh: &Bvh, node: u32) -> Vec<BvhChild> {
    let children = |n: &BvhNode| n.children.to_vec();
    let mut list = children(&bvh.nodes[node as usize]);
    while list.len() < 4 {
        let inner = (0..list.len()).filter(|&i| list[i].link & LEAF_BIT == 0);
        let Some(largest) =
            inner.max_by(|&a, &b| area(bvh, &list[a]).total_cmp(&area(bvh, &list[b])))
        else {
            break;
        };
        let opened = list.swap_remove(largest);
        list.extend(children(&bvh.nodes[opened.link as usize]));
    }
    list
}

/// Half the surface area of a child's box.
fn area(bvh: &Bvh, child: &BvhChild) -> f32 {
    let (low, high) = (child.lower(), child.upper());
    let step = bvh.grid_scale.to_array();
    let [x, y, z] = std::array::from_fn(|k| (high[k] - low[k]) as f32 * step[k]);
    x * y + y * z + z * x
}
