// Records of primitives, 48 bytes each, in the order of the tree's leaves.
#import geometry/ray

// Triangle: three vertices. Sphere: centre, or the anchor; (radius, is anchored, -);
// the anchor's normal. The fourth words are alike: material, with PRIMITIVE_HAS_ALPHA and
// PRIMITIVE_IS_CULLED; light or INVALID; the index in scene order.
#if SPLIT_PRIMITIVES
// One number of each word: where one binding cannot hold all.
@group(0) @binding(3) var<storage, read> primitives: array<u32>;
@group(0) @binding(30) var<storage, read> primitives_1: array<u32>;
@group(0) @binding(31) var<storage, read> primitives_2: array<u32>;
@group(0) @binding(32) var<storage, read> primitives_3: array<u32>;
#else
@group(0) @binding(3) var<storage, read> primitives: array<vec2<u32>>;
#endif

struct Primitive {
    a: vec4<u32>,
    b: vec4<u32>,
    c: vec4<u32>,
}

fn primitive_word(i: u32) -> vec4<u32> {
#if SPLIT_PRIMITIVES
    return vec4<u32>(primitives[i], primitives_1[i], primitives_2[i], primitives_3[i]);
#else
    return vec4<u32>(primitives[2u * i], primitives[2u * i + 1u]);
#endif
}

fn primitive_load(index: u32) -> Primitive {
    let i = 3u * index;
    return Primitive(primitive_word(i), primitive_word(i + 1u), primitive_word(i + 2u));
}

#if PACKETS
// The record of the nearest hit of the last walk: a packet has loaded it for all its threads, each of
// which would load one of its own.
var<private> primitive_met: Primitive;
#endif

// The record of the hit that the last walk found.
fn primitive_of(hit: u32) -> Primitive {
#if PACKETS
    return primitive_met;
#else
    return primitive_load(hit);
#endif
}

fn primitive_material(p: Primitive) -> u32 {
    return p.a.w & ~(PRIMITIVE_HAS_ALPHA | PRIMITIVE_IS_CULLED);
}

fn primitive_light(p: Primitive) -> u32 {
    return p.b.w;
}

fn primitive_source(p: Primitive) -> u32 {
    return p.c.w;
}

// Coordinates of the words a, b or c.
fn primitive_point(word: vec4<u32>) -> vec3<f32> {
    return bitcast<vec3<f32>>(word.xyz);
}
