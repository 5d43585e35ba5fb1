// Directions for the lobes that have a density, uniform over the hemisphere.
#import bsdf/bsdf

// Density of smooth_sample, including the lobes' probabilities.
fn smooth_pdf(b: Bsdf, lobes: Lobes, wo: vec3<f32>, wi: vec3<f32>) -> f32 {
    let share = lobes.diffuse + select(0.0, lobes.specular, b.alpha > 0.0);
    return select(0.0, share * (0.5 * INV_PI), wi.z > 0.0);
}

fn smooth_sample(b: Bsdf, lobes: Lobes, wo: vec3<f32>, u: vec2<f32>, share: f32) -> vec3<f32> {
    return warp_uniform_hemisphere(u);
}
