// Rays as they are, however broken, through the tree that the settings ask for.
#import geometry/trace

@group(0) @binding(20) var<storage, read> inputs: array<array<vec4<f32>, 2>>;
// The primitive, whether anything is hit, the bits of the faults; INVALID is a miss.
@group(0) @binding(21) var<storage, read_write> outputs: array<vec4<u32>>;

@compute @workgroup_size(WORKGROUP_SIZE)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) local: u32) {
#if !BRUTE_FORCE
    stack_lane = local;
#endif
    let ray = ray_new(inputs[id.x][0].xyz, inputs[id.x][1].xyz);
    let hit = trace_closest(ray, true);
    let is_blocked = trace_any(ray, true);
    outputs[id.x] = vec4<u32>(hit.primitive, u32(is_blocked), fault_bits, bitcast<u32>(hit.t));
}
