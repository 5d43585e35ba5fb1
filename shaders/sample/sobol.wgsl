// Owen-scrambled Sobol points in eight dimensions (Burley 2020, "Practical Hash-based Owen Scrambling").
// Everything works on bit-reversed numbers, in which a nested uniform scramble is a
// hash whose bits depend on lower bits only.
#import generated
#import sample/pcg

// Laine-Karras style hash with Vegdahl's constants (2021).
fn owen_hash(reversed: u32, seed: u32) -> u32 {
    var x = reversed;
    x = x ^ (x * 0x3d20adeau);
    x = x + seed;
    x = x * ((seed >> 16u) | 1u);
    x = x ^ (x * 0x05526c56u);
    x = x ^ (x * 0x53a22864u);
    return x;
}

// Shuffles a sample index so that every aligned power-of-two run of indices stays one.
fn sobol_shuffle(index: u32, seed: u32) -> u32 {
    return reverseBits(owen_hash(reverseBits(index), seed));
}

// Scrambles four bit-reversed coordinates, each with its own seed.
fn sobol_scramble(reversed: vec4<u32>, seeds: vec4<u32>) -> vec4<f32> {
    return uniform_from_bits(reverseBits(vec4<u32>(
        owen_hash(reversed.x, seeds.x),
        owen_hash(reversed.y, seeds.y),
        owen_hash(reversed.z, seeds.z),
        owen_hash(reversed.w, seeds.w),
    )));
}

// Dimensions 0 to 3 of the point `index`.
fn sobol_first(index: u32, seeds: vec4<u32>) -> vec4<f32> {
    return sobol_scramble(vec4<u32>(index, sobol_1(index), sobol_2(index), sobol_3(index)), seeds);
}

// Dimensions 4 to 7 of the point `index`.
fn sobol_last(index: u32, seeds: vec4<u32>) -> vec4<f32> {
    let reversed = vec4<u32>(sobol_4(index), sobol_5(index), sobol_6(index), sobol_7(index));
    return sobol_scramble(reversed, seeds);
}

// Dimensions 0 and 1 alone, for padded pairs.
fn sobol_pair(index: u32, seeds: vec2<u32>) -> vec2<f32> {
    let bits = reverseBits(vec2<u32>(owen_hash(index, seeds.x), owen_hash(sobol_1(index), seeds.y)));
    return uniform_from_bits(vec4<u32>(bits, 0u, 0u)).xy;
}
