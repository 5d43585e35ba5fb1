// GGX reflection with height-correlated Smith masking (Heitz 2014), sampled by
// visible normals (Heitz 2018). Forms without cancellation at small alpha.
#import math/math
#import sample/warp
#import bsdf/width

// Density of microfacet normals, per solid angle of h.
fn ggx_d(alpha: GgxWidth, h: vec3<f32>) -> f32 {
#if ANISOTROPY
    let a2 = alpha.x * alpha.y;
    var e = h.z * h.z * a2 + h.x * h.x + h.y * h.y;
    if alpha.x != alpha.y {
        let ratio = alpha.y / alpha.x;
        e = h.z * h.z * a2 + h.x * h.x * ratio + h.y * h.y / ratio;
    }
#else
    let a2 = alpha * alpha;
    let e = h.z * h.z * a2 + h.x * h.x + h.y * h.y;
#endif
    return a2 / (PI * e * e);
}

// sqrt(cos² + α² sin²): Smith's G1 is 2 cos / (cos + this).
fn ggx_smith(alpha: GgxWidth, w: vec3<f32>) -> f32 {
#if ANISOTROPY
    if alpha.x != alpha.y {
        let v = alpha * w.xy;
        return sqrt(w.z * w.z + dot(v, v));
    }
    return sqrt(w.z * w.z + alpha.x * alpha.x * (w.x * w.x + w.y * w.y));
#else
    return sqrt(w.z * w.z + alpha * alpha * (w.x * w.x + w.y * w.y));
#endif
}

// Density of ggx_sample: D G1(wo) / (4 cos wo).
fn ggx_pdf(alpha: GgxWidth, wo: vec3<f32>, wi: vec3<f32>, h: vec3<f32>) -> f32 {
    return ggx_d(alpha, h) / (2.0 * (wo.z + ggx_smith(alpha, wo)));
}

// D G2 / (4 cos wo), without Fresnel: the density times G2 / G1, which never exceeds 1.
fn ggx_eval(alpha: GgxWidth, wo: vec3<f32>, wi: vec3<f32>, h: vec3<f32>) -> f32 {
    let so = ggx_smith(alpha, wo);
    let si = ggx_smith(alpha, wi);
    let visible = wi.z * (wo.z + so) / (wo.z * si + wi.z * so);
    return ggx_pdf(alpha, wo, wi, h) * visible;
}

// A visible microfacet's normal: density G1(wo) D (wo.h) / cos wo.
fn ggx_sample_normal(alpha: GgxWidth, wo: vec3<f32>, u: vec2<f32>) -> vec3<f32> {
    let v = normalize(vec3<f32>(alpha * wo.xy, wo.z));
    let frame_v = frame_from_normal(v);
    let t1 = select(frame_v[0], normalize(vec3<f32>(-v.y, v.x, 0.0)), v.x != 0.0 || v.y != 0.0);
    let t2 = cross(v, t1);
    let disk = warp_disk(u);
    let s = 0.5 * (1.0 + v.z);
    let y = mix(sqrt(max(0.0, 1.0 - disk.x * disk.x)), disk.y, s);
    let z = sqrt(max(0.0, 1.0 - disk.x * disk.x - y * y));
    let n = disk.x * t1 + y * t2 + z * v;
    return normalize(vec3<f32>(alpha * n.xy, max(n.z, 1e-9)));
}

// The direction in which wo is reflected by a visible microfacet; may lie below the surface.
fn ggx_sample(alpha: GgxWidth, wo: vec3<f32>, u: vec2<f32>) -> vec3<f32> {
    let h = ggx_sample_normal(alpha, wo, u);
    return normalize(2.0 * dot(wo, h) * h - wo);
}

// A reflected direction, or 0 if it lies below the surface, where other lobes may have a density.
fn ggx_above(wi: vec3<f32>) -> vec3<f32> {
    return select(vec3<f32>(0.0), wi, wi.z > 0.0);
}
