// The words behind a sampler's numbers: of one sample, and of all samples of a pixel.
#import sample/sampler

struct Input {
    pixel: u32,
    sample_index: u32,
    group: u32,
    place: u32,
}

@group(0) @binding(20) var<storage, read> inputs: array<Input>;
@group(0) @binding(21) var<storage, read_write> outputs: array<vec4<u32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = inputs[id.x];
    let s = Sampler(i.pixel, i.sample_index);
    outputs[2u * id.x] = sampler_hash(s, i.group, i.place);
    outputs[2u * id.x + 1u] = sampler_seeds(s, i.group, i.place);
}
