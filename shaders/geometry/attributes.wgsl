// Per-vertex data beyond the position, found by a primitive's index in scene order.
#import frame/frame

// First (vertex, vertex, vertex, ATTRIBUTE_ flags) for every primitive; then
// from `frame.attribute_base` on the vertices, `frame.attribute_stride` vec4 each:
// normal; uv set 0 and 1; linear colour; tangent with the bitangent's sign.
#if SPLIT_ATTRIBUTES
// One number of each word: where one binding cannot hold all.
@group(0) @binding(4) var<storage, read> attributes: array<u32>;
@group(0) @binding(33) var<storage, read> attributes_1: array<u32>;
@group(0) @binding(34) var<storage, read> attributes_2: array<u32>;
@group(0) @binding(35) var<storage, read> attributes_3: array<u32>;
#else
@group(0) @binding(4) var<storage, read> attributes: array<vec4<u32>>;
#endif

fn attribute_word(i: u32) -> vec4<u32> {
#if SPLIT_ATTRIBUTES
    return vec4<u32>(attributes[i], attributes_1[i], attributes_2[i], attributes_3[i]);
#else
    return attributes[i];
#endif
}

struct Corners {
    first: u32,
    second: u32,
    third: u32,
    flags: u32,
}

fn corners_load(source: u32) -> Corners {
    let c = attribute_word(source);
    let base = frame.attribute_base;
    let stride = frame.attribute_stride;
    return Corners(base + c.x * stride, base + c.y * stride, base + c.z * stride, c.w);
}

// Attribute number `slot` interpolated with the weights of the second and third vertex.
fn attribute_at(c: Corners, slot: u32, uv: vec2<f32>) -> vec4<f32> {
    let a = bitcast<vec4<f32>>(attribute_word(c.first + slot));
    let b = bitcast<vec4<f32>>(attribute_word(c.second + slot));
    let d = bitcast<vec4<f32>>(attribute_word(c.third + slot));
    return (1.0 - uv.x - uv.y) * a + uv.x * b + uv.y * d;
}
