// What a path draws. Every number is a function of (seed, pixel, sample index, dimension) only.
#import frame/frame
#import sample/pcg

struct Sampler {
    // Column and row in the whole picture, 16 bits each.
    pixel: u32,
    sample_index: u32,
}

// Groups of dimensions that are scrambled together; the path's vertices follow.
const GROUP_PIXEL: u32 = 0u;
const GROUP_LENS: u32 = 1u;
const GROUP_CHOICE: u32 = 2u;
const GROUP_VERTEX: u32 = 3u;
const GROUP_LIGHT: u32 = 4u;
const GROUP_ALPHA: u32 = 5u;

// Seeds of a group's shuffle and scrambles at `bounce`: the same for all samples of a pixel.
fn sampler_seeds(s: Sampler, group: u32, bounce: u32) -> vec4<u32> {
    return pcg4d(vec4<u32>(s.pixel, frame.seed, group, bounce));
}

// Where on a path numbers are drawn: the bounce, 12 bits, and the number of the light sample.
fn sampler_place(bounce: u32, light_sample: u32) -> u32 {
    return bounce | (light_sample << 12u);
}

// Four independent numbers of this sample.
fn sampler_hash(s: Sampler, group: u32, place: u32) -> vec4<u32> {
    return pcg4d(vec4<u32>(s.pixel, frame.seed, group | (place << 4u), s.sample_index ^ 0x9e3779b9u));
}

// Choices at a vertex: x roulette, y which light, when there are many.
fn sampler_choice(s: Sampler, bounce: u32, light_sample: u32) -> vec4<f32> {
    return uniform_from_bits(sampler_hash(s, GROUP_CHOICE, sampler_place(bounce, light_sample)));
}

// Seed of the path segment's alpha tests.
fn sampler_alpha_seed(s: Sampler, bounce: u32) -> u32 {
    return sampler_hash(s, GROUP_ALPHA, bounce).x;
}
