// The light that a number picks: its index, where its interval begins, its probability, and the
// number of lights.
#import path/path

@group(0) @binding(20) var<storage, read> inputs: array<f32>;
@group(0) @binding(21) var<storage, read_write> outputs: array<vec4<f32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let index = light_pick(inputs[id.x]);
    let l = lights[index];
    outputs[id.x] = vec4<f32>(f32(index), l.cdf, l.pmf, f32(frame.light_count));
}
