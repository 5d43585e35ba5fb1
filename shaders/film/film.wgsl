// The running block of each pixel: sums since the block began, in sample order.
#import math/math
#import film/fault

struct FilmPixel {
    // Sum of the radiance of the block's samples, W/(sr m²).
    sum: vec3<f32>,
    sample_count: u32,
    closest_ray_count: u32,
    shadow_ray_count: u32,
    // Four 8-bit counts of samples with a fault, by cause.
    fault_counts: u32,
    // First sample index with a fault, or INVALID.
    fault_sample: u32,
}

@group(0) @binding(1) var<storage, read_write> film: array<FilmPixel>;

// Adds one sample. A sample that is not finite, or negative, counts as black and as a fault.
fn film_add(pixel: FilmPixel, radiance: vec3<f32>, sample_index: u32) -> FilmPixel {
    var p = pixel;
    var value = radiance;
    if !is_finite(value) {
        fault_raise(FAULT_NON_FINITE);
        value = vec3<f32>(0.0);
    } else if any(value < vec3<f32>(0.0)) {
        fault_raise(FAULT_NEGATIVE);
        value = vec3<f32>(0.0);
    }
    p.sum += value;
    p.sample_count += 1u;
    if fault_bits != 0u {
        let b = fault_bits;
        p.fault_counts += (b & 1u) | ((b & 2u) << 7u) | ((b & 4u) << 14u) | ((b & 8u) << 21u);
        p.fault_sample = min(p.fault_sample, sample_index);
        fault_bits = 0u;
    }
    return p;
}
