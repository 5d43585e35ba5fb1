// Judges every pixel that has an estimate of all its samples, and counts in each tile those
// that go on.
#import stopping/tally
#if SEED_RULE
#import stopping/seed
#else
#import stopping/calibrated
#endif

@group(0) @binding(5) var<storage, read_write> tile_counts: array<u32>;

var<workgroup> active_count: atomic<u32>;

// Whether the pixel goes on.
fn judge_pixel(pixel: u32) -> bool {
    let own = tallies[pixel];
    if own.is_estimated == 0u {
        return true;
    }
#if SEED_RULE
    let half_width = seed_half_width(own);
    let is_done = seed_is_done(own, half_width);
#else
    let half_width = calibrated_half_width(pixel, own);
    let is_done = calibrated_is_done(own, half_width);
#endif
    let undone = select(STOP_UNFINISHED, STOP_LIMIT, own.sample_count >= frame.sample_limit);
    let reason = select(undone, STOP_CONVERGED, is_done);
    // What neighbours read is left alone.
    tallies[pixel].half_width = half_width;
    tallies[pixel].reason = reason;
    return reason == STOP_UNFINISHED;
}

@compute @workgroup_size(TILE_PIXELS)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = tally_thread(group, groups, local);
    if local == 0u {
        atomicStore(&active_count, 0u);
    }
    workgroupBarrier();
    if tally_is_in_window(pixel) && judge_pixel(pixel) {
        atomicAdd(&active_count, 1u);
    }
    workgroupBarrier();
    if local == 0u && pixel / TILE_PIXELS < stopping.tile_count {
        tile_counts[pixel / TILE_PIXELS] = atomicLoad(&active_count);
    }
}
