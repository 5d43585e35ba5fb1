// The sampler's numbers drawn independently.
#import sample/sampler

// Film position within the pixel, or point on the lens.
fn sampler_pair(s: Sampler, group: u32) -> vec2<f32> {
    return uniform_from_bits(sampler_hash(s, group, 0u)).xy;
}

// At a path vertex: xy for the light, zw for the BSDF.
fn sampler_vertex(s: Sampler, bounce: u32) -> vec4<f32> {
    return uniform_from_bits(sampler_hash(s, GROUP_VERTEX, bounce));
}

// For the light sample number `light_sample` > 0 of a vertex.
fn sampler_light(s: Sampler, bounce: u32, light_sample: u32) -> vec2<f32> {
    return uniform_from_bits(sampler_hash(s, GROUP_LIGHT, sampler_place(bounce, light_sample))).xy;
}
