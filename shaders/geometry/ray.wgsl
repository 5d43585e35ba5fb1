// Rays, hits, and how a ray leaves a surface.
#import math/math

struct Ray {
    origin: vec3<f32>,
    // Hits lie in (0, t_max), in units of `direction`'s length.
    t_max: f32,
    direction: vec3<f32>,
    // Seed of the alpha tests along this ray.
    alpha_seed: u32,
}

struct Hit {
    t: f32,
    // Barycentric weights of the second and third vertex; 0 on spheres.
    u: f32,
    v: f32,
    // Record in `primitives`, or INVALID for a miss.
    primitive: u32,
    // The instance's record in `nodes`; INVALID for triangles in world space; HIT_SPHERE.
    instance: u32,
}

// In place of an instance: the primitive is a sphere.
const HIT_SPHERE: u32 = 0xfffffffeu;

const T_INFINITY: f32 = 3.4028234e38;

fn ray_new(origin: vec3<f32>, direction: vec3<f32>) -> Ray {
    return Ray(origin, T_INFINITY, direction, 0u);
}

fn hit_none(ray: Ray) -> Hit {
    return Hit(ray.t_max, 0.0, 0.0, INVALID, INVALID);
}

// The point from which a ray along `direction` leaves a surface: moved off it by
// `offset` along the geometric normal, to the side that the ray goes to.
fn ray_spawn(position: vec3<f32>, ng: vec3<f32>, offset: f32, direction: vec3<f32>) -> vec3<f32> {
    return position + ng * select(-offset, offset, dot(ng, direction) >= 0.0);
}

// Distance by which rays leave a surface whose coordinates are up to `extent`:
// 8 units in the last place of the largest.
fn spawn_offset(extent: f32) -> f32 {
    return 8.0 * 1.1920929e-7 * extent;
}
