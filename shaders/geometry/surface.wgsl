// A hit resolved to a point with normals, attributes and material.
#import frame/frame
#import geometry/primitive
#if TRIANGLES
#import geometry/surface_triangle
#endif
#if SPHERES
#import geometry/surface_sphere
#endif

// The least cosine between the shading normal and wo.
const LEAST_COSINE: f32 = 1e-4;

struct Surface {
    position: vec3<f32>,
    // By how far rays must leave the surface along ng.
    offset: f32,
    // Unit normals on wo's side.
    ng: vec3<f32>,
    ns: vec3<f32>,
#if CLEARCOAT
    // The vertices' normal, also where ns follows a normal map.
    nv: vec3<f32>,
#endif
    // Unit tangent along u and the bitangent's sign; 0 where there are no texture coordinates.
    tangent: vec4<f32>,
    // Towards where the path came from.
    wo: vec3<f32>,
    // Whether wo is on the side that the file calls front.
    is_front: bool,
    material: u32,
    // Index into `lights`, or INVALID.
    light: u32,
    // Texture coordinates, sets 0 and 1.
    uv: vec4<f32>,
    // Linear vertex colour.
    color: vec4<f32>,
}

// Scaled by the largest component first, so that no square overflows or vanishes.
fn surface_unit(v: vec3<f32>) -> vec3<f32> {
    let m = max_component(abs(v));
    return select(normalize(v / m), vec3<f32>(0.0, 0.0, 1.0), m == 0.0);
}

// Where the last walk has hit.
fn surface_at(ray: Ray, hit: Hit) -> Surface {
    let p = primitive_of(hit.primitive);
    var s: Surface;
    s.material = primitive_material(p);
    s.light = primitive_light(p);
    s.wo = -normalize(ray.direction);
    s.color = vec4<f32>(1.0);
#if TRIANGLES
    if hit.instance != HIT_SPHERE {
        s = surface_triangle(s, p, hit);
    }
#endif
#if SPHERES
    if hit.instance == HIT_SPHERE {
        s = surface_sphere(s, p, ray, hit);
    }
#endif
    s.is_front = dot(s.ng, s.wo) >= 0.0;
    if !s.is_front {
        s.ng = -s.ng;
        s.ns = -s.ns;
    }
#if CLEARCOAT
    s.nv = s.ns;
#endif
    return s;
}

// A shading normal by which a surface can be shaded: turned just into view where it faces away from
// wo, and towards ng as far as it takes for wo's mirror image to be above the true surface. Otherwise
// rims and steep normal maps would be black where they should reflect what is at the horizon.
fn surface_bend(ns: vec3<f32>, ng: vec3<f32>, wo: vec3<f32>) -> vec3<f32> {
    var n = ns;
    let c = dot(n, wo);
    if c < LEAST_COSINE {
        n = normalize(n + (LEAST_COSINE - c) * wo);
    }
#if ATTRIBUTES
    n = surface_reflecting(n, ng, wo);
#endif
    return n;
}

#if ATTRIBUTES
// The cosine to ng that a mirror image shall have, if wo's own is larger.
const LEAST_MIRRORED_COSINE: f32 = 0.01;

// The unit vector along n + k ng, k >= 0, about which the mirror image of wo has at least that
// cosine to ng: 2 (n.wo) (n.ng) - wo.ng, a quadratic in k.
fn surface_reflecting(n: vec3<f32>, ng: vec3<f32>, wo: vec3<f32>) -> vec3<f32> {
    let cos_o = max(dot(ng, wo), 0.0);
    let least = min(0.9 * cos_o, LEAST_MIRRORED_COSINE);
    let n_wo = dot(n, wo);
    let n_ng = dot(n, ng);
    let excess = 2.0 * n_wo * n_ng - cos_o - least;
    if excess >= 0.0 {
        return n;
    }
    let half_slope = n_wo - n_ng * least;
    let root = sqrt(max(half_slope * half_slope - (cos_o - least) * excess, 0.0));
    return normalize(n - (excess / (half_slope + root)) * ng);
}
#endif
