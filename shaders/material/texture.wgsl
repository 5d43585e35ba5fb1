// Images of any size in one buffer, filtered here.
#import math/math

// First the descriptors, three vec4 each: (first texel, width, height, TEXTURE_
// flags) and the two rows of the transform of texture coordinates; then RGBA8
// texels, four to a vec4. The fourth component of the first row holds the shift
// that finds a texel's buffer.
@group(0) @binding(7) var<storage, read> textures: array<vec4<u32>>;

#if SPLIT_TEXTURES
// What follows where one binding cannot hold all: 1 << shift words in each.
@group(0) @binding(9) var<storage, read> textures_1: array<vec4<u32>>;
@group(0) @binding(10) var<storage, read> textures_2: array<vec4<u32>>;
@group(0) @binding(11) var<storage, read> textures_3: array<vec4<u32>>;
#endif

fn texture_texel(first: u32, index: u32, shift: u32) -> vec4<f32> {
    let at = first + index;
    let k = at & 3u;
#if SPLIT_TEXTURES
    // Every buffer is read, which costs less than branches; what lies beyond its end is dropped.
    let part = at >> (shift + 2u);
    let word = (at >> 2u) & ((1u << shift) - 1u);
    let low = select(textures[word][k], textures_1[word][k], part == 1u);
    let high = select(textures_2[word][k], textures_3[word][k], part == 3u);
    return unpack4x8unorm(select(low, high, part >= 2u));
#else
    return unpack4x8unorm(textures[at >> 2u][k]);
#endif
}

// IEC 61966-2-1.
fn texture_from_srgb(c: vec3<f32>) -> vec3<f32> {
    let curve = pow((c + 0.055) / 1.055, vec3<f32>(2.4));
    return select(curve, c / 12.92, c <= vec3<f32>(0.04045));
}

// Texel coordinate brought into [0, size).
fn texture_wrap(i: i32, size: i32, mode: u32) -> i32 {
    if mode == TEXTURE_WRAP_CLAMP {
        return clamp(i, 0, size - 1);
    }
    let period = select(size, 2 * size, mode == TEXTURE_WRAP_MIRROR);
    let remainder = i % period;
    let m = select(remainder, remainder + period, remainder < 0);
    return select(m, period - 1 - m, m >= size);
}

// The texture's value in linear units, or 1 without one. `uv` holds both sets.
fn texture_or_white(texture: u32, uv: vec4<f32>) -> vec4<f32> {
    if texture == INVALID {
        return vec4<f32>(1.0);
    }
    let head = textures[3u * texture];
    let x_row = bitcast<vec4<f32>>(textures[3u * texture + 1u]);
    let y_row = bitcast<vec4<f32>>(textures[3u * texture + 2u]);
    let flags = head.w;
    let shift = bitcast<u32>(x_row.w);
    let chosen = select(uv.xy, uv.zw, (flags & TEXTURE_UV_SET) != 0u);
    let size = vec2<i32>(head.yz);
    let at = vec2<f32>(dot(x_row.xyz, vec3<f32>(chosen, 1.0)), dot(y_row.xyz, vec3<f32>(chosen, 1.0)));
    let is_nearest = (flags & TEXTURE_NEAREST) != 0u;
    let position = at * vec2<f32>(size) - select(0.5, 0.0, is_nearest);
    let corner = floor(position);
    let weight = select(position - corner, vec2<f32>(0.0), is_nearest);
    let i = vec2<i32>(corner);
    let mode = vec2<u32>(flags >> TEXTURE_WRAP_U_SHIFT, flags >> TEXTURE_WRAP_V_SHIFT) & vec2<u32>(3u);
    // A loop, so that drivers which inline everything compile this once a lookup, not four times.
    var t: array<vec4<f32>, 4>;
    let count = select(4u, 1u, is_nearest);
    for (var k = 0u; k < count; k++) {
        let x = u32(texture_wrap(i.x + i32(k & 1u), size.x, mode.x));
        let y = u32(texture_wrap(i.y + i32(k >> 1u), size.y, mode.y));
        let texel = texture_texel(head.x, y * head.y + x, shift);
        let linear = texture_from_srgb(texel.rgb);
        t[k] = vec4<f32>(select(texel.rgb, linear, (flags & TEXTURE_SRGB) != 0u), texel.a);
    }
    return mix(mix(t[0], t[1], weight.x), mix(t[2], t[3], weight.x), weight.y);
}
