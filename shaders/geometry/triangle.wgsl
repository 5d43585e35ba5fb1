// Ray against triangle: Möller-Trumbore made watertight. Its Rust twin, with the
// derivation of the constants, is src/bvh/triangle.rs.
#import math/math
#import geometry/shear

// What the weights of the vertices say of the line; not yet whether t is in range.
struct TriangleWeights {
    // Of the three vertices, all of one sign where the line meets the triangle.
    w: vec3<f32>,
    is_inside: bool,
}

struct TriangleHit {
    t: f32,
    // Barycentric weights of the second and third vertex.
    u: f32,
    v: f32,
}

// Width of the band about an edge in which Möller-Trumbore is not trusted.
const UNCERTAINTY: f32 = 1.52587890625e-5;
const UNCERTAINTY_FLOOR: f32 = 1.9073486328125e-6;
// Quotients beyond this are not formed.
const GREATEST_T: f32 = 1e30;

// Both ends in one canonical order: neighbours get opposite results to the bit
// also where a compiler fuses one product with the difference. That would leave a rounding
// error where both ends are one point.
fn triangle_edge(a: vec2<f32>, b: vec2<f32>) -> f32 {
    let swap = !(a.x < b.x || (a.x == b.x && a.y < b.y));
    let p = select(a, b, swap);
    let q = select(b, a, swap);
    let e = p.x * q.y - p.y * q.x;
    return select(select(e, -e, swap), 0.0, all(a == b));
}

// Edge functions of the vertices sheared along d into a plane (Woop, Benthin and
// Wald 2013): each vertex by itself, so neighbours agree on a shared edge.
fn triangle_sheared_weights(s: Shear, p0: vec3<f32>, p1: vec3<f32>, p2: vec3<f32>) -> vec3<f32> {
    let a = shear_apply(s, p0);
    let b = shear_apply(s, p1);
    let c = shear_apply(s, p2);
    return s.major * vec3<f32>(triangle_edge(b, c), triangle_edge(c, a), triangle_edge(a, b));
}

// Whether weights of both signs exceed the tolerance.
fn triangle_is_mixed(w: vec3<f32>, tolerance: f32) -> bool {
    return any(w < vec3<f32>(-tolerance)) && any(w > vec3<f32>(tolerance));
}

// Largest magnitudes by component: as integers, whose order is the same.
fn triangle_size(a: vec3<f32>, b: vec3<f32>) -> vec3<f32> {
    let low_bits = vec3<i32>(0x7fffffff);
    return bitcast<vec3<f32>>(max(bitcast<vec3<i32>>(a) & low_bits, bitcast<vec3<i32>>(b) & low_bits));
}

// Whether the line o + t d meets the triangle, from either side. Vertices relative to o.
fn triangle_weights(d: vec3<f32>, shear: Shear, p0: vec3<f32>, p1: vec3<f32>, p2: vec3<f32>) -> TriangleWeights {
    let e1 = p1 - p0;
    let e2 = p2 - p0;
    let q = cross(d, p0);
    let det = dot(d, cross(e1, e2));
    let w1 = -dot(q, e2);
    let w2 = dot(q, e1);
    var w = vec3<f32>(det - w1 - w2, w1, w2);

    let size = triangle_size(triangle_size(p0, p1), p2);
    let edge = triangle_size(e1, e2);
    let vertex_size = size.x + size.y + size.z;
    let edge_size = edge.x + edge.y + edge.z;
    let uncertain = UNCERTAINTY * abs(shear.major) * vertex_size
        * (edge_size + UNCERTAINTY_FLOOR * vertex_size);
    var is_inside = !triangle_is_mixed(w, uncertain);
    if is_inside && any(abs(w) <= vec3<f32>(uncertain)) {
        w = triangle_sheared_weights(shear, p0, p1, p2);
        is_inside = !triangle_is_mixed(w, 0.0);
    }
    return TriangleWeights(w, is_inside);
}

// Distance and barycentric weights of a line that meets the triangle; t < 0 where
// the triangle has no area, and its neighbours cover it. The distance is that of the
// plane, kept within the vertices' range; where the determinant is all error, it
// goes by the weights.
fn triangle_resolve(d: vec3<f32>, p0: vec3<f32>, p1: vec3<f32>, p2: vec3<f32>, w: vec3<f32>) -> TriangleHit {
    let n = cross(p1 - p0, p2 - p0);
    let total = w.x + w.y + w.z;
    let b = w / total;
    let along = vec3<f32>(dot(p0, d), dot(p1, d), dot(p2, d)) / dot(d, d);
    let height = dot(n, p0);
    let det = dot(d, n);
    let least = min(along.x, min(along.y, along.z));
    let planar = min(max(height / det, least), max_component(along));
    let t = select(planar, dot(b, along), abs(height) / GREATEST_T >= abs(det));
    return TriangleHit(select(t, -1.0, total == 0.0), b.y, b.z);
}
