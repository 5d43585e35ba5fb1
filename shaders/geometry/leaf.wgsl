// One primitive against one ray: shared by every traversal.
#import geometry/primitive
#import geometry/tree_ray
#if TRIANGLES
#import geometry/triangle
#endif
#if SPHERES
#import geometry/sphere
#endif
#if ALPHA
#import material/alpha
#endif

#if CULLING
// Whether this thread traces a camera ray: those pass through the back of what is culled.
var<private> leaf_is_camera: bool;
#endif

// At equal distance: whether p precedes the best hit's primitive in scene order, so
// that the result does not depend on the tree.
fn leaf_comes_first(p: Primitive, best: u32) -> bool {
    return best != INVALID && primitive_source(p) < primitive_source(primitive_of(best));
}

#if TRIANGLES
// The hit of the ray on a triangle, t < 0 for none.
fn leaf_triangle_hit(tree: TreeRay, p: Primitive) -> TriangleHit {
    let p0 = primitive_point(p.a) - tree.origin;
    let p1 = primitive_point(p.b) - tree.origin;
    let p2 = primitive_point(p.c) - tree.origin;
    let weights = triangle_weights(tree.direction, tree.shear, p0, p1, p2);
    var hit = TriangleHit(-1.0, 0.0, 0.0);
    var is_met = weights.is_inside && triangle_has_area(p);
#if CULLING
    is_met = is_met && !leaf_is_culled(tree.direction, p);
#endif
    if is_met {
        hit = triangle_resolve(tree.direction, p0, p1, p2, weights.w);
    }
    return hit;
}

#if CULLING
fn leaf_is_culled(direction: vec3<f32>, p: Primitive) -> bool {
    let a = primitive_point(p.a);
    let n = cross(primitive_point(p.b) - a, primitive_point(p.c) - a);
    return leaf_is_camera && (p.a.w & PRIMITIVE_IS_CULLED) != 0u && dot(n, direction) > 0.0;
}
#endif

fn triangle_has_area(p: Primitive) -> bool {
    let a = primitive_point(p.a);
    return any(cross(primitive_point(p.b) - a, primitive_point(p.c) - a) != vec3<f32>(0.0));
}
#endif

// Replaces `best` by the hit on primitive `index`, if that comes first.
fn leaf_closest(ray: Ray, tree: TreeRay, kind: u32, p: Primitive, index: u32, best: ptr<function, Hit>) {
#if TRIANGLES
    if kind == LINK_KIND_TRIANGLE {
        let h = leaf_triangle_hit(tree, p);
        leaf_accept(ray, p, Hit(h.t, h.u, h.v, index, tree.instance), best);
    }
#endif
#if SPHERES
    if kind == LINK_KIND_SPHERE {
        let t = sphere_record_hit(tree.origin, tree.direction, p);
        leaf_accept(ray, p, Hit(t, 0.0, 0.0, index, HIT_SPHERE), best);
    }
#endif
}

fn leaf_accept(ray: Ray, p: Primitive, hit: Hit, best: ptr<function, Hit>) {
    if hit.t > 0.0 && hit.t <= (*best).t {
        var comes_first = hit.t < (*best).t || leaf_comes_first(p, (*best).primitive);
#if ALPHA
        comes_first = comes_first && alpha_accepts(ray, p, hit);
#endif
        if comes_first {
            *best = hit;
#if PACKETS
            primitive_met = p;
#endif
        }
    }
}
