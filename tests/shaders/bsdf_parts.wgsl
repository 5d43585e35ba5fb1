// What BSDFs are made of: frames, cosine-weighted directions, GGX's normals and reflections.
#import bsdf/ggx

struct Input {
    // A unit vector, and alpha.
    normal: vec4<f32>,
    u: vec4<f32>,
}

struct Output {
    // First and second column of the frame of `normal`.
    tangent: vec4<f32>,
    bitangent: vec4<f32>,
    // A direction with density cos / π; and GGX's D for `normal`.
    cosine: vec4<f32>,
    // The direction in which a microfacet reflects `normal`, above the surface or below it;
    // and its density.
    reflected: vec4<f32>,
}

@group(0) @binding(20) var<storage, read> inputs: array<Input>;
@group(0) @binding(21) var<storage, read_write> outputs: array<Output>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = inputs[id.x];
    let n = i.normal.xyz;
    let alpha = i.normal.w;
    let f = frame_from_normal(n);
    let wi = ggx_sample(alpha, n, i.u.xy);
    let pdf = ggx_pdf(alpha, n, wi, normalize(n + wi));
    let cosine = vec4<f32>(warp_cosine_hemisphere(i.u.xy), ggx_d(alpha, n));
    outputs[id.x] = Output(vec4<f32>(f[0], 0.0), vec4<f32>(f[1], 0.0), cosine, vec4<f32>(wi, pdf));
}
