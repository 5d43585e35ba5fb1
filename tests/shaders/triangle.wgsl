// One ray against one triangle.
#import geometry/leaf

struct Input {
    origin: vec4<f32>,
    direction: vec4<f32>,
    a: vec4<u32>,
    b: vec4<u32>,
    c: vec4<u32>,
}

@group(0) @binding(20) var<storage, read> inputs: array<Input>;
@group(0) @binding(21) var<storage, read_write> outputs: array<vec4<f32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = inputs[id.x];
    let o = i.origin.xyz;
    let d = i.direction.xyz;
    let slab = slab_new(o, d, vec3<f32>(0.0), vec3<f32>(0.0));
    let hit = leaf_triangle_hit(TreeRay(o, d, slab, shear_new(d), INVALID), Primitive(i.a, i.b, i.c));
    outputs[id.x] = vec4<f32>(hit.t, hit.u, hit.v, 0.0);
}
