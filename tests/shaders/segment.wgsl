// A light sample for the surface that a ray meets, and whether anything is in its way.
#import geometry/trace
#import light/direct
#if MIS
#import strategy/mis
#endif

struct Input {
    origin: vec3<f32>,
    // The pair that places the sample on the light.
    u: f32,
    direction: vec3<f32>,
    v: f32,
}

struct Output {
    // 0: no surface, or no sample for it. 1: nothing is in the way. 2: something is.
    state: u32,
    // Radiance over density, of red, times the cosine at the receiver.
    irradiance: f32,
}

@group(0) @binding(20) var<storage, read> inputs: array<Input>;
@group(0) @binding(21) var<storage, read_write> outputs: array<Output>;

@compute @workgroup_size(WORKGROUP_SIZE)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) local: u32) {
#if !BRUTE_FORCE
    stack_lane = local;
#endif
    let i = inputs[id.x];
    let ray = ray_new(i.origin, i.direction);
    let hit = trace_closest(ray, true);
    if hit.primitive == INVALID {
        return;
    }
    let s = surface_at(ray, hit);
    let l = light_sample(s, vec2<f32>(i.u, i.v), i.u);
    let cosine = dot(l.wi, s.ng);
    if max_component(l.weight) <= 0.0 || cosine <= 0.0 {
        return;
    }
    let is_blocked = trace_any(direct_ray(s, l, 0u), true);
    outputs[id.x] = Output(select(1u, 2u, is_blocked), l.weight.x * cosine);
}
