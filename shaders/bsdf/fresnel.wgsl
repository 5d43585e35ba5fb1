// Reflectance of interfaces.

// Schlick 1994. The fifth power by products: pow is coarse on some drivers.
fn fresnel_schlick(f0: vec3<f32>, f90: f32, cosine: f32) -> vec3<f32> {
    let x = clamp(1.0 - cosine, 0.0, 1.0);
    let x2 = x * x;
    return f0 + (vec3<f32>(f90) - f0) * (x2 * x2 * x);
}
