// One ray against one box on a grid.
#import geometry/slab

struct Input {
    origin: vec4<f32>,
    // Direction, and the greatest distance.
    direction: vec4<f32>,
    grid_min: vec4<f32>,
    grid_scale: vec4<f32>,
    child: vec4<u32>,
}

@group(0) @binding(20) var<storage, read> inputs: array<Input>;
@group(0) @binding(21) var<storage, read_write> outputs: array<vec2<i32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = inputs[id.x];
    let slab = slab_new(i.origin.xyz, i.direction.xyz, i.grid_min.xyz, i.grid_scale.xyz);
    outputs[id.x] = slab_hit(slab, i.child, i.direction.w);
}
