// Alpha MASK and BLEND as a test on candidate hits: a surface that is not there
// neither stops a ray nor counts as a bounce.
#import geometry/primitive
#import geometry/attributes
#import material/material
#import sample/pcg
#if TEXTURES
#import material/texture
#endif

// BLEND is present with probability alpha, decided by a hash of the ray and the
// primitive, so that every copy of the test comes to the same answer.
fn alpha_accepts(ray: Ray, p: Primitive, hit: Hit) -> bool {
    if (p.a.w & PRIMITIVE_HAS_ALPHA) == 0u {
        return true;
    }
    let m = materials[primitive_material(p)];
    var alpha = m.alpha;
#if VERTEX_DATA
    let corners = corners_load(primitive_source(p));
    if (corners.flags & ATTRIBUTE_COLOR) != 0u {
        alpha *= attribute_at(corners, 2u, vec2<f32>(hit.u, hit.v)).a;
    }
#if TEXTURES
    if (corners.flags & ATTRIBUTE_UV) != 0u {
        alpha *= texture_or_white(m.base_color_texture, attribute_at(corners, 1u, vec2<f32>(hit.u, hit.v))).a;
    }
#endif
#endif
    if m.alpha_cutoff >= 0.0 {
        return alpha >= m.alpha_cutoff;
    }
    let key = vec4<u32>(ray.alpha_seed, primitive_source(p), hit.instance, 0u);
    return uniform_from_bits(pcg4d(key)).x < alpha;
}
