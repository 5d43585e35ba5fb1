// Adds the block of every active pixel to what is known of the pixel, estimates its error where
// it is to be judged, and empties the block for the next.
#import film/film
#import stopping/tally
#if SEED_RULE
#import stopping/moments
#else
#import stopping/runs
#endif

@compute @workgroup_size(TILE_PIXELS)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let entry = tally_thread(group, groups, local);
    if entry >= arrayLength(&film) || film[entry].pixel == INVALID {
        return;
    }
    let block = film[entry];
    // A round that was broken off has not reached all pixels; past the end of the list are those
    // of a longer one.
    if block.sample_count == 0u {
        return;
    }
    let pixel = block.pixel;
    var t = tallies[pixel];
    let count_before = t.sample_count;
    t.sample_count += block.sample_count;
#if SEED_RULE
    t = moments_add(t, block);
    let is_due = t.sample_count % stopping.batch == 0u;
#else
    if block.sample_count % frame.block_unit == 0u {
        let mean = luminance(block.first + block.difference / f32(block.sample_count));
        t = runs_add(t, pixel, count_before, mean);
    }
    let is_due = runs_decide(t.sample_count);
#endif
    if block.closest_ray_count > block.sample_count {
        t.is_lightable = 1u;
    }
    t.is_estimated = 0u;
    if is_due || t.sample_count >= frame.sample_limit {
#if SEED_RULE
        t = moments_estimate(t);
#else
        t = runs_estimate(t, pixel);
#endif
        t.is_estimated = 1u;
    }
    tallies[pixel] = t;
    film[entry] = film_empty(pixel, t.sample_count);
}
