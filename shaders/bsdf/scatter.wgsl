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

fn bsdf_sample(b: Bsdf, wo: vec3<f32>, u: vec2<f32>) -> BsdfSample {
    let lobes = bsdf_lobes(b, wo.z);
    var x = u.x;
#if DELTA
    let mirror = select(lobes.specular, 0.0, b.alpha > 0.0);
    if x < mirror {
        return delta_reflect(b, wo, mirror);
    }
#if TRANSMISSION
    if x < mirror + lobes.transmitted {
        return delta_transmit(b, wo, lobes.transmitted);
    }
#endif
    let share = 1.0 - mirror - lobes.transmitted;
    if share <= 0.0 {
        return SAMPLE_NONE;
    }
    x = min((x - mirror - lobes.transmitted) / share, ONE_BELOW);
#else
    let share = 1.0;
#endif
    let wi = smooth_sample(b, lobes, wo, vec2<f32>(x, u.y), share);
    let pdf = smooth_pdf(b, lobes, wo, wi);
    if pdf <= 0.0 {
        return SAMPLE_NONE;
    }
    return BsdfSample(wi, pdf, bsdf_eval(b, wo, wi) / pdf, 1.0);
}

#if DELTA
fn delta_reflect(b: Bsdf, wo: vec3<f32>, probability: f32) -> BsdfSample {
    var f = bsdf_specular_fresnel(b, wo.z);
#if TRANSMISSION
    if bsdf_transmits(b) {
        f = vec3<f32>(fresnel_dielectric(wo.z, b.eta).reflectance);
    }
#endif
    return BsdfSample(vec3<f32>(-wo.xy, wo.z), PDF_DELTA, f / probability, 1.0);
}
#endif

#if TRANSMISSION
// Radiance is scaled by eta² where light crosses into another medium (Veach 1997, section 5.2).
fn delta_transmit(b: Bsdf, wo: vec3<f32>, probability: f32) -> BsdfSample {
    let f = fresnel_dielectric(wo.z, b.eta);
    if f.reflectance >= 1.0 {
        return SAMPLE_NONE;
    }
    let weight = b.transmitted * ((1.0 - f.reflectance) / probability);
    if b.is_thin {
        return BsdfSample(-wo, PDF_DELTA, weight, 1.0);
    }
    let scale = b.eta * b.eta;
    return BsdfSample(dielectric_refract(wo, b.eta, f.cos_t), PDF_DELTA, weight * scale, scale);
}
#endif
