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

fn surface_at(ray: Ray, hit: Hit) -> Surface {
    let p = primitive_load(hit.primitive);
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
    s.ns = surface_bend(s.ns, s.wo);
#if CLEARCOAT
    s.nv = s.ns;
#endif
    return s;
}

// Turns a shading normal that faces away from wo just into view.
fn surface_bend(ns: vec3<f32>, wo: vec3<f32>) -> vec3<f32> {
    let c = dot(ns, wo);
    if c >= LEAST_COSINE {
        return ns;
    }
    return normalize(ns + (LEAST_COSINE - c) * wo);
}
