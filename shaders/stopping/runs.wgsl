// Means of 8 to 15 consecutive runs of a pixel's samples. A run has a power of two of units; when
// sixteen runs are complete, pairs are merged. The twin of film/block_means.rs.
#import stopping/blocks
#import stopping/tally

// Differences of the runs' means to the first block's; run by run, all pixels of each.
@group(0) @binding(4) var<storage, read_write> runs: array<f32>;

fn runs_at(pixel: u32, run: u32) -> u32 {
    return run * stopping.tile_count * TILE_PIXELS + pixel;
}

// Whether pixels are judged when they have so many samples: at eight and at twelve runs.
fn runs_decide(sample_count: u32) -> bool {
    let now = runs_of(sample_count);
    return now.y >= RUNS / 2u && sample_count % (now.x * RUNS / 4u) == 0u;
}

// Adds the mean of a block of whole units to a pixel that had `count_before` samples.
fn runs_add(tally: Tally, pixel: u32, count_before: u32, mean: f32) -> Tally {
    var t = tally;
    if count_before == 0u {
        t.first = mean;
    }
    let units = f32(t.sample_count - count_before) / f32(frame.block_unit);
    // What a block's excess over the mean would be, had all of it come in one unit.
    t.largest = max(t.largest, t.mean + (mean - t.mean) * units);
    t.pending += (mean - t.first) * units;
    let before = runs_of(count_before);
    if t.sample_count % before.x != 0u {
        return t;
    }
    runs[runs_at(pixel, before.y)] = t.pending * f32(frame.block_unit) / f32(before.x);
    t.pending = 0.0;
    if before.y + 1u == RUNS {
        for (var k = 0u; k < RUNS / 2u; k++) {
            let pair = runs[runs_at(pixel, 2u * k)] + runs[runs_at(pixel, 2u * k + 1u)];
            runs[runs_at(pixel, k)] = 0.5 * pair;
        }
    }
    return t;
}

// Mean and variance from the complete runs.
fn runs_estimate(tally: Tally, pixel: u32) -> Tally {
    var t = tally;
    let n = runs_of(t.sample_count).y;
    var sum = 0.0;
    for (var k = 0u; k < n; k++) {
        sum += runs[runs_at(pixel, k)];
    }
    let mean = sum / f32(max(n, 1u));
    var squares = 0.0;
    for (var k = 0u; k < n; k++) {
        let d = runs[runs_at(pixel, k)] - mean;
        squares += d * d;
    }
    let per_run = f32(t.sample_count) / f32(max(n, 1u));
    t.mean = t.first + mean;
    t.variance = squares / f32(max(n, 2u) - 1u) * per_run;
    return t;
}
