// The trees' buffer and its links (src/bvh/node.rs).
#import math/math

// Records of TREE_RECORD_SIZE vec4: the top tree's, then each instance's. Lower
// corner of the grid and link to the root; step of the grid; rows of
// object_from_world; rows of world_from_object. Then the nodes: one vec4 a child,
// box planes and link. Counted in vec4, held in halves: what one lane of a packet loads.
#if SPLIT_NODES
// The first of the two numbers of each half, and the second.
@group(0) @binding(2) var<storage, read> nodes: array<u32>;
@group(0) @binding(36) var<storage, read> nodes_1: array<u32>;
#else
@group(0) @binding(2) var<storage, read> nodes: array<vec2<u32>>;
#endif

// Links that are not a node or a leaf: nothing is left; back to the top tree.
const LINK_DONE: u32 = 0xffffffffu;
const LINK_RETURN: u32 = 0xfffffffeu;

fn node_half(index: u32) -> vec2<u32> {
#if SPLIT_NODES
    return vec2<u32>(nodes[index], nodes_1[index]);
#else
    return nodes[index];
#endif
}

fn node_word(index: u32) -> vec4<u32> {
    return vec4<u32>(node_half(2u * index), node_half(2u * index + 1u));
}

fn link_count(link: u32) -> u32 {
    return (link >> LINK_COUNT_SHIFT) & LINK_COUNT_MASK;
}

fn link_is_inner(link: u32) -> bool {
    return (link & LINK_LEAF) == 0u;
}
