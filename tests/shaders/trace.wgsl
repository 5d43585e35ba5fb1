// Closest and any hit of each ray in a scene.
#import geometry/trace
#import film/fault

struct Input {
    origin: vec3<f32>,
    t_max: f32,
    direction: vec3<f32>,
    any_t_max: f32,
}

struct Output {
    t: f32,
    u: f32,
    v: f32,
    source: u32,
    is_blocked: u32,
    faults: u32,
}

@group(0) @binding(20) var<storage, read> inputs: array<Input>;
@group(0) @binding(21) var<storage, read_write> outputs: array<Output>;

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
#if !BRUTE_FORCE
    stack_lane = local;
#endif
    let i = inputs[id.x];
    var ray = ray_new(i.origin, i.direction);
    ray.t_max = i.t_max;
    let hit = trace_closest(ray, true);
    ray.t_max = i.any_t_max;
    let is_blocked = trace_any(ray, true);
    var source = INVALID;
    if hit.primitive != INVALID {
        source = primitive_source(primitive_load(hit.primitive));
    }
    outputs[id.x] = Output(hit.t, hit.u, hit.v, source, select(0u, 1u, is_blocked), fault_bits);
}
