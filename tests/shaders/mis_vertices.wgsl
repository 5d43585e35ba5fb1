// At a random vertex of a path a light is sampled, and met again by a ray in the same
// direction: what light samples and scattered rays weigh there.
#import camera/camera
#import geometry/trace
#import geometry/surface
#import material/material
#import bsdf/scatter
#import strategy/mis
#import light/light
#import sample/pcg

// Paths that a thread tries.
const TRIALS: u32 = 16u;

// Bounces before the vertex.
@group(0) @binding(20) var<storage, read> inputs: array<u32>;
// Of the first path that meets the light which it samples: weight of the light sample, weight of
// the emission met, their densities. Else of the last: -1 no light was sampled, -2 it was
// hidden, -3 the ray just missed it.
@group(0) @binding(21) var<storage, read_write> outputs: array<vec4<f32>>;

fn random(thread: u32, number: u32) -> vec4<f32> {
    return uniform_from_bits(pcg4d(vec4<u32>(thread, number, 17u, 4u)));
}

// Density with which light samples at `from_point` find what the ray from there met; -2, -3 as above.
fn met_pdf(from_point: vec3<f32>, ray: Ray, l: LightSample) -> f32 {
    let hit = trace_closest(ray, true);
    if hit.primitive == INVALID {
#if ENVIRONMENT
        if l.is_infinite {
            return environment_pdf(ray.direction);
        }
#endif
        return -3.0;
    }
    if l.is_infinite {
        return -2.0;
    }
    let s = surface_at(ray, hit);
    let d = distance(l.target_point, ray.origin);
    if distance(s.position, l.target_point) > 1e-4 * d {
        return select(-3.0, -2.0, distance(s.position, ray.origin) < d);
    }
    return select(-3.0, light_surface_pdf(s, from_point, ray.direction), s.light != INVALID);
}

fn weights(s: Surface, thread: u32) -> vec4<f32> {
    let m = materials[s.material];
    let b = material_bsdf(m, s, frame_from_normal(s.ns), material_eta(m, s, INVALID, 1.0));
    let u = random(thread, 100u);
    let l = light_sample(s, u.xy, u.z);
    if !bsdf_is_smooth(b) || max_component(l.weight) <= 0.0 || dot(l.wi, s.ng) <= 0.0 {
        return vec4<f32>(-1.0);
    }
    let frame_s = frame_from_normal(s.ns);
    let scatter_pdf = bsdf_pdf(b, s.wo * frame_s, l.wi * frame_s);
    let ray = ray_new(ray_spawn(s.position, s.ng, s.offset, l.wi), l.wi);
    let met = met_pdf(s.position, ray, l);
    if met < 0.0 || scatter_pdf <= 0.0 {
        return vec4<f32>(min(met, -1.0));
    }
    let light = strategy_light_weight(l.pdf, scatter_pdf);
    return vec4<f32>(light, strategy_emission_weight(scatter_pdf, met), l.pdf, met);
}

// A path of that many bounces, and what its last vertex gives.
fn path_weights(bounces: u32, path: u32) -> vec4<f32> {
    var ray = camera_ray(2.0 * random(path, 0u).xy - 1.0, vec2<f32>(0.5));
    for (var bounce = 0u; bounce <= bounces; bounce++) {
        let hit = trace_closest(ray, true);
        if hit.primitive == INVALID {
            break;
        }
        let s = surface_at(ray, hit);
        if bounce == bounces {
            return weights(s, path);
        }
        let frame_s = frame_from_normal(s.ns);
        let m = materials[s.material];
        let b = material_bsdf(m, s, frame_s, material_eta(m, s, INVALID, 1.0));
        let scattered = bsdf_sample(b, s.wo * frame_s, random(path, 1u + bounce).xy, 0.5);
        let wi = frame_s * scattered.wi;
        if scattered.pdf == 0.0 || dot(wi, s.ng) <= 0.0 {
            break;
        }
        ray = ray_new(ray_spawn(s.position, s.ng, s.offset, wi), wi);
    }
    return vec4<f32>(-1.0);
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    stack_lane = local;
    var result = vec4<f32>(-1.0);
    for (var i = 0u; i < TRIALS && result.x < 0.0; i++) {
        result = path_weights(inputs[id.x], id.x * TRIALS + i);
    }
    outputs[id.x] = result;
}
