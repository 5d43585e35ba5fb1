// The interval of a pixel's mean, from its runs and those of its neighbours. The twin of
// stopping/calibrated.rs.
#import stopping/tally

// Variance of the mean.
fn calibrated_variance(t: Tally) -> f32 {
    return t.variance / f32(max(t.sample_count, 1u));
}

fn calibrated_half_width(pixel: u32, own: Tally) -> f32 {
    // One run has no spread: as before it was judged.
    if own.sample_count < 2u * frame.block_unit {
        return own.half_width;
    }
    let at = vec2<i32>(tile_pixel(pixel / TILE_PIXELS, pixel % TILE_PIXELS));
    var sum = own.variance;
    var count = 1.0;
    for (var k = 0; k < 9; k++) {
        let other_at = at + vec2<i32>(k % 3 - 1, k / 3 - 1);
        if k == 4 || any(other_at < vec2<i32>(0)) || any(vec2<u32>(other_at) >= frame.window_size) {
            continue;
        }
        let other = tallies[tile_index(vec2<u32>(other_at))];
        let d = own.mean - other.mean;
        if d * d <= stopping.consistency * (calibrated_variance(own) + calibrated_variance(other)) {
            sum += other.variance;
            count += 1.0;
        }
    }
    let n = f32(own.sample_count);
    // As if one more unit came, as bright as the brightest.
    let outlier = max(own.largest - own.mean, 0.0) / (n / f32(frame.block_unit) + 1.0);
    let variance = max(own.variance, sum / count) / n + stopping.outlier_weight * outlier * outlier;
    return stopping.factor * sqrt(variance);
}

// A pixel that has stopped is judged again: its neighbours may have learnt of light that it missed.
fn calibrated_is_done(own: Tally, half_width: f32) -> bool {
    let is_hopeful = own.mean == 0.0 && own.is_lightable != 0u;
    let least = select(stopping.least_samples, stopping.black_samples, is_hopeful);
    return own.sample_count >= least
        && half_width <= stopping.tolerance * max(own.mean, stopping.floor);
}
