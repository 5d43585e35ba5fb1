// Reflectance of an interface, and the refracted direction, for neighbouring incident directions.
#import bsdf/dielectric

// x and z of the incident direction, eta, and the step of z in units in its last place.
@group(0) @binding(20) var<storage, read> inputs: array<vec4<f32>>;

struct Output {
    // Of the input itself: reflectance, cos_t; the refracted direction's x and z.
    first: vec4<f32>,
    // Over STEPS neighbours: how often reflectance and refracted direction disagree, the largest
    // error of the squared length, of Snell's law, and nothing.
    all: vec4<f32>,
}

@group(0) @binding(21) var<storage, read_write> outputs: array<Output>;

const STEPS: u32 = 16u;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = inputs[id.x];
    let eta = i.z;
    var all = vec4<f32>(0.0);
    for (var k = 0u; k < STEPS; k++) {
        let z = bitcast<f32>(bitcast<u32>(i.y) + k * u32(i.w));
        let wo = vec3<f32>(sqrt(max(0.0, (1.0 - z) * (1.0 + z))), 0.0, z);
        let f = fresnel_dielectric(z, eta);
        let t = dielectric_refract(wo, eta, f.cos_t);
        let exists = f.cos_t > 0.0;
        all.x += select(0.0, 1.0, exists != (f.reflectance < 1.0));
        if f.reflectance < 1.0 {
            all.x += select(1.0, 0.0, t.z < 0.0 && is_finite(t));
            all.y = max(all.y, abs(dot(t, t) - 1.0));
            all.z = max(all.z, abs(eta * wo.x + t.x));
        }
    }
    let f = fresnel_dielectric(i.y, eta);
    let t = dielectric_refract(vec3<f32>(i.x, 0.0, i.y), eta, f.cos_t);
    outputs[id.x] = Output(vec4<f32>(f.reflectance, f.cos_t, t.x, t.z), all);
}
