// Materials as the host fills them, and their parameters at a surface point.
#import geometry/surface
#import bsdf/bsdf
#if TEXTURES
#import material/texture
#endif

struct Material {
    base_color: vec3<f32>,
    alpha: f32,
    emission: vec3<f32>,
    // Alpha MASK: the cut-off. BLEND: below 0.
    alpha_cutoff: f32,
    specular_color: vec3<f32>,
    specular: f32,
    metallic: f32,
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
    padding_0: u32,
    padding_1: u32,
}

@group(0) @binding(5) var<storage, read> materials: array<Material>;

// The base colour at s.
fn material_base(m: Material, s: Surface) -> vec3<f32> {
    var base = m.base_color * s.color.rgb;
#if TEXTURES
    base *= texture_or_white(m.base_color_texture, s.uv).rgb;
#endif
    return base;
}

// The BSDF at s (glTF 2.0 appendix B, KHR_materials_specular, _ior, _transmission).
fn material_bsdf(m: Material, s: Surface) -> Bsdf {
    let base = material_base(m, s);
    var metallic = m.metallic;
    var roughness = m.roughness;
#if TEXTURES
    let orm = texture_or_white(m.metallic_roughness_texture, s.uv);
    roughness *= orm.g;
    metallic *= orm.b;
#endif
    let r = (m.ior - 1.0) / (m.ior + 1.0);
    let f0 = min(vec3<f32>(r * r) * m.specular_color, vec3<f32>(1.0)) * m.specular;
    let dielectric = 1.0 - metallic;
    var b: Bsdf;
    b.diffuse = base * (dielectric * (1.0 - m.transmission));
    b.transmitted = base * (dielectric * m.transmission);
    b.diffuse_f0 = max_component(f0);
    b.diffuse_f90 = m.specular;
    b.specular_f0 = dielectric * f0 + metallic * base;
    b.specular_f90 = dielectric * m.specular + metallic;
    b.alpha = select(roughness * roughness, 0.0, m.transmission > 0.0);
    b.alpha = select(b.alpha, 0.0, b.alpha < LEAST_ALPHA);
    b.is_thin = (m.flags & MATERIAL_VOLUME) == 0u;
    b.eta = select(m.ior, 1.0 / m.ior, s.is_front || b.is_thin);
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
