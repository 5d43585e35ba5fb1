// Materials as the host fills them, and their parameters at a surface point.
#import geometry/surface
#import bsdf/bsdf
#if TEXTURES
#import material/texture
#endif
#if ANISOTROPY
#import material/anisotropy
#endif
#import material/layers

struct Material {
    base_color: vec3<f32>,
    alpha: f32,
    emission: vec3<f32>,
    // Alpha MASK: the cut-off. BLEND: below 0.
    alpha_cutoff: f32,
    specular_color: vec3<f32>,
    specular: f32,
    metallic: f32,
    // With MATERIAL_SPECULAR_GLOSSINESS the glossiness; specular_color is its reflectance then.
    roughness: f32,
    ior: f32,
    transmission: f32,
    normal_scale: f32,
    // MATERIAL_ flags.
    flags: u32,
    // Indices of texture descriptors, or INVALID.
    base_color_texture: u32,
    metallic_roughness_texture: u32,
    normal_texture: u32,
    emission_texture: u32,
    // Alpha; colour.
    specular_texture: u32,
    specular_color_texture: u32,
    // Of the volume's inside, 1/m.
    absorption: vec3<f32>,
    // 20 over the Abbe number.
    dispersion: f32,
    diffuse_transmission_color: vec3<f32>,
    diffuse_transmission: f32,
    sheen_color: vec3<f32>,
    sheen_roughness: f32,
    // Strength; the turn of its direction from the tangent.
    anisotropy: f32,
    anisotropy_cos: f32,
    anisotropy_sin: f32,
    // Factor; index; thickness in nm where the film's texture is 0 and where it is 1.
    iridescence: f32,
    film_ior: f32,
    film_minimum: f32,
    film_maximum: f32,
    // Factor.
    clearcoat: f32,
    clearcoat_roughness: f32,
    clearcoat_normal_scale: f32,
    // Indices of texture descriptors, or INVALID.
    transmission_texture: u32,
    diffuse_transmission_texture: u32,
    diffuse_transmission_color_texture: u32,
    anisotropy_texture: u32,
    iridescence_texture: u32,
    film_texture: u32,
    sheen_color_texture: u32,
    sheen_roughness_texture: u32,
    clearcoat_texture: u32,
    clearcoat_roughness_texture: u32,
    clearcoat_normal_texture: u32,
    specular_glossiness_texture: u32,
    padding_0: u32,
    padding_1: u32,
}

#if UNIFORM_MATERIALS
@group(0) @binding(5) var<uniform> materials: array<Material, MATERIAL_SLOTS>;
#else
@group(0) @binding(5) var<storage, read> materials: array<Material>;
#endif

// The base colour at s.
fn material_base(m: Material, s: Surface) -> vec3<f32> {
    var base = m.base_color * s.color.rgb;
#if TEXTURES
    base *= texture_or_white(m.base_color_texture, s.uv).rgb;
#endif
    return base;
}

// Index of refraction of the material's inside for a channel, 0 to 2, or for all of them: INVALID
// (KHR_materials_dispersion).
fn material_ior(m: Material, channel: u32) -> f32 {
#if DISPERSION
    if channel < 3u {
        let half_spread = (m.ior - 1.0) * 0.025 * m.dispersion;
        return max(m.ior + (f32(channel) - 1.0) * half_spread, 1.0);
    }
#endif
    return m.ior;
}

// Index on wo's side over index on the other, where `around` is the index of what the material's
// volume lies in: 1 in air.
fn material_eta(m: Material, s: Surface, channel: u32, around: f32) -> f32 {
    let ior = material_ior(m, channel);
    return select(ior / around, around / ior, s.is_front || (m.flags & MATERIAL_VOLUME) == 0u);
}

// Orthonormal basis with ns as third column; the first is the direction of a stretched highlight.
fn material_frame(m: Material, s: Surface) -> mat3x3<f32> {
#if ANISOTROPY
    if anisotropy_applies(m, s) {
        return anisotropy_frame(m, s);
    }
#endif
    return frame_from_normal(s.ns);
}

// The BSDF at s (glTF 2.0 appendix B, KHR_materials_specular, _ior, _transmission), in
// `frame_s`, of which the third column is s.ns. `eta`: index on wo's side over index on the other.
fn material_bsdf(m: Material, s: Surface, frame_s: mat3x3<f32>, eta: f32) -> Bsdf {
    var base = material_base(m, s);
    var metallic = m.metallic;
    var roughness = m.roughness;
#if TEXTURES
    let orm = texture_or_white(m.metallic_roughness_texture, s.uv);
    roughness *= orm.g;
    metallic *= orm.b;
#endif
    var specular = m.specular;
    var specular_color = m.specular_color;
#if SPECULAR_TEXTURES
    specular *= texture_or_white(m.specular_texture, s.uv).a;
    specular_color *= texture_or_white(m.specular_color_texture, s.uv).rgb;
#endif
    var r = (m.ior - 1.0) / (m.ior + 1.0);
#if TRANSMISSION
    let is_interface = m.transmission > 0.0;
    r = select(r, (1.0 - eta) / (1.0 + eta), is_interface);
#endif
    var f0 = min(vec3<f32>(r * r) * specular_color, vec3<f32>(1.0)) * specular;
#if SPECULAR_GLOSSINESS
    if (m.flags & MATERIAL_SPECULAR_GLOSSINESS) != 0u {
        f0 = m.specular_color;
#if TEXTURES
        let texel = texture_or_white(m.specular_glossiness_texture, s.uv);
        f0 *= texel.rgb;
        roughness *= texel.a;
#endif
        roughness = 1.0 - roughness;
        base *= 1.0 - max_component(f0);
    }
#endif
    let dielectric = 1.0 - metallic;
    var transmission = m.transmission;
#if TRANSMISSION_TEXTURE
    transmission *= texture_or_white(m.transmission_texture, s.uv).r;
#endif
    var b: Bsdf;
    b.diffuse = base * (dielectric * (1.0 - transmission));
    b.transmitted = base * (dielectric * transmission);
    b.diffuse_f0 = max_component(f0);
    b.diffuse_f90 = specular;
    b.specular_f0 = dielectric * f0 + metallic * base;
    b.specular_f90 = dielectric * specular + metallic;
    b.is_thin = (m.flags & MATERIAL_VOLUME) == 0u;
    b.eta = eta;
    var alpha = roughness * roughness;
    alpha = select(alpha, 0.0, alpha < LEAST_ALPHA);
    b.alpha = width_of(alpha);
#if ANISOTROPY
    b.alpha = anisotropy_width(m, s, alpha);
#endif
#if SPLIT_FRESNEL
    b.metal_f0 = base;
    b.metallic = metallic;
    b.dielectric_f0 = f0;
#endif
#if TRANSMISSION
    b.is_interface = is_interface;
    b.is_split = is_interface;
    if is_interface {
        b.interface_excess = interface_excess(f0, specular, eta);
        // Nearly the same index on both sides: nothing is refracted, however rough.
        let is_matched = !b.is_thin && abs(eta - 1.0) < LEAST_CONTRAST;
        b.alpha = select(b.alpha, width_of(0.0), is_matched);
    }
#endif
#if DIFFUSE_TRANSMISSION
    b = layers_diffuse_transmission(b, m, s, dielectric * (1.0 - transmission));
#endif
#if IRIDESCENCE
    b = layers_film(b, m, s);
#endif
#if ENERGY_COMPENSATION
    b.is_split = true;
    b.lost = layers_lost(b, dot(s.ns, s.wo));
#endif
#if SHEEN
    b.sheen = layers_sheen(m, s);
#endif
#if CLEARCOAT
    b.coat = layers_coat(m, s, frame_s);
#endif
    return b;
}

// Radiance that the surface emits towards s.wo.
fn material_emitted(m: Material, s: Surface) -> vec3<f32> {
    if !s.is_front && (m.flags & MATERIAL_EMITS_BEHIND) == 0u {
        return vec3<f32>(0.0);
    }
    var emission = m.emission;
#if TEXTURES
    emission *= texture_or_white(m.emission_texture, s.uv).rgb;
#endif
#if UNLIT
    if (m.flags & MATERIAL_UNLIT) != 0u {
        emission *= s.color.rgb;
    }
#endif
    return emission;
}
