// The point where a ray meets the scene, and whether a ray that leaves it is blocked.
#import geometry/trace
#import geometry/surface
#import film/fault

struct Input {
    origin: vec3<f32>,
    direction: vec3<f32>,
    // Of the ray that leaves.
    leaving: vec3<f32>,
}

struct Output {
    position: vec3<f32>,
    source: u32,
    t: f32,
    is_blocked: u32,
    faults: u32,
}

@group(0) @binding(20) var<storage, read> inputs: array<Input>;
@group(0) @binding(21) var<storage, read_write> outputs: array<Output>;

@compute @workgroup_size(WORKGROUP_SIZE)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    stack_lane = local;
    let i = inputs[id.x];
    let ray = ray_new(i.origin, i.direction);
    let hit = trace_closest(ray, true);
    var out = Output(vec3<f32>(0.0), INVALID, hit.t, 0u, 0u);
    if hit.primitive != INVALID {
        let s = surface_at(ray, hit);
        out.position = s.position;
        out.source = primitive_source(primitive_load(hit.primitive));
        let origin = ray_spawn(s.position, s.ng, s.offset, i.leaving);
        out.is_blocked = select(0u, 1u, trace_any(ray_new(origin, i.leaving), true));
    }
    out.faults = fault_bits;
    outputs[id.x] = out;
}
