// Exponential and logarithm to about 1e-7: some drivers' own are a thousand times coarser.
#import math/math

// log(1 + d) for |d| < 0.42: twice the inverse hyperbolic tangent of d / (2 + d), as a series.
fn log_near_one(d: f32) -> f32 {
    let s = d / (2.0 + d);
    let q = s * s;
    return 2.0 * s * (1.0 + q * (1.0 / 3.0 + q * (0.2 + q * (1.0 / 7.0 + q * (1.0 / 9.0 + q / 11.0)))));
}

// log(1 - x) for 0 <= x <= 0.25, which loses nothing where x is small.
fn log_of_one_less(x: f32) -> f32 {
    return log_near_one(-min(x, 0.4));
}

// For a normal number x > 0.
fn log_accurate(x: f32) -> f32 {
    let bits = bitcast<u32>(x);
    var e = f32(bits >> 23u) - 127.0;
    var m = bitcast<f32>((bits & 0x007fffffu) | 0x3f800000u);
    if m > 1.4142135 {
        m *= 0.5;
        e += 1.0;
    }
    return e * 0.69314718 + log_near_one(m - 1.0);
}

fn exp_accurate3(x: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(exp_accurate(x.x), exp_accurate(x.y), exp_accurate(x.z));
}

// 0 below exp(-87), and not above exp(87).
fn exp_accurate(x: f32) -> f32 {
    if x < -87.0 {
        return 0.0;
    }
    let y = min(x, 87.0);
    let n = round(y * 1.44269504);
    // ln 2 in two parts, of which the first has few bits.
    let r = (y - n * 0.693145751953125) - n * 1.42860682e-6;
    let p = 1.0 + r * (1.0 + r * (0.5 + r * (1.0 / 6.0 + r * (1.0 / 24.0 + r * (1.0 / 120.0 + r * (1.0 / 720.0 + r / 5040.0))))));
    return p * bitcast<f32>(u32(i32(n) + 127) << 23u);
}
