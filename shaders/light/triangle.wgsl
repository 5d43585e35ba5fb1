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
fn light_triangle_density(l: Light, n2: vec3<f32>, toward: vec3<f32>) -> f32 {
    let d2 = dot(toward, toward);
    // |n2| cos = 2 A cos.
    let projected = 0.5 * abs(dot(n2, toward)) / sqrt(d2);
    // At no distance the quotient above is none.
    return select(l.pmf * d2 / projected, 0.0, d2 <= 0.0 || projected <= 0.0);
}

fn light_triangle_sample(l: Light, s: Surface, u: vec2<f32>) -> LightSample {
    let w = warp_triangle(u);
    let n2 = light_triangle_normal(l);
    let point = (1.0 - w.x - w.y) * l.a + w.x * l.b + w.y * l.c;
    let toward = point - s.position;
    let facing = -dot(n2, toward);
    let emits = facing > 0.0 || (facing < 0.0 && l.is_double_sided != 0u);
    let pdf = light_triangle_density(l, n2, toward);
    if !emits || pdf <= 0.0 {
        return light_none();
    }
    var radiance = light_color(l);
#if TEXTURES
    radiance *= light_triangle_texture(l, w);
#endif
#if ALPHA
    // Where it is not there, or not always, it does not shine.
    radiance *= alpha_presence(materials[l.material], l.source, w);
#endif
    let extent = max(max(abs(l.a), abs(l.b)), abs(l.c));
    // Beyond the error of a hit seen from the receiver, which grows with the distance.
    let offset = spawn_offset(max(max_component(extent), length(toward))) * select(-1.0, 1.0, facing > 0.0);
    let target_point = point + offset * surface_unit(n2);
    return LightSample(surface_unit(toward), pdf, radiance / pdf, target_point, false);
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

fn light_triangle_pdf(l: Light, s: Surface, from_point: vec3<f32>) -> f32 {
    return light_triangle_density(l, light_triangle_normal(l), s.position - from_point);
}
