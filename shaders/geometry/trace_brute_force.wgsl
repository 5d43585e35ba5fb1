// Closest and any hit by testing every primitive: for comparison, and as a check of the tree.
#import geometry/leaf
#import frame/frame
#import film/fault
#if VISIT_COUNTS
#import geometry/visits
#endif

fn trace_any_lane(b: bool) -> bool {
    return b;
}

// Nearest hit in (0, ray.t_max).
fn trace_closest(ray: Ray, is_active: bool) -> Hit {
    var best = hit_none(ray);
    let tree = tree_ray_world(ray);
    let triangles = select(0u, frame.triangle_count, is_active);
    var i = 0u;
    for (; i < triangles; i++) {
#if VISIT_COUNTS
        visit_primitive();
#endif
        leaf_closest(ray, tree, LINK_KIND_TRIANGLE, primitive_load(i), i, &best);
    }
    let end = triangles + select(0u, frame.sphere_count, is_active);
    for (; i < end; i++) {
#if VISIT_COUNTS
        visit_primitive();
#endif
        leaf_closest(ray, tree, LINK_KIND_SPHERE, primitive_load(i), i, &best);
    }
    // Some drivers end a thread's loops early, without saying so.
    if i < end {
        fault_raise(FAULT_LOOP_BOUND);
    }
    return best;
}

// Whether anything is hit in (0, ray.t_max).
fn trace_any(ray: Ray, is_active: bool) -> bool {
    return trace_closest(ray, is_active).primitive != INVALID;
}
