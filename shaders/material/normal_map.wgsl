// Tangent-space normal maps.
#import material/material

// The interpolated normal at s with the material's normal map applied.
fn normal_map_ns(m: Material, s: Surface) -> vec3<f32> {
    return normal_mapped(m.normal_texture, m.normal_scale, s, s.ns);
}

// A normal on wo's side, `ns` where there is no map, turned by one.
fn normal_mapped(texture: u32, scale: f32, s: Surface, ns: vec3<f32>) -> vec3<f32> {
    if texture == INVALID || all(s.tangent.xyz == vec3<f32>(0.0)) {
        return ns;
    }
    let texel = texture_or_white(texture, s.uv).xyz * 2.0 - 1.0;
    let n = texel * vec3<f32>(scale, scale, 1.0);
    // The map describes the front; the back sees its mirror image through the surface.
    let front = select(-ns, ns, s.is_front);
    let t = surface_unit(s.tangent.xyz - front * dot(front, s.tangent.xyz));
    let b = cross(front, t) * s.tangent.w;
    let mapped = surface_unit(t * n.x + b * n.y + front * n.z);
    return select(-mapped, mapped, s.is_front);
}
