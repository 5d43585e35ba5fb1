// The density of light samples for a direction, and the radiance that arrives from it.
#import path/path
#import geometry/trace

struct Input {
    position: vec4<f32>,
    direction: vec4<f32>,
}

@group(0) @binding(20) var<storage, read> inputs: array<Input>;
// Radiance and density.
@group(0) @binding(21) var<storage, read_write> outputs: array<vec4<f32>>;

@compute @workgroup_size(WORKGROUP_SIZE)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    stack_lane = local;
    let i = inputs[id.x];
    let ray = ray_new(i.position.xyz, i.direction.xyz);
    let hit = trace_closest(ray, true);
    var out = vec4<f32>(0.0);
    if hit.primitive == INVALID {
#if ENVIRONMENT
        out = vec4<f32>(environment_emitted(ray.direction), environment_pdf(ray.direction));
#endif
    } else {
#if LIGHT_SURFACES
        let s = surface_at(ray, hit);
        if s.light != INVALID {
            out = vec4<f32>(material_emitted(materials[s.material], s), light_surface_pdf(s, ray.origin, ray.direction));
        }
#endif
    }
    outputs[id.x] = out;
}
