// The light that is chosen for a receiver: its index, its probability as chosen and as found again,
// and the probability of a light that the input names.
#import path/path

struct Input {
    // The receiver; and a light's index.
    position: vec4<f32>,
    // The pair that places the sample, and the number that picks the light.
    u: vec4<f32>,
}

@group(0) @binding(20) var<storage, read> inputs: array<Input>;
@group(0) @binding(21) var<storage, read_write> outputs: array<vec4<f32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = inputs[id.x];
    let chosen = light_choose(i.position.xyz, i.u.xy, i.u.z);
    let again = light_pmf(chosen.index, i.position.xyz);
    let asked = light_pmf(u32(i.position.w), i.position.xyz);
    outputs[id.x] = vec4<f32>(f32(chosen.index), chosen.pmf, again, asked);
}
