// What the samples of each pixel say of its error. Pixels are in the order of tiles.
#import film/tile

struct Tally {
    // Mean luminance, W/(sr m²), when it was last estimated.
    mean: f32,
    // Variance of one sample: that of the mean times the samples.
    variance: f32,
    // Largest mean of a unit, if all that a block has over the mean came in one.
    largest: f32,
    sample_count: u32,
    // Half-width of the interval of the mean, when the pixel was last judged.
    half_width: f32,
    // A STOP_ reason.
    reason: u32,
    // 1: a path of the pixel went on from the first surface: it might have found light.
    is_lightable: u32,
    // 1: mean and variance are of all samples.
    is_estimated: u32,
    // Mean of the first block, to which others are held as differences.
    first: f32,
    // Sum of the differences of the units of the run under way; the seed's rule: sum of the
    // samples' squared deviations from their mean.
    pending: f32,
}

struct Stopping {
    // Share of the mean.
    tolerance: f32,
    // Luminance that darker pixels count as.
    floor: f32,
    // Samples before a pixel may stop, and before a black one may that light could reach.
    least_samples: u32,
    black_samples: u32,
    // Standard errors in a half-width.
    factor: f32,
    // Squared difference of two means over the sum of their variances up to which a neighbour counts.
    consistency: f32,
    // 1: a pixel's variance is as if one more unit came, as bright as its brightest.
    outlier_weight: f32,
    // Samples between two decisions of the seed's rule.
    batch: u32,
    tile_count: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

@group(0) @binding(2) var<uniform> stopping: Stopping;
@group(0) @binding(3) var<storage, read_write> tallies: array<Tally>;

// Whether the window has that pixel: tiles reach over its edges.
fn tally_is_in_window(pixel: u32) -> bool {
    return pixel < stopping.tile_count * TILE_PIXELS
        && all(tile_pixel(pixel / TILE_PIXELS, pixel % TILE_PIXELS) < frame.window_size);
}

// Workgroups are laid out in rows where there are more than one row may have.
fn tally_thread(group: vec3<u32>, groups: vec3<u32>, local: u32) -> u32 {
    return (group.y * groups.x + group.x) * TILE_PIXELS + local;
}
