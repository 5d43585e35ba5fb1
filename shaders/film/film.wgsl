// The running block of each pixel: sums since the block began, in sample order.
#import math/math
#import film/fault

struct FilmPixel {
    // Radiance of the block's first sample, W/(sr m²). A sum of what the others differ by is
    // exact where all are equal, and loses little where they nearly are.
    first: vec3<f32>,
    sample_count: u32,
    // Sum of the differences to it.
    difference: vec3<f32>,
    closest_ray_count: u32,
    shadow_ray_count: u32,
    // Four 8-bit counts of samples with a fault, by cause.
    fault_counts: u32,
    // Of the first sample with a fault: its index, the bounce, the material last met; INVALID
    // where there is none.
    fault_sample: u32,
    fault_bounce: u32,
    fault_material: u32,
    // Adaptive renders, whose film is a list of the active pixels: the pixel, counted in the
    // order of tiles, or INVALID; the block's first sample.
    pixel: u32,
    sample_first: u32,
    // The seed's rule: sum of the squared differences of luminance to the first sample.
    squares: f32,
}

@group(0) @binding(1) var<storage, read_write> film: array<FilmPixel>;

fn film_empty(pixel: u32, sample_first: u32) -> FilmPixel {
    var p = FilmPixel();
    p.fault_sample = INVALID;
    p.fault_bounce = INVALID;
    p.fault_material = INVALID;
    p.pixel = pixel;
    p.sample_first = sample_first;
    return p;
}

// Adds one sample. A sample that is not finite, or negative, counts as black and as a fault.
fn film_add(pixel: FilmPixel, radiance: vec3<f32>, sample_index: u32) -> FilmPixel {
    var p = pixel;
    fault_check(radiance);
    let unusable = (1u << FAULT_NON_FINITE) | (1u << FAULT_NEGATIVE);
    let value = select(vec3<f32>(0.0), radiance, (fault_bits & unusable) == 0u);
    if p.sample_count == 0u {
        p.first = value;
    }
    p.difference += value - p.first;
#if SEED_RULE
    let d = luminance(value - p.first);
    p.squares += d * d;
#endif
    p.sample_count += 1u;
    if fault_bits != 0u {
        let b = fault_bits;
        p.fault_counts += (b & 1u) | ((b & 2u) << 7u) | ((b & 4u) << 14u) | ((b & 8u) << 21u);
        if p.fault_sample == INVALID {
            p.fault_sample = sample_index;
            p.fault_bounce = fault_bounce;
            p.fault_material = fault_material;
        }
        fault_bits = 0u;
        fault_bounce = INVALID;
        fault_material = INVALID;
    }
    return p;
}
