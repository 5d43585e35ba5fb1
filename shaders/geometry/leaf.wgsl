// One primitive against one ray: shared by every traversal, by closest and any hit.
#import geometry/primitive
#if TRIANGLES
#import geometry/triangle
#endif
#if SPHERES
#import geometry/sphere
#endif
#if ALPHA
#import material/alpha
#endif

#if TRIANGLES
// `best`, or the hit on triangle `index` where it comes first. (o, d) is the
// ray in the triangle's own space. Equal distances go to the primitive that
// comes first in the scene, so that the result does not depend on the tree.
fn leaf_triangle(ray: Ray, o: vec3<f32>, d: vec3<f32>, index: u32, instance: u32, best: Hit) -> Hit {
    let p = primitive_load(index);
    let h = triangle_hit(o, d, primitive_point(p.a), primitive_point(p.b), primitive_point(p.c));
    if !(h.t > 0.0 && h.t <= best.t) {
        return best;
    }
    if h.t == best.t && !leaf_comes_first(p, best) {
        return best;
    }
    let hit = Hit(h.t, h.u, h.v, index, instance, false);
#if ALPHA
    if !alpha_accepts(ray, p, hit) {
        return best;
    }
#endif
    return hit;
}
#endif

#if SPHERES
fn leaf_sphere(ray: Ray, index: u32, best: Hit) -> Hit {
    let p = primitive_load(index);
    let t = sphere_record_hit(ray.origin, ray.direction, p);
    if !(t > 0.0 && t <= best.t) || (t == best.t && !leaf_comes_first(p, best)) {
        return best;
    }
    return Hit(t, 0.0, 0.0, index, INVALID, true);
}
#endif

// At equal distance: whether p precedes the best hit's primitive in scene order.
fn leaf_comes_first(p: Primitive, best: Hit) -> bool {
    if best.primitive == INVALID {
        return false;
    }
    return primitive_source(p) < primitives[3u * best.primitive + 2u].w;
}
