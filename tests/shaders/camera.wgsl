// The camera's ray for a film position and a lens sample.
#import camera/camera

// Film position; the pair for the lens.
@group(0) @binding(20) var<storage, read> inputs: array<vec4<f32>>;
@group(0) @binding(21) var<storage, read_write> outputs: array<array<vec4<f32>, 2>>;

@compute @workgroup_size(WORKGROUP_SIZE)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = inputs[id.x];
    let ray = camera_ray(i.xy, i.zw);
    outputs[id.x] = array<vec4<f32>, 2>(vec4<f32>(ray.origin, 0.0), vec4<f32>(ray.direction, 0.0));
}
