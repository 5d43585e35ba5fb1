// One sample of a BSDF, and its value and density for another pair of directions.
#import bsdf/scatter

struct Input {
    // Unit, z > 0; and alpha.
    wo: vec4<f32>,
    // Another unit vector; and eta.
    wi: vec4<f32>,
    // Albedo of the Lambert lobe; and diffuse_f0.
    diffuse: vec4<f32>,
    // specular_f0, specular_f90.
    specular: vec4<f32>,
    // Share that passes; and diffuse_f90.
    transmitted: vec4<f32>,
    u: vec4<f32>,
}

struct Output {
    // The sampled direction, and its density; 0 is no sample.
    sampled: vec4<f32>,
    // Its weight, and eta_scale.
    weight: vec4<f32>,
    // Value for wi, and density.
    other: vec4<f32>,
}

@group(0) @binding(20) var<storage, read> inputs: array<Input>;
@group(0) @binding(21) var<storage, read_write> outputs: array<Output>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = inputs[id.x];
    var b: Bsdf;
    b.diffuse = i.diffuse.xyz;
    b.diffuse_f0 = i.diffuse.w;
    b.specular_f0 = i.specular.xyz;
    b.specular_f90 = i.specular.w;
    b.transmitted = i.transmitted.xyz;
    b.diffuse_f90 = i.transmitted.w;
    b.alpha = i.wo.w;
    b.eta = i.wi.w;
#if SPLIT_FRESNEL
    // Clear glass without KHR_materials_specular.
    b.is_interface = bsdf_transmits(b);
    b.is_split = b.is_interface;
    b.diffuse_f90 = select(b.diffuse_f90, 1.0, b.is_interface);
#endif
    let wo = i.wo.xyz;
    let wi = i.wi.xyz;
    let s = bsdf_sample(b, wo, i.u.xy, i.u.z);
    let other = vec4<f32>(bsdf_eval(b, wo, wi), bsdf_pdf(b, wo, wi));
    outputs[id.x] = Output(vec4<f32>(s.wi, s.pdf), vec4<f32>(s.weight, s.eta_scale), other);
}
