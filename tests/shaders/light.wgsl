// One light sample at a receiver, its shadow ray, and what a ray in its direction meets.
#import path/path
#import light/direct
#import geometry/trace
#if SOBOL
#import sample/sampler_sobol
#else
#import sample/sampler_independent
#endif

struct Input {
    position: vec4<f32>,
    // The pair that places the sample, the number that picks among many lights; and nothing.
    u: vec4<f32>,
}

struct Output {
    // Direction and density; 0 is no sample.
    sampled: vec4<f32>,
    // Weight; 1 where the shadow ray meets something.
    weight: vec4<f32>,
    // Density of the same direction as a ray that finds the light has it; 1 where it meets an
    // emitter, and its distance.
    met: vec4<f32>,
}

@group(0) @binding(20) var<storage, read> inputs: array<Input>;
@group(0) @binding(21) var<storage, read_write> outputs: array<Output>;

@compute @workgroup_size(WORKGROUP_SIZE)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    stack_lane = local;
    let i = inputs[id.x];
    var s: Surface;
    s.position = i.position.xyz;
    let l = light_sample(s, i.u.xy, i.u.z);
    let is_sample = l.pdf != 0.0;
    let is_blocked = trace_any(direct_ray(s, l, 0u), is_sample);
    var met = vec4<f32>(0.0);
    let ray = ray_new(s.position, select(vec3<f32>(0.0, 0.0, 1.0), l.wi, is_sample));
    let hit = trace_closest(ray, is_sample);
    if is_sample && hit.primitive == INVALID {
#if ENVIRONMENT
        met.x = environment_pdf(l.wi);
#endif
    } else if is_sample {
#if LIGHT_SURFACES
        let end = surface_at(ray, hit);
        met.y = select(1.0, 0.0, end.light == INVALID);
        met.z = hit.t;
        if end.light != INVALID {
            met.x = light_surface_pdf(end, s.position, ray.direction);
        }
#endif
    }
    outputs[id.x] = Output(vec4<f32>(l.wi, l.pdf), vec4<f32>(l.weight, select(0.0, 1.0, is_blocked)), met);
}
