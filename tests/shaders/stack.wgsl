// One link put on the traversal stack at a height, and read back.
#import geometry/stack

@group(0) @binding(20) var<storage, read> inputs: array<u32>;
// Bits of the faults, the link, BVH_STACK_SIZE.
@group(0) @binding(21) var<storage, read_write> outputs: array<vec4<u32>>;

@compute @workgroup_size(WORKGROUP_SIZE)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    stack_lane = local;
    let height = inputs[id.x];
    stack_set(height, 1000u + id.x);
    outputs[id.x] = vec4<u32>(fault_bits, stack_get(height), BVH_STACK_SIZE, 0u);
}
