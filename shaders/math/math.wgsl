// Constants and small functions that every module may use.
#import generated

const PI: f32 = 3.14159265358979;
const INV_PI: f32 = 0.318309886183791;

// Rec. 709 luminance of linear radiance.
fn luminance(color: vec3<f32>) -> f32 {
    return dot(color, vec3<f32>(0.2126, 0.7152, 0.0722));
}

fn max_component(v: vec3<f32>) -> f32 {
    return max(v.x, max(v.y, v.z));
}

// Finiteness by bits: WGSL lets a compiler assume that comparisons meet no NaN.
fn is_finite(v: vec3<f32>) -> bool {
    let exponent = bitcast<vec3<u32>>(v) & vec3<u32>(0x7f800000u);
    return all(exponent != vec3<u32>(0x7f800000u));
}

// Orthonormal basis with the unit vector n as third column (Duff et al. 2017,
// "Building an Orthonormal Basis, Revisited").
fn frame_from_normal(n: vec3<f32>) -> mat3x3<f32> {
    let s = select(-1.0, 1.0, n.z >= 0.0);
    let a = -1.0 / (s + n.z);
    let b = n.x * n.y * a;
    return mat3x3<f32>(
        vec3<f32>(1.0 + s * n.x * n.x * a, s * b, -s * n.x),
        vec3<f32>(b, s + n.y * n.y * a, -n.y),
        n,
    );
}

// atan2(y, x) to about 1e-7 absolute: some drivers' own is a thousand times
// coarser. Odd minimax polynomial on [0, 1] (Abramowitz and Stegun 4.4.49).
fn atan2_accurate(y: f32, x: f32) -> f32 {
    let ax = abs(x);
    let ay = abs(y);
    let hi = max(ax, ay);
    let r = select(min(ax, ay) / hi, 0.0, hi == 0.0);
    let s = r * r;
    var p = 0.0028662257;
    p = p * s - 0.0161657367;
    p = p * s + 0.0429096138;
    p = p * s - 0.0752896400;
    p = p * s + 0.1065626393;
    p = p * s - 0.1420889944;
    p = p * s + 0.1999355085;
    p = p * s - 0.3333314528;
    p = r + r * s * p;
    p = select(p, 0.5 * PI - p, ay > ax);
    p = select(p, PI - p, x < 0.0);
    return select(p, -p, y < 0.0);
}
