// Directions for the lobes that have a density, drawn by those lobes.
#import bsdf/bsdf

// Density of smooth_sample, including the lobes' probabilities.
fn smooth_pdf(b: Bsdf, lobes: Lobes, wo: vec3<f32>, wi: vec3<f32>) -> f32 {
    if wi.z <= 0.0 {
        return 0.0;
    }
    var pdf = lobes.diffuse * lambert_pdf(wi);
#if GGX
    if b.alpha > 0.0 {
        pdf += lobes.specular * ggx_pdf(b.alpha, wo, wi, normalize(wo + wi));
    }
#endif
    return pdf;
}

// `share` of the probability is left to these lobes; u.x is uniform over it.
fn smooth_sample(b: Bsdf, lobes: Lobes, wo: vec3<f32>, u: vec2<f32>, share: f32) -> vec3<f32> {
#if GGX
    let diffuse = lobes.diffuse / share;
    if b.alpha > 0.0 && u.x >= diffuse {
        return ggx_sample(b.alpha, wo, vec2<f32>(min((u.x - diffuse) / (1.0 - diffuse), ONE_BELOW), u.y));
    }
    if b.alpha > 0.0 {
        return lambert_sample(vec2<f32>(min(u.x / diffuse, ONE_BELOW), u.y));
    }
#endif
    return lambert_sample(u);
}
