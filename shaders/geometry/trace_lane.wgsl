// Closest and any hit over a tree of two children a node: every thread walks by
// itself. A leaf of the top tree may be an instance, whose own tree is walked in
// its object space.
#import geometry/leaf
#import geometry/stack
#if VISIT_COUNTS
#import geometry/visits
#endif

// Whether any thread that must walk together with this one has `b`.
fn trace_any_lane(b: bool) -> bool {
    return b;
}

// Nearest hit in (0, ray.t_max).
fn trace_closest(ray: Ray, is_active: bool) -> Hit {
    return trace_walk(ray, is_active, false);
}

// Whether anything is hit in (0, ray.t_max).
fn trace_any(ray: Ray, is_active: bool) -> bool {
    return trace_walk(ray, is_active, true).primitive != INVALID;
}

fn trace_walk(ray: Ray, is_active: bool, any_hit: bool) -> Hit {
    var best = hit_none(ray);
    var tree = tree_ray_world(ray);
    var link = select(LINK_DONE, node_word(0u).w, is_active);
    var height = select(0u, 1u, is_active);
    stack_set(0u, LINK_DONE);
    loop {
        // Down to a leaf, nearer child first. The farther one is always written, and
        // counts where both are hit.
        while link_is_inner(link) {
#if VISIT_COUNTS
            visit_node();
#endif
            let left = node_word(link);
            let right = node_word(link + 1u);
            let a = slab_hit(tree.slab, left, best.t);
            let b = slab_hit(tree.slab, right, best.t);
            let hit_a = a.x <= a.y;
            let hit_b = b.x <= b.y;
            let right_first = hit_b && (b.x < a.x || !hit_a);
            stack_set(height, select(right.w, left.w, right_first));
            height += select(0u, 1u, hit_a && hit_b);
            height -= select(1u, 0u, hit_a || hit_b);
            let nearer = select(left.w, right.w, right_first);
            link = select(stack_get(height), nearer, hit_a || hit_b);
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
            leaf_closest(ray, tree, link & LINK_KIND_MASK, primitive_load(i), i, &best);
        }
        if any_hit && best.primitive != INVALID {
            return best;
        }
        height -= 1u;
        link = stack_get(height);
    }
    stack_check(height);
    return best;
}
