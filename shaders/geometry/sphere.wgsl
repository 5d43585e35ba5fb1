// Ray against sphere, in f32, for spheres that are far, tiny or vast.
#import geometry/primitive

// Roots beyond this are no hits.
const GREATEST_ROOT: f32 = 1e30;

// The least positive of c / q and q / a, the roots of a t² - 2 b t + c = 0 with
// a >= 0, or T_INFINITY. Looks before it divides, so that no quotient is infinite.
fn sphere_root(a: f32, q: f32, c: f32) -> f32 {
    let size = abs(q);
    let signed_c = select(c, -c, q < 0.0);
    var t = T_INFINITY;
    if signed_c > 0.0 && signed_c / GREATEST_ROOT < size {
        t = signed_c / size;
    }
    if q > 0.0 && q / GREATEST_ROOT < a {
        t = min(t, q / a);
    }
    return t;
}

// Haines, Günther and Akenine-Möller 2019, "Precision Improvements for Ray/Sphere Intersection".
fn sphere_hit(o: vec3<f32>, d: vec3<f32>, center: vec3<f32>, radius: f32) -> f32 {
    let f = o - center;
    let a = dot(d, d);
    let b = -dot(f, d);
    let from_center = f + (b / a) * d;
    let discriminant = radius * radius - dot(from_center, from_center);
    if discriminant < 0.0 {
        return T_INFINITY;
    }
    let root = sqrt(a * discriminant);
    let q = b + select(-root, root, b >= 0.0);
    return sphere_root(a, q, dot(f, f) - radius * radius);
}

#if ANCHORED_SPHERES
// k|w|² + 2 n·w = 0 with w measured from the anchor: exact near the anchor
// however large the radius 1/k. n is the outward unit normal there.
fn sphere_hit_anchored(o: vec3<f32>, d: vec3<f32>, anchor: vec3<f32>, n: vec3<f32>, k: f32) -> f32 {
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
    return sphere_root(a, q, c);
}
#endif

fn sphere_record_hit(o: vec3<f32>, d: vec3<f32>, p: Primitive) -> f32 {
    let radius = bitcast<f32>(p.b.x);
#if ANCHORED_SPHERES
    if p.b.y != 0u {
        let anchor = primitive_point(p.a);
        return sphere_hit_anchored(o, d, anchor, primitive_point(p.c), 1.0 / radius);
    }
#endif
    return sphere_hit(o, d, primitive_point(p.a), radius);
}
