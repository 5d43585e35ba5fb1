// One ray a thread, nothing else.
#import geometry/trace

struct Input {
    origin: vec3<f32>,
    t_max: f32,
    direction: vec3<f32>,
    padding: u32,
}

@group(0) @binding(20) var<storage, read> inputs: array<Input>;
@group(0) @binding(21) var<storage, read_write> outputs: array<f32>;

@compute @workgroup_size(WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
#if PACKETS
    @builtin(subgroup_invocation_id) lane: u32,
#endif
) {
#if PACKETS
    packet_lane = lane;
#endif
    stack_lane = local;
    let i = inputs[id.x];
    var ray = ray_new(i.origin, i.direction);
    ray.t_max = i.t_max;
    outputs[id.x] = TRACED;
}
