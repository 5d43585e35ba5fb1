// Emissive triangles, sampled uniformly over their area; those with a picture are divided into
// cells of one area, each a light of its own.
#import light/light
#import sample/warp
#import material/material
#import geometry/attributes
#if ALPHA
#import material/alpha
#endif

// Twice the area vector; points to the front.
fn light_triangle_normal(l: Light) -> vec3<f32> {
    return cross(l.b - l.a, l.c - l.a);
}

// Cells lie in strips parallel to the side bc, from a on: 1, 3, 5 and so on. In a strip they go
// from b to c, and every other one is turned by 180 degrees. `w` are weights of b and c.
fn light_triangle_cell(w: vec2<f32>, side: u32) -> u32 {
    let scaled = max(w, vec2<f32>(0.0)) * f32(side);
    let strip = min(u32(scaled.x + scaled.y), side - 1u);
    let j = min(u32(scaled.y), strip);
    let is_turned = u32(scaled.x) + j < strip && j < strip;
    return strip * strip + 2u * j + select(0u, 1u, is_turned);
}

// Weights in the triangle of weights in a light's cell.
fn light_triangle_within(l: Light, w: vec2<f32>) -> vec2<f32> {
    let strip = u32(sqrt(f32(l.cell)));
    let rest = l.cell - strip * strip;
    let j = rest / 2u;
    let turned = rest & 1u;
    let corner = vec2<f32>(vec2<u32>(strip - j - turned, j));
    return (corner + select(w, 1.0 - w, turned == 1u)) / f32(l.cell_side);
}

// Weights of the point that the ray from `from_point` along `wi` meets in the triangle's plane.
fn light_triangle_weights(l: Light, from_point: vec3<f32>, wi: vec3<f32>) -> vec2<f32> {
    let n2 = light_triangle_normal(l);
    let toward = l.a - from_point;
    let p = wi * (dot(n2, toward) / dot(n2, wi)) - toward;
    return vec2<f32>(dot(cross(p, l.c - l.a), n2), dot(cross(l.b - l.a, p), n2)) / dot(n2, n2);
}

// pdf = pmf d² / (A cos): products before the quotient, so that a tiny light does not overflow.
// `facing` is 2 A cos of the whole triangle, of which a cell is the part 1 / cell_side².
fn light_triangle_density(l: Light, pmf: f32, d: f32, facing: f32) -> f32 {
    let probability = pmf * f32(l.cell_side * l.cell_side);
    let projected = 0.5 * abs(facing);
    // At no distance the quotient above is none.
    return select(probability * d * d / projected, 0.0, d <= 0.0 || projected <= 0.0);
}

// For the weights of strategies, by receiver and direction alone: they add up to one because
// whoever finds the direction finds the same bits. `first` is the light of the triangle's cell 0.
fn light_triangle_pdf(l: Light, first: u32, from_point: vec3<f32>, wi: vec3<f32>) -> f32 {
    let n2 = light_triangle_normal(l);
    let facing = dot(n2, normalize(wi));
    var pmf = l.pmf;
#if TEXTURES
    if l.cell_side > 1u {
        let w = light_triangle_weights(l, from_point, wi);
        pmf = light_pmf(first + light_triangle_cell(w, l.cell_side), from_point);
    }
#endif
    return light_triangle_density(l, pmf, dot(n2, l.a - from_point) / facing, facing);
}

fn light_triangle_sample(l: Light, first: u32, s: Surface, u: vec2<f32>) -> LightSample {
    var w = warp_triangle(u);
#if TEXTURES
    w = light_triangle_within(l, w);
#endif
    let n2 = light_triangle_normal(l);
    let point = (1.0 - w.x - w.y) * l.a + w.x * l.b + w.y * l.c;
    let toward = point - s.position;
    let wi = surface_unit(toward);
    let facing = -dot(n2, toward);
    let emits = facing > 0.0 || (facing < 0.0 && l.is_double_sided != 0u);
    let d = length(toward);
    let density = light_triangle_density(l, l.pmf, d, facing / d);
    let pdf = light_triangle_pdf(l, first, s.position, wi);
    if !emits || density <= 0.0 {
        return light_none();
    }
    var radiance = light_color(l);
#if TEXTURES
    radiance *= light_triangle_texture(l, w);
#endif
#if UNLIT
    radiance *= light_triangle_color(l, w);
#endif
#if ALPHA
    // Where it is not there, or not always, it does not shine.
    radiance *= alpha_presence(materials[l.material], l.source, w);
#endif
    let extent = max(max(abs(l.a), abs(l.b)), abs(l.c));
    // Beyond the error of a hit seen from the receiver, which grows with the distance.
    let offset = spawn_offset(max(max_component(extent), d)) * select(-1.0, 1.0, facing > 0.0);
    let target_point = point + offset * surface_unit(n2);
    return LightSample(wi, pdf, radiance / density, target_point, false);
}

#if TEXTURES
fn light_triangle_texture(l: Light, weights: vec2<f32>) -> vec3<f32> {
    let texture = materials[l.material].emission_texture;
    if texture == INVALID {
        return vec3<f32>(1.0);
    }
    return texture_or_white(texture, attribute_at(corners_load(l.source), 1u, weights)).rgb;
}
#endif

#if UNLIT
// Vertex colours, which multiply the emission of unlit surfaces.
fn light_triangle_color(l: Light, weights: vec2<f32>) -> vec3<f32> {
#if VERTEX_DATA
    let corners = corners_load(l.source);
    if (materials[l.material].flags & MATERIAL_UNLIT) != 0u && (corners.flags & ATTRIBUTE_COLOR) != 0u {
        return attribute_at(corners, 2u, weights).rgb;
    }
#endif
    return vec3<f32>(1.0);
}
#endif
