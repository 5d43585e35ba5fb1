// What the extensions add to a material's BSDF, with their textures.
#import material/material
#if CLEARCOAT_NORMAL
#import material/normal_map
#endif
#if ENERGY_COMPENSATION
#import bsdf/albedo_tables
#endif

#if DIFFUSE_TRANSMISSION
// `share`: of the light that passes the surface, what the diffuse lobes have
// (KHR_materials_diffuse_transmission).
fn layers_diffuse_transmission(bsdf: Bsdf, m: Material, s: Surface, share: f32) -> Bsdf {
    var b = bsdf;
    var part = m.diffuse_transmission;
    var color = m.diffuse_transmission_color;
#if TEXTURES
    part *= texture_or_white(m.diffuse_transmission_texture, s.uv).a;
    color *= texture_or_white(m.diffuse_transmission_color_texture, s.uv).rgb;
#endif
    b.diffuse *= 1.0 - part;
    b.diffuse_below = color * (share * part);
    return b;
}
#endif

#if IRIDESCENCE
// The inside of a volume has no film (KHR_materials_iridescence).
fn layers_film(bsdf: Bsdf, m: Material, s: Surface) -> Bsdf {
    var b = bsdf;
    var factor = m.iridescence;
    var mixed = 1.0;
#if TEXTURES
    factor *= texture_or_white(m.iridescence_texture, s.uv).r;
    mixed = texture_or_white(m.film_texture, s.uv).g;
#endif
    b.film = select(0.0, factor, s.is_front || b.is_thin);
    b.film_ior = m.film_ior;
    b.film_thickness = mix(m.film_minimum, m.film_maximum, mixed);
    b.is_split = b.is_split || b.film > 0.0;
    return b;
}
#endif

#if ENERGY_COMPENSATION
// What GGX loses over what it keeps (Turquin 2019, "Practical multiple scattering compensation for
// microfacet models"); a stretched lobe by its mean width.
fn layers_lost(b: Bsdf, cos_o: f32) -> f32 {
    if !width_is_rough(b.alpha) {
        return 0.0;
    }
#if ANISOTROPY
    let kept = albedo_of_ggx(cos_o, sqrt(b.alpha.x * b.alpha.y));
#else
    let kept = albedo_of_ggx(cos_o, b.alpha);
#endif
    return (1.0 - kept) / kept;
}
#endif

#if SHEEN
fn layers_sheen(m: Material, s: Surface) -> Sheen {
    var color = m.sheen_color;
    var roughness = m.sheen_roughness;
#if TEXTURES
    color *= texture_or_white(m.sheen_color_texture, s.uv).rgb;
    roughness *= texture_or_white(m.sheen_roughness_texture, s.uv).a;
#endif
    return sheen_new(color, roughness, dot(s.ns, s.wo));
}
#endif

#if CLEARCOAT
fn layers_coat(m: Material, s: Surface, frame_s: mat3x3<f32>) -> Coat {
    var factor = m.clearcoat;
    var roughness = m.clearcoat_roughness;
    var n = s.nv;
#if TEXTURES
    factor *= texture_or_white(m.clearcoat_texture, s.uv).r;
    roughness *= texture_or_white(m.clearcoat_roughness_texture, s.uv).g;
#endif
#if CLEARCOAT_NORMAL
    n = normal_mapped(m.clearcoat_normal_texture, m.clearcoat_normal_scale, s, s.nv);
#endif
    n = surface_bend(n, s.ng, s.wo);
    return coat_new(factor, roughness, n * frame_s, s.wo * frame_s);
}
#endif
