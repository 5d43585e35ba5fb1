// One ray against one sphere, by its centre and by an anchor on it.
#import geometry/sphere

struct Input {
    origin: vec4<f32>,
    direction: vec4<f32>,
    // Centre and radius.
    sphere: vec4<f32>,
    anchor: vec4<f32>,
    // Outward normal at the anchor, and the curvature.
    normal: vec4<f32>,
}

@group(0) @binding(20) var<storage, read> inputs: array<Input>;
@group(0) @binding(21) var<storage, read_write> outputs: array<vec2<f32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = inputs[id.x];
    let o = i.origin.xyz;
    let d = i.direction.xyz;
    outputs[id.x] = vec2<f32>(
        sphere_hit(o, d, i.sphere.xyz, i.sphere.w),
        sphere_hit_anchored(o, d, i.anchor.xyz, i.normal.xyz, i.normal.w),
    );
}
