// Directions for the lobes that have a density, uniform over the hemisphere, or over the sphere
// where lobes reach below the surface.
#import bsdf/bsdf

// Density of smooth_sample, including the lobes' probabilities.
fn smooth_pdf(b: Bsdf, lobes: Lobes, wo: vec3<f32>, wi: vec3<f32>) -> f32 {
    var share = lobes.diffuse + select(0.0, lobes.specular, width_is_rough(b.alpha));
#if ROUGH_TRANSMISSION
    share += select(0.0, lobes.transmitted, bsdf_refracts_roughly(b));
#endif
#if SHEEN
    share += lobes.sheen;
#endif
#if CLEARCOAT
    share += select(0.0, lobes.coat, b.coat.alpha > 0.0);
#endif
#if DIFFUSE_TRANSMISSION
    share += lobes.diffuse_below;
#endif
    if bsdf_reaches_below(b) {
        return share * (0.25 * INV_PI);
    }
    return select(0.0, share * (0.5 * INV_PI), wi.z > 0.0);
}

fn smooth_sample(b: Bsdf, lobes: Lobes, wo: vec3<f32>, u: vec3<f32>, share: f32) -> SmoothDirection {
    if bsdf_reaches_below(b) {
        return SmoothDirection(warp_sphere(u.xy), u.z);
    }
    return SmoothDirection(warp_uniform_hemisphere(u.xy), u.z);
}
