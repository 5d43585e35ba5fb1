// Ray against triangle: Möller-Trumbore made watertight. Its Rust twin, with the
// derivation of the constants, is src/bvh/triangle.rs.
#import math/math

struct TriangleHit {
    // Ray parameter; negative for a miss.
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

// Which component of d has the largest magnitude: 2, 0 or 1 for z, x, y.
fn triangle_major(d: vec3<f32>) -> u32 {
    let m = abs(d);
    if m.z >= max(m.x, m.y) {
        return 2u;
    }
    return select(1u, 0u, m.x >= m.y);
}

// Rotates the components so that the major one comes last.
fn triangle_rotate(v: vec3<f32>, major: u32) -> vec3<f32> {
    return select(select(v.zxy, v.yzx, major == 0u), v, major == 2u);
}

// Both ends in one canonical order: neighbours get opposite results to the bit
// also where a compiler fuses one product with the difference.
fn triangle_edge(a: vec2<f32>, b: vec2<f32>) -> f32 {
    let swap = !(a.x < b.x || (a.x == b.x && a.y < b.y));
    let p = select(a, b, swap);
    let q = select(b, a, swap);
    let e = p.x * q.y - p.y * q.x;
    return select(e, -e, swap);
}

// Edge functions of the vertices sheared along d into a plane (Woop, Benthin and
// Wald 2013): each vertex by itself, so neighbours agree on a shared edge.
fn triangle_sheared_weights(d: vec3<f32>, p0: vec3<f32>, p1: vec3<f32>, p2: vec3<f32>) -> vec3<f32> {
    let major = triangle_major(d);
    let r = triangle_rotate(d, major);
    let s = r.xy / r.z;
    let a3 = triangle_rotate(p0, major);
    let b3 = triangle_rotate(p1, major);
    let c3 = triangle_rotate(p2, major);
    let a = a3.xy - s * a3.z;
    let b = b3.xy - s * b3.z;
    let c = c3.xy - s * c3.z;
    return r.z * vec3<f32>(triangle_edge(b, c), triangle_edge(c, a), triangle_edge(a, b));
}

// Where the line o + t d meets the plane, kept within the vertices' range; by the
// weights where the determinant is all error.
fn triangle_distance(d: vec3<f32>, p: mat3x3<f32>, b: vec3<f32>, height: f32, det: f32) -> f32 {
    let along = (d * p) / dot(d, d);
    if abs(height) / GREATEST_T >= abs(det) {
        return dot(b, along);
    }
    let least = min(along.x, min(along.y, along.z));
    return min(max(height / det, least), max_component(along));
}

// Meets the triangle from either side with the line o + t d. d need not be a unit vector.
fn triangle_hit(o: vec3<f32>, d: vec3<f32>, v0: vec3<f32>, v1: vec3<f32>, v2: vec3<f32>) -> TriangleHit {
    let miss = TriangleHit(-1.0, 0.0, 0.0);
    let p0 = v0 - o;
    let p1 = v1 - o;
    let p2 = v2 - o;
    let e1 = p1 - p0;
    let e2 = p2 - p0;
    let q = cross(d, p0);
    let n = cross(e1, e2);
    let det = dot(d, n);
    let w1 = -dot(q, e2);
    let w2 = dot(q, e1);
    var w = vec3<f32>(det - w1 - w2, w1, w2);

    let size = max(max(abs(p0), abs(p1)), abs(p2));
    let edge = max(abs(e1), abs(e2));
    let vertex_size = size.x + size.y + size.z;
    let edge_size = edge.x + edge.y + edge.z;
    let uncertain = UNCERTAINTY * max_component(abs(d)) * vertex_size
        * (edge_size + UNCERTAINTY_FLOOR * vertex_size);
    if min(w.x, min(w.y, w.z)) < -uncertain && max_component(w) > uncertain {
        return miss;
    }
    let magnitude = abs(w);
    if min(magnitude.x, min(magnitude.y, magnitude.z)) <= uncertain {
        // A triangle without area has no normal: its neighbours cover it.
        if all(cross(v1 - v0, v2 - v0) == vec3<f32>(0.0)) {
            return miss;
        }
        w = triangle_sheared_weights(d, p0, p1, p2);
        if min(w.x, min(w.y, w.z)) < 0.0 && max_component(w) > 0.0 {
            return miss;
        }
    }
    let total = w.x + w.y + w.z;
    if total == 0.0 {
        return miss;
    }
    let b = w / total;
    let t = triangle_distance(d, mat3x3<f32>(p0, p1, p2), b, dot(n, p0), det);
    return TriangleHit(t, b.y, b.z);
}
