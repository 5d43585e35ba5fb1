// Smooth interfaces between dielectrics.
#import math/math

struct DielectricFresnel {
    // Share of unpolarised light that is reflected; exactly 1 beyond the critical angle.
    reflectance: f32,
    // Cosine of the refracted direction; meaningful where reflectance < 1.
    cos_t: f32,
}

// eta: index on the side of the incident direction over the index beyond.
fn fresnel_dielectric(cos_i: f32, eta: f32) -> DielectricFresnel {
    // 1 - eta² sin², in a form that loses nothing where indices nearly agree.
    let cos2_t = cos_i * cos_i + (1.0 - eta) * (1.0 + eta) * (1.0 - cos_i) * (1.0 + cos_i);
    if cos2_t <= 0.0 {
        return DielectricFresnel(1.0, 0.0);
    }
    let cos_t = sqrt(cos2_t);
    let s = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    let p = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    return DielectricFresnel(min(0.5 * (s * s + p * p), 1.0), cos_t);
}

// The refracted direction, on the far side of the surface. |result| = 1.
fn dielectric_refract(wo: vec3<f32>, eta: f32, cos_t: f32) -> vec3<f32> {
    return normalize(vec3<f32>(-eta * wo.xy, -cos_t));
}
