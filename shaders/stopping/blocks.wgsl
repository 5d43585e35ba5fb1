// How many samples a pixel takes at a time. The more it has, the more: the length of its runs.
#import frame/frame

// Samples of a run, and complete runs, of so many samples.
fn runs_of(sample_count: u32) -> vec2<u32> {
    let units = sample_count / frame.block_unit;
    let per_run = frame.block_unit << firstLeadingBit(max(units / (RUNS / 2u), 1u));
    return vec2<u32>(per_run, sample_count / per_run);
}

// First sample after the block of a pixel that has so many.
fn block_end(sample_count: u32) -> u32 {
    let block = min(runs_of(sample_count).x, frame.largest_block);
    return min(sample_count + block, frame.sample_limit);
}
