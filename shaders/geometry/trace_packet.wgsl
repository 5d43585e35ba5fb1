// Closest and any hit over a tree of four children a node, for software devices:
// the eight threads of a subgroup walk together, so that a node or a triangle is
// loaded once, two words a thread, and shared. All eight must call with every ray;
// those without a ray pass is_active = false.
#import geometry/leaf
#import geometry/stack
#if VISIT_COUNTS
#import geometry/visits
#endif

var<private> packet_lane: u32;

fn trace_any_lane(b: bool) -> bool {
    return subgroupAny(b);
}

// Two of the 16 words of a node: child c is lanes 2c and 2c + 1.
fn packet_child(pair: vec2<u32>, c: u32) -> vec4<u32> {
    switch c {
        case 0u: { return vec4<u32>(subgroupBroadcast(pair, 0u), subgroupBroadcast(pair, 1u)); }
        case 1u: { return vec4<u32>(subgroupBroadcast(pair, 2u), subgroupBroadcast(pair, 3u)); }
        case 2u: { return vec4<u32>(subgroupBroadcast(pair, 4u), subgroupBroadcast(pair, 5u)); }
        default: { return vec4<u32>(subgroupBroadcast(pair, 6u), subgroupBroadcast(pair, 7u)); }
    }
}

// Six lanes load a primitive's record for all; a split one three.
fn packet_primitive(index: u32) -> Primitive {
#if SPLIT_PRIMITIVES
    let word = primitive_word(3u * index + min(packet_lane, 2u));
    return Primitive(subgroupBroadcast(word, 0u), subgroupBroadcast(word, 1u), subgroupBroadcast(word, 2u));
#else
    let pair = primitives[6u * index + min(packet_lane, 5u)];
    return Primitive(
        vec4<u32>(subgroupBroadcast(pair, 0u), subgroupBroadcast(pair, 1u)),
        vec4<u32>(subgroupBroadcast(pair, 2u), subgroupBroadcast(pair, 3u)),
        vec4<u32>(subgroupBroadcast(pair, 4u), subgroupBroadcast(pair, 5u)),
    );
#endif
}

// Distance to the child's box as an ordered integer, its two low bits the child's
// number; INVALID for a miss.
fn packet_key(s: Slab, child: vec4<u32>, t_max: f32, number: u32) -> u32 {
    let h = slab_hit(s, child, t_max);
    return select(INVALID, (u32(h.x) & ~3u) | number, h.x <= h.y);
}

// Least over the subgroup's eight lanes.
fn packet_min(v: vec4<u32>) -> vec4<u32> {
    var m = min(v, subgroupShuffleXor(v, 1u));
    m = min(m, subgroupShuffleXor(m, 2u));
    return min(m, subgroupShuffleXor(m, 4u));
}

fn packet_link(links: vec4<u32>, key: u32) -> u32 {
    let low = select(links.x, links.y, (key & 1u) != 0u);
    let high = select(links.z, links.w, (key & 1u) != 0u);
    return select(low, high, (key & 2u) != 0u);
}

// Ascending.
fn packet_sort(k: vec4<u32>) -> vec4<u32> {
    let a = vec4<u32>(min(k.xy, k.zw), max(k.xy, k.zw));
    let b = vec4<u32>(min(a.xz, a.yw), max(a.xz, a.yw));
    return vec4<u32>(b.x, min(b.y, b.z), max(b.y, b.z), b.w);
}

// Nearest hit in (0, ray.t_max).
fn trace_closest(ray: Ray, is_active: bool) -> Hit {
    return packet_walk(ray, is_active, false);
}

// Whether anything is hit in (0, ray.t_max).
fn trace_any(ray: Ray, is_active: bool) -> bool {
    return packet_walk(ray, is_active, true).primitive != INVALID;
}

fn packet_walk(ray: Ray, is_active: bool, any_hit: bool) -> Hit {
    var best = hit_none(ray);
    // A lane without a ray, or one that has its answer, meets no box.
    var t_max = select(-1.0, ray.t_max, is_active);
    var tree = tree_ray_world(ray);
    var link = node_word(0u).w;
    var height = 1u;
    stack_set(0u, LINK_DONE);
    loop {
        while link_is_inner(link) {
#if VISIT_COUNTS
            visit_node();
#endif
            let pair = node_half(2u * link + packet_lane);
            let c0 = packet_child(pair, 0u);
            let c1 = packet_child(pair, 1u);
            let c2 = packet_child(pair, 2u);
            let c3 = packet_child(pair, 3u);
            let links = vec4<u32>(c0.w, c1.w, c2.w, c3.w);
            let keys = packet_sort(packet_min(vec4<u32>(
                packet_key(tree.slab, c0, t_max, 0u),
                packet_key(tree.slab, c1, t_max, 1u),
                packet_key(tree.slab, c2, t_max, 2u),
                packet_key(tree.slab, c3, t_max, 3u),
            )));
            // Farthest first; those that are no hit come last and are not counted.
            if keys.w != INVALID {
                stack_set(height, packet_link(links, keys.w));
                height += 1u;
            }
            if keys.z != INVALID {
                stack_set(height, packet_link(links, keys.z));
                height += 1u;
            }
            if keys.y != INVALID {
                stack_set(height, packet_link(links, keys.y));
                height += 1u;
            }
            if keys.x != INVALID {
                link = packet_link(links, keys.x);
            } else {
                height -= 1u;
                link = stack_get(height);
            }
        }
        if link == LINK_DONE {
            break;
        }
#if INSTANCES
        if link == LINK_RETURN {
            tree = tree_ray_world(ray);
            height -= 1u;
            link = stack_get(height);
            continue;
        }
        if (link & LINK_KIND_MASK) == LINK_KIND_INSTANCE && link_count(link) > 0u {
            stack_set(height, LINK_RETURN);
            height += 1u;
            tree = tree_ray_instance(ray, (link & LINK_FIRST_MASK) * TREE_RECORD_SIZE);
            link = node_word(tree.instance).w;
            continue;
        }
#endif
        let first = link & LINK_FIRST_MASK;
        let end = first + link_count(link);
        for (var i = first; i < end; i++) {
#if VISIT_COUNTS
            visit_primitive();
#endif
            let p = packet_primitive(i);
            if t_max > 0.0 {
                leaf_closest(ray, tree, link & LINK_KIND_MASK, p, i, &best);
            }
            t_max = select(t_max, best.t, best.primitive != INVALID);
        }
        if any_hit {
            t_max = select(t_max, -1.0, best.primitive != INVALID);
            if !subgroupAny(t_max > 0.0) {
                height = 0u;
                break;
            }
        }
        height -= 1u;
        link = stack_get(height);
    }
    stack_check(height);
    return best;
}
