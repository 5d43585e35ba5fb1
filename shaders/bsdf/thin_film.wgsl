// Interference in a thin film (Belcour and Barla 2017, "A Practical Extension to Microfacet Theory
// for the Modeling of Varying Iridescence"), with the simplifications of KHR_materials_iridescence:
// Schlick's reflectances, phase jumps of 0 or half a turn, two orders, air outside.
#import math/exponential
#import math/math
#import bsdf/fresnel

// The least part of 1 - R that is kept where a quotient needs it.
const FILM_MOST: f32 = 0.9999;

// Heights of the colour matching functions' transforms at 0: X has two peaks.
const FILM_X: f32 = 0.84659;
const FILM_X2: f32 = 0.153868306;
const FILM_Y: f32 = 1.00022189;
const FILM_Z: f32 = 1.00112249;

// Fourier transforms of the colour matching functions X, Y, Z (Gaussian fits), for an optical path
// difference in nm and phase jumps in half turns; over their value at 0.
fn film_sensitivity(difference: f32, jumps: vec3<f32>) -> vec3<f32> {
    let path = 1e-9 * difference;
    let k = 2.0 * PI * path;
    // Turns less whole turns: the cosine of a small angle.
    let turns = vec3<f32>(1.6810e6, 1.7953e6, 2.2084e6) * path + 0.5 * jumps;
    let wave = cos(2.0 * PI * (turns - round(turns)));
    let fade = exp_accurate3(vec3<f32>(-4.3278e9, -9.3046e9, -6.6121e9) * (k * k));
    var xyz = vec3<f32>(FILM_X, FILM_Y, FILM_Z) * wave * fade;
    let second = 2.2399e6 * path + 0.5 * jumps.x;
    xyz.x += FILM_X2 * cos(2.0 * PI * (second - round(second))) * exp_accurate(-4.5282e9 * (k * k));
    return vec3<f32>(
        3.2404542 * xyz.x - 1.5371385 * xyz.y - 0.4985314 * xyz.z,
        -0.9692660 * xyz.x + 1.8760108 * xyz.y + 0.0415560 * xyz.z,
        0.0556434 * xyz.x - 0.2040259 * xyz.y + 1.0572252 * xyz.z,
    );
}

// Reflectance of a base of reflectance f0 under a film, at the cosine outside.
fn film_reflectance(cosine: f32, ior: f32, thickness: f32, f0: vec3<f32>) -> vec3<f32> {
    // A film that vanishes has no index of its own.
    let n = mix(1.0, ior, smoothstep(0.0, 0.03, thickness));
    let cos2_t = 1.0 - (1.0 - cosine) * (1.0 + cosine) / (n * n);
    if cos2_t <= 0.0 {
        return vec3<f32>(1.0);
    }
    let cos_t = sqrt(cos2_t);
    let outer = (n - 1.0) / (n + 1.0);
    let r12 = fresnel_schlick(vec3<f32>(outer * outer), 1.0, cosine).x;
    let t121 = 1.0 - r12;
    // The base's index is (1 + s) / (1 - s): its reflectance under the film without that quotient.
    let s = sqrt(clamp(f0, vec3<f32>(0.0), vec3<f32>(FILM_MOST)));
    let inner = ((1.0 - n) + s * (1.0 + n)) / ((1.0 + n) + s * (1.0 - n));
    let r23 = fresnel_schlick(inner * inner, 1.0, cos_t);
    // Half turns: one at the outer face from within, one more where the base is the thinner medium.
    let jumps = 1.0 + select(vec3<f32>(0.0), vec3<f32>(1.0), inner < vec3<f32>(0.0));
    let r123 = min(r12 * r23, vec3<f32>(FILM_MOST));
    let across = t121 * t121 * r23 / (1.0 - r123);
    let root = sqrt(r123);
    let difference = 2.0 * n * thickness * cos_t;
    var amplitude = (across - t121) * root;
    var sum = r12 + across + 2.0 * amplitude * film_sensitivity(difference, jumps);
    amplitude *= root;
    sum += 2.0 * amplitude * film_sensitivity(2.0 * difference, 2.0 * jumps);
    return clamp(sum, vec3<f32>(0.0), vec3<f32>(1.0));
}
