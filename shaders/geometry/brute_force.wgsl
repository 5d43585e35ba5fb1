// Closest and any hit by testing every primitive: the seed's comparison, and a check of the tree.
#import geometry/leaf
#import frame/frame

// Nearest hit in (0, ray.t_max).
fn bvh_closest_hit(ray: Ray) -> Hit {
    var best = hit_none(ray);
#if TRIANGLES
    for (var i = 0u; i < frame.triangle_count; i++) {
        best = leaf_triangle(ray, ray.origin, ray.direction, i, INVALID, best);
    }
#endif
#if SPHERES
    for (var i = 0u; i < frame.sphere_count; i++) {
        best = leaf_sphere(ray, frame.triangle_count + i, best);
    }
#endif
    return best;
}

// Whether anything is hit in (0, ray.t_max).
fn bvh_any_hit(ray: Ray) -> bool {
    return bvh_closest_hit(ray).primitive != INVALID;
}
