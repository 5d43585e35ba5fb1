// Next event estimation: direct light at a path vertex by sampling the lights.
// Choosing and tracing are apart, so that threads can trace together.
#import light/light
#import bsdf/scatter
#import sample/sampler
#if LIGHT_CANDIDATES
#import light/candidates
#endif

// A light sample's contribution and the ray that decides whether it arrives.
struct DirectSample {
    // Scattered radiance towards wo if nothing is in the way; 0 needs no ray.
    radiance: vec3<f32>,
    ray: Ray,
}

fn direct_none() -> DirectSample {
    return DirectSample(vec3<f32>(0.0), ray_new(vec3<f32>(0.0), vec3<f32>(0.0, 0.0, 1.0)));
}

// Both ends are off their surfaces, so all of the segment counts.
fn direct_ray(s: Surface, l: LightSample, alpha_seed: u32) -> Ray {
    let origin = ray_spawn(s.position, s.ng, s.offset, l.wi);
    if l.is_infinite {
        return Ray(origin, T_INFINITY, l.wi, alpha_seed);
    }
    return Ray(origin, 1.0, l.target_point - origin, alpha_seed);
}

// What a light sample gives towards wo if nothing is in the way, weighted for its strategy.
fn direct_radiance(s: Surface, b: Bsdf, frame_s: mat3x3<f32>, l: LightSample) -> vec3<f32> {
    let wi = l.wi * frame_s;
    // Light from one side of the true surface and the other of the shading normal's plane would leak.
    let is_above = dot(l.wi, s.ng) > 0.0;
    if max_component(l.weight) <= 0.0 || is_above != (wi.z > 0.0) || !(is_above || bsdf_reaches_below(b)) {
        return vec3<f32>(0.0);
    }
    let wo = s.wo * frame_s;
    let f = bsdf_eval(b, wo, wi);
    if max_component(f) <= 0.0 {
        return vec3<f32>(0.0);
    }
    return f * l.weight * (strategy_light_weight(l.pdf, bsdf_pdf(b, wo, wi)) / f32(frame.light_samples));
}

// The vertex's light sample number `number`. `u` is the first one's place in the vertex's own point.
fn direct_sample(s: Surface, b: Bsdf, frame_s: mat3x3<f32>, sampler_s: Sampler, bounce: u32, u: vec2<f32>, number: u32) -> DirectSample {
    var d = direct_none();
    if !bsdf_is_smooth(b) {
        return d;
    }
    var v = u;
#if MANY_LIGHT_SAMPLES
    if number > 0u {
        v = sampler_light(sampler_s, bounce, number);
    }
#endif
    let choice = sampler_choice(sampler_s, bounce, number);
#if LIGHT_CANDIDATES
    let kept = candidates_sample(s, b, frame_s, v, choice.y, choice.w);
    d.radiance = kept.radiance;
    let l = kept.light;
#else
    let l = light_sample(s, v, choice.y);
    d.radiance = direct_radiance(s, b, frame_s, l);
#endif
    if max_component(d.radiance) > 0.0 {
        d.ray = direct_ray(s, l, sampler_alpha_seed(sampler_s, bounce) + 1u + number);
    }
    return d;
}
