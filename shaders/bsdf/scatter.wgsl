// One scattered direction: a delta lobe, or a lobe with a density.
#import bsdf/bsdf
#if HEMISPHERE
#import bsdf/smooth_hemisphere
#else
#import bsdf/smooth
#endif

fn bsdf_pdf(b: Bsdf, wo: vec3<f32>, wi: vec3<f32>) -> f32 {
    return smooth_pdf(b, bsdf_lobes(b, wo.z), wo, wi);
}

// `u` and `choice` are uniform.
fn bsdf_sample(b: Bsdf, wo: vec3<f32>, u: vec2<f32>, choice: f32) -> BsdfSample {
    let lobes = bsdf_lobes(b, wo.z);
    var x = u.x;
#if DELTA
    let is_rough = width_is_rough(b.alpha);
    let mirror = select(lobes.specular, 0.0, is_rough);
    if x < mirror {
        return delta_reflect(b, wo, mirror, choice);
    }
    let passing = select(lobes.transmitted, 0.0, is_rough);
#if TRANSMISSION
    if x < mirror + passing {
        return delta_transmit(b, wo, passing, choice);
    }
#endif
    x = x - mirror - passing;
    var share = 1.0 - mirror - passing;
#if CLEARCOAT
    let coat = select(lobes.coat, 0.0, b.coat.alpha > 0.0);
    if coat > 0.0 && x < coat {
        return delta_coat(b, wo, coat, choice);
    }
    x -= coat;
    share -= coat;
#endif
    if share <= 0.0 {
        return SAMPLE_NONE;
    }
    x = clamp(x / share, 0.0, ONE_BELOW);
#else
    let share = 1.0;
#endif
    let d = smooth_sample(b, lobes, wo, vec3<f32>(x, u.y, choice), share);
    let pdf = smooth_pdf(b, lobes, wo, d.wi);
    if pdf <= 0.0 {
        return SAMPLE_NONE;
    }
    var scale = 1.0;
#if ROUGH_TRANSMISSION
    scale = select(1.0, b.eta * b.eta, d.wi.z < 0.0 && !b.is_thin && bsdf_refracts_roughly(b));
#endif
    return BsdfSample(d.wi, pdf, bsdf_eval(b, wo, d.wi) / pdf, scale, d.choice);
}

#if DELTA
fn delta_reflect(b: Bsdf, wo: vec3<f32>, probability: f32, choice: f32) -> BsdfSample {
    let f = bsdf_reflectance(b, wo.z).specular * bsdf_base_factor(b, wo.z);
    return BsdfSample(vec3<f32>(-wo.xy, wo.z), PDF_DELTA, f / probability, 1.0, choice);
}
#endif

#if TRANSMISSION
// Radiance is scaled by eta² where light crosses into another medium (Veach 1997, section 5.2).
fn delta_transmit(b: Bsdf, wo: vec3<f32>, probability: f32, choice: f32) -> BsdfSample {
    let f = fresnel_dielectric(wo.z, b.eta);
    if f.reflectance >= 1.0 {
        return SAMPLE_NONE;
    }
    let weight = b.transmitted * (bsdf_reflectance(b, wo.z).under / probability);
    if b.is_thin {
        return BsdfSample(-wo, PDF_DELTA, weight * bsdf_base_factor(b, wo.z), 1.0, choice);
    }
    let scale = b.eta * b.eta;
    let wi = dielectric_refract(wo, b.eta, f.cos_t);
    return BsdfSample(wi, PDF_DELTA, bsdf_base_factor(b, wi.z) * weight * scale, scale, choice);
}
#endif

#if CLEARCOAT
// The coat's mirror image about its own normal.
fn delta_coat(b: Bsdf, wo: vec3<f32>, probability: f32, choice: f32) -> BsdfSample {
    let n = b.coat.normal;
    let wi = normalize(2.0 * dot(n, wo) * n - wo);
    if wi.z <= 0.0 {
        return SAMPLE_NONE;
    }
    return BsdfSample(wi, PDF_DELTA, vec3<f32>(b.coat.reflectance / probability), 1.0, choice);
}
#endif
