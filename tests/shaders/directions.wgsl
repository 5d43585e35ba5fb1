// Directions as samplers make them: squared lengths.
#import sample/warp
#import bsdf/ggx

// A uniform pair, alpha.
@group(0) @binding(20) var<storage, read> inputs: array<vec4<f32>>;
@group(0) @binding(21) var<storage, read_write> outputs: array<vec4<f32>>;

@compute @workgroup_size(WORKGROUP_SIZE)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = inputs[id.x];
    let a = warp_cosine_hemisphere(i.xy);
    let b = warp_uniform_hemisphere(i.xy);
    let c = ggx_sample(i.z, normalize(vec3<f32>(0.3, -0.4, 0.5)), i.xy);
    outputs[id.x] = vec4<f32>(dot(a, a), dot(b, b), dot(c, c), 1.0);
}
