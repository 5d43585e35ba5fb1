// Projection along a ray's direction (Woop, Benthin and Wald 2013).

// A direction prepared for the projection along it.
struct Shear {
    // Which component has the largest magnitude, of equal ones z before x before y.
    is_x: bool,
    is_z: bool,
    // That component, and the others over it.
    major: f32,
    slope: vec2<f32>,
}

fn shear_new(d: vec3<f32>) -> Shear {
    let m = abs(d);
    let is_z = m.z >= max(m.x, m.y);
    let is_x = !is_z && m.x >= m.y;
    let r = shear_rotate(d, is_x, is_z);
    return Shear(is_x, is_z, r.z, r.xy / r.z);
}

// Rotates the components so that the major one comes last.
fn shear_rotate(v: vec3<f32>, is_x: bool, is_z: bool) -> vec3<f32> {
    return select(select(v.zxy, v.yzx, is_x), v, is_z);
}

fn shear_apply(s: Shear, p: vec3<f32>) -> vec2<f32> {
    let r = shear_rotate(p, s.is_x, s.is_z);
    return r.xy - s.slope * r.z;
}
