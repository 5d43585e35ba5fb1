// Light that passes a rough interface, without Fresnel's factor: refracted by GGX's microfacets
// (Walter et al. 2007, separable masking), or through a thin sheet, reflected and mirrored down.
#import bsdf/bsdf
#import bsdf/ggx

// The microfacet that refracts wo into wi, and the density of that by visible microfacets.
struct Refraction {
    h: vec3<f32>,
    // Per solid angle of wi; 0 where no microfacet does it.
    pdf: f32,
}

// The same vector with z turned to the other side.
fn refraction_mirrored(w: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(w.xy, -w.z);
}

// v = η wo + wi is along h, and its length is the Jacobian's wi.h + η wo.h: no difference of
// large numbers but v itself.
fn refraction_at(b: Bsdf, wo: vec3<f32>, wi: vec3<f32>) -> Refraction {
    let v = b.eta * wo + wi;
    let length2 = dot(v, v);
    if length2 <= 0.0 {
        return Refraction(vec3<f32>(0.0, 0.0, 1.0), 0.0);
    }
    let n = v / sqrt(length2);
    let h = select(n, -n, n.z < 0.0);
    let cos_o = dot(wo, h);
    let cos_i = dot(wi, h);
    if cos_o <= 0.0 || cos_i >= 0.0 {
        return Refraction(h, 0.0);
    }
    let visible = 2.0 * ggx_d(b.alpha, h) * cos_o / (wo.z + ggx_smith(b.alpha, wo));
    return Refraction(h, visible * -cos_i / length2);
}

// Density of refraction_sample at wi below the surface, times the probability of passing.
fn refraction_pdf(b: Bsdf, wo: vec3<f32>, wi: vec3<f32>) -> f32 {
    if b.is_thin {
        let up = refraction_mirrored(wi);
        let h = normalize(wo + up);
        return ggx_pdf(b.alpha, wo, up, h) * (1.0 - refraction_reflects(b, dot(wo, h)));
    }
    let r = refraction_at(b, wo, wi);
    if r.pdf <= 0.0 {
        return 0.0;
    }
    return r.pdf * (1.0 - refraction_reflects(b, dot(wo, r.h)));
}

// Radiance through the surface for unit radiance from wi below, |cos wi| included.
fn refraction_eval(b: Bsdf, wo: vec3<f32>, wi: vec3<f32>) -> vec3<f32> {
    if b.is_thin {
        let up = refraction_mirrored(wi);
        let h = normalize(wo + up);
        return b.transmitted * (bsdf_reflectance(b, dot(wo, h)).under * ggx_eval(b.alpha, wo, up, h));
    }
    let r = refraction_at(b, wo, wi);
    if r.pdf <= 0.0 {
        return vec3<f32>(0.0);
    }
    let visible = 2.0 * -wi.z / (ggx_smith(b.alpha, wi) - wi.z);
    let under = bsdf_reflectance(b, dot(wo, r.h)).under;
    return b.transmitted * (under * r.pdf * visible * b.eta * b.eta);
}

// Probability that a microfacet reflects rather than passes light, by what it does of both.
fn refraction_reflects(b: Bsdf, cos_h: f32) -> f32 {
    let r = bsdf_reflectance(b, cos_h);
    let reflected = max_component(r.specular);
    let sum = reflected + luminance(b.transmitted) * r.under;
    return select(1.0, reflected / sum, sum > 0.0);
}

// wo refracted by the microfacet h; 0 beyond the critical angle.
fn refraction_of(b: Bsdf, wo: vec3<f32>, h: vec3<f32>) -> vec3<f32> {
    let cos_h = dot(wo, h);
    let f = fresnel_dielectric(cos_h, b.eta);
    if f.reflectance >= 1.0 {
        return vec3<f32>(0.0);
    }
    // η cos - cos_t as a quotient.
    let along = (b.eta - 1.0) * (b.eta + 1.0) / (b.eta * cos_h + f.cos_t);
    return normalize(along * h - b.eta * wo);
}

// A direction reflected or passed by a visible microfacet; `choice` is uniform, and what is left
// of it is uniform again.
fn refraction_sample(b: Bsdf, wo: vec3<f32>, u: vec2<f32>, choice: f32) -> SmoothDirection {
    let h = ggx_sample_normal(b.alpha, wo, u);
    let q = refraction_reflects(b, dot(wo, h));
    let reflected = ggx_above(normalize(2.0 * dot(wo, h) * h - wo));
    if choice < q {
        return SmoothDirection(reflected, min(choice / q, ONE_BELOW));
    }
    let rest = min((choice - q) / (1.0 - q), ONE_BELOW);
    if b.is_thin {
        return SmoothDirection(refraction_mirrored(reflected), rest);
    }
    let wi = refraction_of(b, wo, h);
    return SmoothDirection(select(vec3<f32>(0.0), wi, wi.z < 0.0), rest);
}
