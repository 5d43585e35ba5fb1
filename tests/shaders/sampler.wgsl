// What a path draws, four numbers at a time.
#if SOBOL
#import sample/sampler_sobol
#else
#import sample/sampler_independent
#endif

struct Input {
    pixel: u32,
    sample_index: u32,
    // 0 film and lens; 1 to 10 a vertex; 11 to 15 the choices of two vertices; from 16 on the
    // second light sample of a vertex.
    slot: u32,
}

@group(0) @binding(20) var<storage, read> inputs: array<Input>;
@group(0) @binding(21) var<storage, read_write> outputs: array<vec4<f32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let s = Sampler(inputs[id.x].pixel, inputs[id.x].sample_index);
    let slot = inputs[id.x].slot;
    var numbers: vec4<f32>;
    if slot == 0u {
        numbers = vec4<f32>(sampler_pair(s, GROUP_PIXEL), sampler_pair(s, GROUP_LENS));
    } else if slot <= 10u {
        numbers = sampler_vertex(s, slot - 1u);
    } else if slot <= 15u {
        let bounce = 2u * (slot - 11u);
        numbers = vec4<f32>(sampler_choice(s, bounce, 0u).xy, sampler_choice(s, bounce + 1u, 0u).xy);
    } else {
        numbers = vec4<f32>(sampler_light(s, slot - 16u, 1u), sampler_light(s, slot - 16u, 2u));
    }
    outputs[id.x] = numbers;
}
