// Stretched highlights (KHR_materials_anisotropy): their direction and widths.
#import material/material

// Below this the tangent is along the normal, and no direction of the surface.
const LEAST_TANGENT: f32 = 1e-4;

// The tangent's part along the surface, not of unit length.
fn anisotropy_tangent(s: Surface) -> vec3<f32> {
    return s.tangent.xyz - s.ns * dot(s.ns, s.tangent.xyz);
}

fn anisotropy_applies(m: Material, s: Surface) -> bool {
    let t = anisotropy_tangent(s);
    return m.anisotropy > 0.0 && dot(t, t) > LEAST_TANGENT * LEAST_TANGENT;
}

// Direction in the plane of tangent and bitangent, and strength.
fn anisotropy_texel(m: Material, s: Surface) -> vec3<f32> {
    var direction = vec2<f32>(1.0, 0.0);
    var strength = m.anisotropy;
#if TEXTURES
    if m.anisotropy_texture != INVALID {
        let texel = texture_or_white(m.anisotropy_texture, s.uv);
        direction = texel.rg * 2.0 - 1.0;
        strength *= texel.b;
    }
#endif
    let x = m.anisotropy_cos * direction.x - m.anisotropy_sin * direction.y;
    let y = m.anisotropy_sin * direction.x + m.anisotropy_cos * direction.y;
    let length2 = x * x + y * y;
    if length2 <= 0.0 {
        return vec3<f32>(m.anisotropy_cos, m.anisotropy_sin, strength);
    }
    return vec3<f32>(vec2<f32>(x, y) / sqrt(length2), strength);
}

// Orthonormal basis: the direction of the highlight, the one across, ns.
fn anisotropy_frame(m: Material, s: Surface) -> mat3x3<f32> {
    let front = select(-s.ns, s.ns, s.is_front);
    let t = normalize(anisotropy_tangent(s));
    let d = anisotropy_texel(m, s);
    let x = normalize(t * d.x + cross(front, t) * (s.tangent.w * d.y));
    return mat3x3<f32>(x, cross(s.ns, x), s.ns);
}

// GGX widths along that direction and across.
fn anisotropy_width(m: Material, s: Surface, alpha: f32) -> vec2<f32> {
    if !anisotropy_applies(m, s) {
        return vec2<f32>(alpha);
    }
    let strength = anisotropy_texel(m, s).z;
    if strength <= 0.0 {
        return vec2<f32>(alpha);
    }
    return max(vec2<f32>(mix(alpha, 1.0, strength * strength), alpha), vec2<f32>(LEAST_ALPHA));
}
