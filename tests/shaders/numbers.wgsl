// Random numbers, warps and small functions of one input.
#import sample/warp
#import sample/sobol

struct Input {
    bits: vec4<u32>,
    // A unit vector, and nothing.
    normal: vec4<f32>,
}

@group(0) @binding(0) var<storage, read> inputs: array<Input>;
@group(0) @binding(1) var<storage, read_write> outputs: array<vec4<u32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let bits = inputs[id.x].bits;
    let normal = inputs[id.x].normal;
    let u = uniform_from_bits(bits);
    let at = 13u * id.x;
    outputs[at] = pcg4d(bits);
    outputs[at + 1u] = bitcast<vec4<u32>>(u);
    outputs[at + 2u] = bitcast<vec4<u32>>(vec4<f32>(warp_disk(u.xy), warp_triangle(u.xy)));
    outputs[at + 3u] = bitcast<vec4<u32>>(vec4<f32>(warp_cosine_hemisphere(u.xy), 0.0));
    outputs[at + 4u] = bitcast<vec4<u32>>(vec4<f32>(warp_uniform_hemisphere(u.xy), 0.0));
    outputs[at + 5u] = bitcast<vec4<u32>>(vec4<f32>(warp_sphere(u.xy), 0.0));
    let frame_n = frame_from_normal(normal.xyz);
    outputs[at + 6u] = bitcast<vec4<u32>>(vec4<f32>(frame_n[0], atan2_accurate(normal.y, normal.x)));
    outputs[at + 7u] = bitcast<vec4<u32>>(vec4<f32>(frame_n[1], 0.0));
    outputs[at + 8u] = bitcast<vec4<u32>>(vec4<f32>(frame_n[2], 0.0));
    outputs[at + 9u] = bitcast<vec4<u32>>(sobol_first(bits.x, bits));
    outputs[at + 10u] = bitcast<vec4<u32>>(sobol_last(bits.x, bits));
    outputs[at + 11u] = bitcast<vec4<u32>>(vec4<f32>(sobol_pair(bits.x, bits.zw), 0.0, 0.0));
    outputs[at + 12u] = vec4<u32>(owen_hash(bits.x, bits.y), sobol_shuffle(bits.x, bits.y), 0u, 0u);
}
