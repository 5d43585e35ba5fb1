// Uniform square to other shapes.
#import math/math

// Unit vector at an angle. Its length is one however coarse the device's sine and cosine are:
// a point of a light must lie on the light.
fn warp_circle(phi: f32) -> vec2<f32> {
    return normalize(vec2<f32>(cos(phi), sin(phi)));
}

// Unit disk, area-preserving and continuous (Shirley and Chiu 1997).
fn warp_disk(u: vec2<f32>) -> vec2<f32> {
    let p = 2.0 * u - 1.0;
    let by_x = abs(p.x) > abs(p.y);
    let r = select(p.y, p.x, by_x);
    if r == 0.0 {
        return vec2<f32>(0.0);
    }
    let q = select(p.x / p.y, p.y / p.x, by_x) * (0.25 * PI);
    let phi = select(0.5 * PI - q, q, by_x);
    return r * warp_circle(phi);
}

// Hemisphere about +z with pdf cos / π.
fn warp_cosine_hemisphere(u: vec2<f32>) -> vec3<f32> {
    let d = warp_disk(u);
    return vec3<f32>(d, sqrt(max(0.0, 1.0 - dot(d, d))));
}

// Hemisphere about +z with pdf 1 / 2π.
fn warp_uniform_hemisphere(u: vec2<f32>) -> vec3<f32> {
    let d = warp_disk(u);
    // The rim of the disk is off by what sines and cosines are: not below the horizon.
    let s = min(dot(d, d), 1.0);
    return vec3<f32>(d * sqrt(max(0.0, 2.0 - s)), 1.0 - s);
}

// Barycentric weights of the second and third vertex, uniform over a triangle's area.
fn warp_triangle(u: vec2<f32>) -> vec2<f32> {
    let s = sqrt(u.x);
    return vec2<f32>(s * (1.0 - u.y), s * u.y);
}

// Unit sphere with pdf 1 / 4π.
fn warp_sphere(u: vec2<f32>) -> vec3<f32> {
    let z = 1.0 - 2.0 * u.x;
    let r = 2.0 * sqrt(max(0.0, u.x * (1.0 - u.x)));
    let phi = 2.0 * PI * u.y;
    return vec3<f32>(r * warp_circle(phi), z);
}
