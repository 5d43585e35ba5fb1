// Alpha MASK and BLEND as a test on candidate hits: a surface that is not there
// neither stops a ray nor counts as a bounce.
#import geometry/primitive
#import geometry/attributes
#import material/material
#import sample/pcg
#if TEXTURES
#import material/texture
#endif

// Probability that triangle `source` of this material is present at a point; `weights` are
// those of its second and third corner.
fn alpha_presence(m: Material, source: u32, weights: vec2<f32>) -> f32 {
    var alpha = m.alpha;
#if VERTEX_DATA
    let corners = corners_load(source);
    if (corners.flags & ATTRIBUTE_COLOR) != 0u {
        alpha *= attribute_at(corners, 2u, weights).a;
    }
#if TEXTURES
    if (corners.flags & ATTRIBUTE_UV) != 0u {
        alpha *= texture_or_white(m.base_color_texture, attribute_at(corners, 1u, weights)).a;
    }
#endif
#endif
    return select(alpha, f32(alpha >= m.alpha_cutoff), m.alpha_cutoff >= 0.0);
}

// BLEND is decided by a hash of the ray and the primitive, so that every copy of
// the test comes to the same answer.
fn alpha_accepts(ray: Ray, p: Primitive, hit: Hit) -> bool {
    if (p.a.w & PRIMITIVE_HAS_ALPHA) == 0u {
        return true;
    }
    let m = materials[primitive_material(p)];
    let presence = alpha_presence(m, primitive_source(p), vec2<f32>(hit.u, hit.v));
    if m.alpha_cutoff >= 0.0 {
        return presence > 0.0;
    }
    let key = vec4<u32>(ray.alpha_seed, primitive_source(p), hit.instance, 0u);
    return uniform_from_bits(pcg4d(key)).x < presence;
}
