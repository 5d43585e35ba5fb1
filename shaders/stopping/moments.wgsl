// Mean and squared deviations of single samples, for the seed's rule; blocks are merged as in
// Chan, Golub and LeVeque 1983, "Algorithms for Computing the Sample Variance".
#import film/film
#import stopping/tally

fn moments_add(tally: Tally, block: FilmPixel) -> Tally {
    var t = tally;
    let n = f32(max(block.sample_count, 1u));
    // Of the differences to the block's first sample.
    let offset = luminance(block.difference) / n;
    let squares = max(block.squares - n * offset * offset, 0.0);
    // `t.sample_count` has the block already.
    let all = f32(max(t.sample_count, 1u));
    let delta = luminance(block.first) + offset - t.mean;
    t.mean += delta * n / all;
    t.pending += squares + delta * delta * (all - n) * n / all;
    return t;
}

// Unbiased variance of one sample.
fn moments_estimate(tally: Tally) -> Tally {
    var t = tally;
    t.variance = t.pending / f32(max(t.sample_count, 2u) - 1u);
    return t;
}
