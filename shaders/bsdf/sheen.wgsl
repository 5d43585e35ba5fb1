// Sheen: fibres above the base. KHR_materials_sheen's distribution of normals with the masking
// that Estevez and Kulla (2017, "Production Friendly Microfacet Sheen BRDF") fitted to it.
// Below a roughness of about 0.2 that reflects more light than arrives near grazing: it is divided
// by its own albedo there.
#import bsdf/bsdf
#import bsdf/albedo_tables
#import math/exponential

struct Sheen {
    // Reflectance at grazing incidence; 0 is none.
    color: vec3<f32>,
    alpha: f32,
    // Directional albedo of its largest component at wo, at most 1; and that of white sheen.
    albedo: f32,
    white: f32,
}

// The least alpha: its lobe is below 0.1 degrees above the horizon.
const SHEEN_LEAST_ALPHA: f32 = 1e-3;

fn sheen_new(color: vec3<f32>, roughness: f32, cos_o: f32) -> Sheen {
    let alpha = max(roughness * roughness, SHEEN_LEAST_ALPHA);
    let white = albedo_of_sheen(cos_o, alpha);
    return Sheen(color, alpha, min(max_component(color) * min(white, 1.0), 1.0), white);
}

// Its share of the scattered light.
fn sheen_share(b: Bsdf) -> f32 {
    return b.sheen.albedo;
}

// What it leaves of light from below, between wo and a direction of this cosine.
fn sheen_leaves(b: Bsdf, cos_i: f32) -> f32 {
    if b.sheen.albedo <= 0.0 {
        return 1.0;
    }
    let albedo_i = max_component(b.sheen.color) * min(albedo_of_sheen(cos_i, b.sheen.alpha), 1.0);
    return 1.0 - max(b.sheen.albedo, min(albedo_i, 1.0));
}

// Logarithm of Smith's auxiliary function: the fit for a cosine of at most 0.5.
fn sheen_fit(x: f32, alpha: f32) -> f32 {
    let p = (1.0 - alpha) * (1.0 - alpha);
    let a = mix(21.5473, 25.3245, p);
    let b = mix(3.82987, 3.32435, p);
    let c = mix(0.19823, 0.16801, p);
    let d = mix(-1.97760, -1.27393, p);
    let e = mix(-4.32054, -4.85967, p);
    let power = select(0.0, exp_accurate(c * log_accurate(x)), x > 0.0);
    return a / (1.0 + b * power) + d * x + e;
}

fn sheen_lambda(cosine: f32, alpha: f32) -> f32 {
    if cosine < 0.5 {
        return exp_accurate(sheen_fit(cosine, alpha));
    }
    return exp_accurate(2.0 * sheen_fit(0.5, alpha) - sheen_fit(max(1.0 - cosine, 0.0), alpha));
}

// Density of fibres' normals; cos2_h: square of the half vector's cosine.
fn sheen_d(cos2_h: f32, alpha: f32) -> f32 {
    let log_sin2 = select(log_accurate(max(1.0 - cos2_h, 1e-30)), log_of_one_less(cos2_h), cos2_h < 0.25);
    return (2.0 + 1.0 / alpha) * (0.5 * INV_PI) * exp_accurate(log_sin2 * (0.5 / alpha));
}

fn sheen_eval(b: Bsdf, wo: vec3<f32>, wi: vec3<f32>) -> vec3<f32> {
    if b.sheen.albedo <= 0.0 || wi.z <= 0.0 {
        return vec3<f32>(0.0);
    }
    let h = wo + wi;
    let d = sheen_d(h.z * h.z / dot(h, h), b.sheen.alpha);
    let masking = 1.0 + sheen_lambda(wo.z, b.sheen.alpha) + sheen_lambda(wi.z, b.sheen.alpha);
    let most = max(b.sheen.white, albedo_of_sheen(wi.z, b.sheen.alpha));
    let value = d / (4.0 * wo.z * masking * max(most, 1.0));
#if CLEARCOAT
    return b.sheen.color * (value * (1.0 - b.coat.reflectance));
#else
    return b.sheen.color * value;
#endif
}

// Uniform over the hemisphere: the lobe is broad, and lies near the horizon where it is not.
fn sheen_sample(b: Bsdf, wo: vec3<f32>, u: vec2<f32>) -> vec3<f32> {
    return warp_uniform_hemisphere(u);
}

fn sheen_pdf(b: Bsdf, wo: vec3<f32>, wi: vec3<f32>) -> f32 {
    return select(0.0, 0.5 * INV_PI, wi.z > 0.0);
}
