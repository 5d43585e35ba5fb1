// A ray that is refracted by every surface it meets.
#import geometry/surface
#import geometry/trace
#import bsdf/dielectric

struct Output {
    // The last interface, and the direction after it.
    position: vec3<f32>,
    count: u32,
    direction: vec3<f32>,
    is_reflected: u32,
}

// Origin and direction.
@group(0) @binding(20) var<storage, read> inputs: array<array<vec4<f32>, 2>>;
@group(0) @binding(21) var<storage, read_write> outputs: array<Output>;

const INDEX: f32 = 1.5;
const MOST_INTERFACES: u32 = 1024u;

@compute @workgroup_size(WORKGROUP_SIZE)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) local: u32) {
#if !BRUTE_FORCE
    stack_lane = local;
#endif
    let i = inputs[id.x];
    var ray = ray_new(i[0].xyz, i[1].xyz);
    var result = Output(ray.origin, 0u, ray.direction, 0u);
    while result.count < MOST_INTERFACES {
        let hit = trace_closest(ray, true);
        if hit.primitive == INVALID {
            break;
        }
        let s = surface_at(ray, hit);
        let frame_s = frame_from_normal(s.ng);
        let wo = s.wo * frame_s;
        let eta = select(INDEX, 1.0 / INDEX, s.is_front);
        let f = fresnel_dielectric(wo.z, eta);
        if f.reflectance >= 1.0 {
            result.is_reflected = 1u;
            break;
        }
        let wi = frame_s * dielectric_refract(wo, eta, f.cos_t);
        ray = ray_new(ray_spawn(s.position, s.ng, s.offset, wi), wi);
        result = Output(s.position, result.count + 1u, wi, 0u);
    }
    outputs[id.x] = result;
}
