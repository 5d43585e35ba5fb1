// Blocks of given samples, added as the path tracer adds its own.
#import film/film

const SAMPLES: u32 = 16u;

@group(0) @binding(20) var<storage, read> inputs: array<array<f32, SAMPLES>>;
// Bits of the first sample and of the sum of differences to it, the number of samples, the counts of faults.
@group(0) @binding(21) var<storage, read_write> outputs: array<vec4<u32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    var p: FilmPixel;
    p.fault_sample = INVALID;
    for (var i = 0u; i < SAMPLES; i++) {
        p = film_add(p, vec3<f32>(inputs[id.x][i]), i);
    }
    outputs[id.x] = vec4<u32>(bitcast<vec2<u32>>(vec2<f32>(p.first.y, p.difference.y)), p.sample_count, p.fault_counts);
}
