// The GGX lobe for one direction and one sample, and Fresnel's factor of an interface.
#import bsdf/ggx
#import bsdf/dielectric

struct Input {
    // Unit, z > 0; and alpha.
    wo: vec4<f32>,
    // Another unit vector with z > 0; and the ratio of indices.
    wi: vec4<f32>,
    u: vec4<f32>,
}

struct Output {
    // The sampled direction, and its density.
    sampled: vec4<f32>,
    // Value over density of the sample; density and value for `wi`; nothing.
    lobe: vec4<f32>,
    // Reflectance and refracted cosine for wo.
    fresnel: vec4<f32>,
}

@group(0) @binding(20) var<storage, read> inputs: array<Input>;
@group(0) @binding(21) var<storage, read_write> outputs: array<Output>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = inputs[id.x];
    let wo = i.wo.xyz;
    let alpha = i.wo.w;
    let sampled = ggx_sample(alpha, wo, i.u.xy);
    let h = normalize(wo + sampled);
    let pdf = ggx_pdf(alpha, wo, sampled, h);
    let weight = ggx_eval(alpha, wo, sampled, h) / pdf;
    let h_i = normalize(wo + i.wi.xyz);
    let lobe = vec4<f32>(weight, ggx_pdf(alpha, wo, i.wi.xyz, h_i), ggx_eval(alpha, wo, i.wi.xyz, h_i), 0.0);
    let f = fresnel_dielectric(wo.z, i.wi.w);
    outputs[id.x] = Output(vec4<f32>(sampled, pdf), lobe, vec4<f32>(f.reflectance, f.cos_t, 0.0, 0.0));
}
