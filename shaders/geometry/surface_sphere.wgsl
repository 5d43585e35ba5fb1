// The surface at a hit on a sphere, moved onto the sphere.
#import geometry/surface

fn surface_sphere(surface: Surface, p: Primitive, ray: Ray, hit: Hit) -> Surface {
    var s = surface;
    let radius = bitcast<f32>(p.b.x);
    let at = ray.origin + hit.t * ray.direction;
    let center = primitive_point(p.a);
    s.ng = surface_unit(at - center);
    s.position = center + radius * s.ng;
    s.offset = spawn_offset(max(max_component(abs(center)) , max(max_component(abs(s.position)), radius)));
#if ANCHORED_SPHERES
    if p.b.y != 0u {
        s = surface_sphere_anchored(s, p, at, 1.0 / radius);
    }
#endif
    s.ns = s.ng;
    return s;
}

#if ANCHORED_SPHERES
// One Newton step on k|w|² + 2 n·w = 0 along the normal n + k w.
fn surface_sphere_anchored(surface: Surface, p: Primitive, at: vec3<f32>, k: f32) -> Surface {
    var s = surface;
    let anchor = primitive_point(p.a);
    let n = primitive_point(p.c);
    let w = at - anchor;
    s.ng = surface_unit(n + k * w);
    s.position = at - s.ng * (0.5 * k * dot(w, w) + dot(n, w));
    s.offset = spawn_offset(max(max_component(abs(anchor)), max_component(abs(s.position))));
    return s;
}
#endif
