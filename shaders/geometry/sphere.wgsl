// Ray against sphere, in f32, for spheres that are far, tiny or vast.
#import geometry/primitive

// The nearer of two roots in (0, t_max), or T_INFINITY.
fn sphere_root(t0: f32, t1: f32, t_max: f32) -> f32 {
    let near = min(t0, t1);
    let far = max(t0, t1);
    let t = select(far, near, near > 0.0);
    return select(T_INFINITY, t, t > 0.0 && t < t_max);
}

// Haines, Günther and Akenine-Möller 2019, "Precision Improvements for Ray/Sphere Intersection".
fn sphere_hit(o: vec3<f32>, d: vec3<f32>, center: vec3<f32>, radius: f32, t_max: f32) -> f32 {
    let f = o - center;
    let a = dot(d, d);
    let b = -dot(f, d);
    let away = f + (b / a) * d;
    let discriminant = radius * radius - dot(away, away);
    if discriminant < 0.0 {
        return T_INFINITY;
    }
    let distance = length(f);
    let c = (distance - radius) * (distance + radius);
    let root = sqrt(a * discriminant);
    let q = b + select(-root, root, b >= 0.0);
    return sphere_root(select(c / q, 0.0, q == 0.0), q / a, t_max);
}

#if ANCHORED_SPHERES
// k|w|² + 2 n·w = 0 with w measured from the anchor: exact near the anchor
// however large the radius 1/k. n is the outward unit normal there.
fn sphere_hit_anchored(o: vec3<f32>, d: vec3<f32>, anchor: vec3<f32>, n: vec3<f32>, k: f32, t_max: f32) -> f32 {
    let w = o - anchor;
    let a = k * dot(d, d);
    let b = -(k * dot(w, d) + dot(n, d));
    let c = k * dot(w, w) + 2.0 * dot(n, w);
    let discriminant = b * b - a * c;
    if discriminant < 0.0 {
        return T_INFINITY;
    }
    let root = sqrt(discriminant);
    let q = b + select(-root, root, b >= 0.0);
    return sphere_root(select(c / q, 0.0, q == 0.0), q / a, t_max);
}
#endif

fn sphere_record_hit(o: vec3<f32>, d: vec3<f32>, p: Primitive, t_max: f32) -> f32 {
    let radius = bitcast<f32>(p.b.x);
#if ANCHORED_SPHERES
    if p.b.y != 0u {
        let anchor = primitive_point(p.a);
        return sphere_hit_anchored(o, d, anchor, primitive_point(p.c), 1.0 / radius, t_max);
    }
#endif
    return sphere_hit(o, d, primitive_point(p.a), radius, t_max);
}
