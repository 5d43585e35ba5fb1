// Next event estimation: direct light at a path vertex by sampling the lights.
#import light/light
#import bsdf/scatter
#if BRUTE_FORCE
#import geometry/brute_force
#else
#import geometry/bvh
#endif
#import sample/sampler

// Shadow rays traced by this thread.
var<private> direct_ray_count: u32 = 0u;

// Whether the segment from the surface to the light sample meets anything.
fn direct_is_occluded(s: Surface, l: LightSample, alpha_seed: u32) -> bool {
    let origin = ray_spawn(s.position, s.ng, s.offset, l.wi);
    if l.is_infinite {
        return bvh_any_hit(Ray(origin, T_INFINITY, l.wi, alpha_seed));
    }
    // Both ends are off their surfaces, so the whole segment counts.
    return bvh_any_hit(Ray(origin, 1.0, l.target_point - origin, alpha_seed));
}

// One light sample's contribution: scattered radiance towards s.wo.
fn direct_sample(s: Surface, b: Bsdf, frame_s: mat3x3<f32>, u: vec2<f32>, choice: f32, alpha_seed: u32) -> vec3<f32> {
    let l = light_sample(s, u, choice);
    let wi = l.wi * frame_s;
    let wo = s.wo * frame_s;
    // Light from behind the true surface would leak through it.
    if max_component(l.weight) <= 0.0 || dot(l.wi, s.ng) <= 0.0 {
        return vec3<f32>(0.0);
    }
    let f = bsdf_eval(b, wo, wi);
    if max_component(f) <= 0.0 {
        return vec3<f32>(0.0);
    }
    direct_ray_count += 1u;
    if direct_is_occluded(s, l, alpha_seed) {
        return vec3<f32>(0.0);
    }
    return f * l.weight * strategy_light_weight(l.pdf, bsdf_pdf(b, wo, wi));
}



// Mean over the vertex's light samples. `u` is the first one's place in the vertex's own point.
fn direct_light(s: Surface, b: Bsdf, frame_s: mat3x3<f32>, sampler_s: Sampler, bounce: u32, u: vec2<f32>) -> vec3<f32> {
    if frame.light_count == 0u || !bsdf_is_smooth(b) {
        return vec3<f32>(0.0);
    }
    let alpha_seed = sampler_alpha_seed(sampler_s, bounce) + 1u;
    var sum = direct_sample(s, b, frame_s, u, sampler_choice(sampler_s, bounce).y, alpha_seed);
#if MANY_LIGHT_SAMPLES
    for (var i = 1u; i < frame.light_samples; i++) {
        let v = sampler_light(sampler_s, bounce, i);
        let choice = sampler_choice(sampler_s, bounce | (i << 16u)).y;
        sum += direct_sample(s, b, frame_s, v, choice, alpha_seed + i);
    }
#endif
    return sum / f32(frame.light_samples);
}
