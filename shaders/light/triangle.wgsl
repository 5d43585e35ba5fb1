// Emissive triangles, sampled uniformly over their area.
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

// pdf = pmf d² / (A cos): products before the quotient, so that a tiny light does not overflow.
// `facing` is 2 A cos.
fn light_triangle_density(l: Light, d: f32, facing: f32) -> f32 {
    let projected = 0.5 * abs(facing);
    // At no distance the quotient above is none.
    return select(l.pmf * d * d / projected, 0.0, d <= 0.0 || projected <= 0.0);
}

// For the weights of strategies, by receiver and direction alone: they add up to one because
// whoever finds the direction finds the same bits.
fn light_triangle_pdf(l: Light, from_point: vec3<f32>, wi: vec3<f32>) -> f32 {
    let n2 = light_triangle_normal(l);
    let facing = dot(n2, normalize(wi));
    return light_triangle_density(l, dot(n2, l.a - from_point) / facing, facing);
}

fn light_triangle_sample(l: Light, s: Surface, u: vec2<f32>) -> LightSample {
    let w = warp_triangle(u);
    let n2 = light_triangle_normal(l);
    let point = (1.0 - w.x - w.y) * l.a + w.x * l.b + w.y * l.c;
    let toward = point - s.position;
    let wi = surface_unit(toward);
    let facing = -dot(n2, toward);
    let emits = facing > 0.0 || (facing < 0.0 && l.is_double_sided != 0u);
    let d = length(toward);
    let density = light_triangle_density(l, d, facing / d);
    let pdf = light_triangle_pdf(l, s.position, wi);
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
