// Tangent-space normal maps.
#import material/material

// The shading normal at s with the material's normal map applied.
fn normal_map_ns(m: Material, s: Surface) -> vec3<f32> {
    if m.normal_texture == INVALID || all(s.tangent.xyz == vec3<f32>(0.0)) {
        return s.ns;
    }
    let texel = texture_or_white(m.normal_texture, s.uv).xyz * 2.0 - 1.0;
    let n = texel * vec3<f32>(m.normal_scale, m.normal_scale, 1.0);
    // The map describes the front; the back sees its mirror image through the surface.
    let front = select(-s.ns, s.ns, s.is_front);
    let t = surface_unit(s.tangent.xyz - front * dot(front, s.tangent.xyz));
    let b = cross(front, t) * s.tangent.w;
    let ns = surface_unit(t * n.x + b * n.y + front * n.z);
    return surface_bend(select(-ns, ns, s.is_front), s.wo);
}
