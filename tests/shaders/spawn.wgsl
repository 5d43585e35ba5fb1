// A ray against a scene or a few of its primitives, the surface that it meets, and a ray
// that leaves that against the same. Primitives are numbered in scene order (brute force).
#import geometry/surface
#import geometry/trace

struct Input {
    origin: vec3<f32>,
    t_max: f32,
    direction: vec3<f32>,
    first: u32,
    // Direction of the ray that leaves, in the frame with z = the geometric normal on wo's side.
    scattered: vec3<f32>,
    // 0 is the whole scene.
    count: u32,
}

struct Output {
    position: vec3<f32>,
    // T_INFINITY for a miss: then all else is 0.
    t: f32,
    ng: vec3<f32>,
    offset: f32,
    // The ray that leaves, and where it meets something again: T_INFINITY if it does not.
    origin: vec3<f32>,
    again: f32,
    direction: vec3<f32>,
    is_front: u32,
}

@group(0) @binding(20) var<storage, read> inputs: array<Input>;
@group(0) @binding(21) var<storage, read_write> outputs: array<Output>;

fn spawn_trace(ray: Ray, first: u32, count: u32) -> Hit {
    if count == 0u {
        return trace_closest(ray, true);
    }
    let tree = tree_ray_world(ray);
    var best = hit_none(ray);
    for (var i = first; i < first + count; i++) {
        let kind = select(LINK_KIND_SPHERE, LINK_KIND_TRIANGLE, i < frame.triangle_count);
        leaf_closest(ray, tree, kind, primitive_load(i), i, &best);
    }
    return best;
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) local: u32) {
#if !BRUTE_FORCE
    stack_lane = local;
#endif
    let i = inputs[id.x];
    let ray = Ray(i.origin, i.t_max, i.direction, 0u);
    let hit = spawn_trace(ray, i.first, i.count);
    if hit.primitive == INVALID {
        outputs[id.x].t = T_INFINITY;
        return;
    }
    let s = surface_at(ray, hit);
    let wi = frame_from_normal(s.ng) * i.scattered;
    let leaving = ray_new(ray_spawn(s.position, s.ng, s.offset, wi), wi);
    let again = spawn_trace(leaving, i.first, i.count);
    let t = select(T_INFINITY, again.t, again.primitive != INVALID);
    let is_front = select(0u, 1u, s.is_front);
    outputs[id.x] = Output(s.position, hit.t, s.ng, s.offset, leaving.origin, t, wi, is_front);
}
