// The sampler's numbers drawn from Sobol points. The first two vertices share
// one eight-dimensional point; beyond them stratification buys nothing that
// can be measured, and the numbers are independent.
#import sample/sampler
#import sample/sobol

// Film position within the pixel, or point on the lens.
fn sampler_pair(s: Sampler, group: u32) -> vec2<f32> {
    let seeds = sampler_seeds(s, group, 0u);
    return sobol_pair(sobol_shuffle(s.sample_index, seeds.x), seeds.yz);
}

// At a path vertex: xy for the light, zw for the BSDF.
fn sampler_vertex(s: Sampler, bounce: u32) -> vec4<f32> {
    if bounce >= 2u {
        return uniform_from_bits(sampler_hash(s, GROUP_VERTEX, bounce));
    }
    let shuffle = sampler_seeds(s, GROUP_VERTEX, 0u);
    let index = sobol_shuffle(s.sample_index, shuffle.x);
    let seeds = sampler_seeds(s, GROUP_VERTEX, bounce + 1u);
    if bounce == 0u {
        return sobol_first(index, seeds);
    }
    return sobol_last(index, seeds);
}

// For the light sample number `light_sample` > 0 of a vertex: the vertex's
// samples of all paths through the pixel form one sequence.
fn sampler_light(s: Sampler, bounce: u32, light_sample: u32) -> vec2<f32> {
    let seeds = sampler_seeds(s, GROUP_LIGHT, bounce);
    let index = s.sample_index * (frame.light_samples - 1u) + light_sample - 1u;
    return sobol_pair(sobol_shuffle(index, seeds.x), seeds.yz);
}
