// A clear layer of index 1.5 above all else, with a normal of its own (KHR_materials_clearcoat).
#import bsdf/bsdf
#import bsdf/ggx

struct Coat {
    // Unit normal in the base's frame, on wo's side.
    normal: vec3<f32>,
    // GGX width; 0 is a mirror.
    alpha: f32,
    // Share of the light that it reflects, seen from wo; 0 is none.
    reflectance: f32,
}

// Schlick's form for index 1.5.
const COAT_F0: f32 = 0.04;

fn coat_new(factor: f32, roughness: f32, normal: vec3<f32>, wo: vec3<f32>) -> Coat {
    let alpha = roughness * roughness;
    let k = factor * fresnel_schlick(vec3<f32>(COAT_F0), 1.0, abs(dot(normal, wo))).x;
    return Coat(normal, select(alpha, 0.0, alpha < LEAST_ALPHA || k <= 0.0), k);
}

fn coat_eval(b: Bsdf, wo: vec3<f32>, wi: vec3<f32>) -> vec3<f32> {
    let frame_c = frame_from_normal(b.coat.normal);
    let o = wo * frame_c;
    let i = wi * frame_c;
    if b.coat.alpha <= 0.0 || wi.z <= 0.0 || i.z <= 0.0 || o.z <= 0.0 {
        return vec3<f32>(0.0);
    }
    return vec3<f32>(b.coat.reflectance * ggx_eval(width_of(b.coat.alpha), o, i, normalize(o + i)));
}

fn coat_pdf(b: Bsdf, wo: vec3<f32>, wi: vec3<f32>) -> f32 {
    let frame_c = frame_from_normal(b.coat.normal);
    let o = wo * frame_c;
    let i = wi * frame_c;
    if b.coat.alpha <= 0.0 || wi.z <= 0.0 || i.z <= 0.0 || o.z <= 0.0 {
        return 0.0;
    }
    return ggx_pdf(width_of(b.coat.alpha), o, i, normalize(o + i));
}

// 0 where it would lie below the coat's surface or the base's.
fn coat_sample(b: Bsdf, wo: vec3<f32>, u: vec2<f32>) -> vec3<f32> {
    let frame_c = frame_from_normal(b.coat.normal);
    let o = wo * frame_c;
    if o.z <= 0.0 {
        return vec3<f32>(0.0);
    }
    let i = ggx_sample(width_of(b.coat.alpha), o, u);
    return select(vec3<f32>(0.0), ggx_above(frame_c * i), i.z > 0.0);
}
