// Closest and any hit by testing every primitive: for comparison, and as a check of the tree.
#import geometry/leaf
#import frame/frame

fn trace_any_lane(b: bool) -> bool {
    return b;
}

// Nearest hit in (0, ray.t_max).
fn trace_closest(ray: Ray, is_active: bool) -> Hit {
    var best = hit_none(ray);
    let tree = tree_ray_world(ray);
    let triangles = select(0u, frame.triangle_count, is_active);
    for (var i = 0u; i < triangles; i++) {
        leaf_closest(ray, tree, LINK_KIND_TRIANGLE, primitive_load(i), i, &best);
    }
    let spheres = select(0u, frame.sphere_count, is_active);
    for (var i = triangles; i < triangles + spheres; i++) {
        leaf_closest(ray, tree, LINK_KIND_SPHERE, primitive_load(i), i, &best);
    }
    return best;
}

// Whether anything is hit in (0, ray.t_max).
fn trace_any(ray: Ray, is_active: bool) -> bool {
    return trace_closest(ray, is_active).primitive != INVALID;
}
