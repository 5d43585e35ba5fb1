// Weights of two densities: the product's, and by squares as the formula is printed.
#import strategy/mis

@group(0) @binding(20) var<storage, read> inputs: array<vec2<f32>>;
// Weight of a light sample, weight of emission that was met, and the former by squares.
@group(0) @binding(21) var<storage, read_write> outputs: array<vec4<f32>>;

fn by_squares(a: f32, b: f32) -> f32 {
    return a * a / (a * a + b * b);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let light_pdf = inputs[id.x].x;
    let scatter_pdf = inputs[id.x].y;
    let light = strategy_light_weight(light_pdf, scatter_pdf);
    let emission = strategy_emission_weight(scatter_pdf, light_pdf);
    outputs[id.x] = vec4<f32>(light, emission, by_squares(light_pdf, scatter_pdf), 0.0);
}
