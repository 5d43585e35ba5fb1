// The rule that this project began with: 1.96 σ / √n against a share of the mean.
#import stopping/tally

fn seed_half_width(own: Tally) -> f32 {
    return NORMAL_95 * sqrt(own.variance / f32(own.sample_count));
}

// Once a pixel has stopped it is not judged again.
fn seed_is_done(own: Tally, half_width: f32) -> bool {
    return own.reason == STOP_CONVERGED || half_width <= stopping.tolerance * own.mean;
}
