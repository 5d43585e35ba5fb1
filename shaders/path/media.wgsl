// The volumes that a path is in: their materials, innermost first, INVALID where there are no
// more. Crossing the boundary of a volume from its front adds it, from its back removes it. Of more
// than four in each other the outermost is forgotten. A volume around the camera is known once its
// back is met.
#import geometry/surface
#import material/material
#import math/exponential

// The length of a segment that meets nothing, metres.
const MEDIA_FAR: f32 = 1e18;

fn media_none() -> vec4<u32> {
    return vec4<u32>(INVALID);
}

fn media_without(media: vec4<u32>, material: u32) -> vec4<u32> {
    if media.x == material {
        return vec4<u32>(media.yzw, INVALID);
    }
    if media.y == material {
        return vec4<u32>(media.x, media.zw, INVALID);
    }
    if media.z == material {
        return vec4<u32>(media.xy, media.w, INVALID);
    }
    return vec4<u32>(media.xyz, select(media.w, INVALID, media.w == material));
}

// Those beyond the surface.
fn media_beyond(media: vec4<u32>, s: Surface) -> vec4<u32> {
    if (materials[s.material].flags & MATERIAL_VOLUME) == 0u {
        return media;
    }
    if s.is_front {
        return vec4<u32>(s.material, media.xyz);
    }
    return media_without(media, s.material);
}

// Those of the segment that ends at the surface: a ray that meets the back of a volume was in it.
fn media_before(media: vec4<u32>, s: Surface) -> vec4<u32> {
    let is_volume = (materials[s.material].flags & MATERIAL_VOLUME) != 0u;
    if is_volume && !s.is_front && !any(media == vec4<u32>(s.material)) {
        return vec4<u32>(s.material, media.xyz);
    }
    return media;
}

// What a segment of this length lets through: Beer and Lambert's law in the innermost volume.
fn media_transmittance(media: vec4<u32>, distance: f32) -> vec3<f32> {
    if media.x == INVALID {
        return vec3<f32>(1.0);
    }
    let absorption = materials[media.x].absorption;
    return exp_accurate3(-absorption * distance);
}

// What a ray that leaves the surface lets through on all of its length.
fn media_along(media: vec4<u32>, s: Surface, ray: Ray) -> vec3<f32> {
    let distance = select(ray.t_max * length(ray.direction), MEDIA_FAR, ray.t_max == T_INFINITY);
    if dot(ray.direction, s.ng) < 0.0 {
        return media_transmittance(media_beyond(media, s), distance);
    }
    return media_transmittance(media, distance);
}

// The material on the outside of a volume's surface, INVALID for air.
fn media_outside(media: vec4<u32>, s: Surface) -> u32 {
    if s.is_front {
        return media.x;
    }
    return media_without(media, s.material).x;
}
