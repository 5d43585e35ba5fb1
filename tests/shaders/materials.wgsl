// One sample of a material's BSDF, and its value and density for another pair of directions.
#import material/material
#import bsdf/scatter

struct Input {
    // Unit, in the BSDF's frame, z > 0; and the material's index.
    wo: vec4<f32>,
    // Another unit vector; and 1 on the front, 0 on the back.
    wi: vec4<f32>,
    // u and choice; and the index around the material.
    u: vec4<f32>,
    // The vertices' normal.
    normal: vec4<f32>,
}

struct Output {
    // The sampled direction, and its density; 0 is no sample.
    sampled: vec4<f32>,
    // Its weight, and eta_scale.
    weight: vec4<f32>,
    // Value for wi, and density.
    other: vec4<f32>,
    // What is left of the choice; bits: has a density, reaches below; eta.
    rest: vec4<f32>,
}

@group(0) @binding(20) var<storage, read> inputs: array<Input>;
@group(0) @binding(21) var<storage, read_write> outputs: array<Output>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = inputs[id.x];
    let m = materials[u32(i.wo.w)];
    var s: Surface;
    s.ng = vec3<f32>(0.0, 0.0, 1.0);
    s.ns = s.ng;
    s.tangent = vec4<f32>(1.0, 0.0, 0.0, 1.0);
    s.color = vec4<f32>(1.0);
    s.is_front = i.wi.w > 0.0;
    let frame_s = material_frame(m, s);
    s.wo = frame_s * i.wo.xyz;
#if CLEARCOAT
    s.nv = frame_s * i.normal.xyz;
#endif
    let eta = material_eta(m, s, INVALID, i.u.w);
    let b = material_bsdf(m, s, frame_s, eta);
    let sampled = bsdf_sample(b, i.wo.xyz, i.u.xy, i.u.z);
    let other = vec4<f32>(bsdf_eval(b, i.wo.xyz, i.wi.xyz), bsdf_pdf(b, i.wo.xyz, i.wi.xyz));
    let bits = select(0.0, 1.0, bsdf_is_smooth(b)) + select(0.0, 2.0, bsdf_reaches_below(b));
    outputs[id.x] = Output(
        vec4<f32>(sampled.wi, sampled.pdf),
        vec4<f32>(sampled.weight, sampled.eta_scale),
        other,
        vec4<f32>(sampled.choice, bits, eta, 0.0),
    );
}
