// Where each tile's active pixels begin in the list of all: sums of the tiles before.
#import stopping/tally
#import stopping/dispatch

@group(0) @binding(5) var<storage, read_write> tile_counts: array<u32>;

// What the tiles of each thread hold together.
var<workgroup> sums: array<u32, SCAN_THREADS>;

@compute @workgroup_size(SCAN_THREADS)
fn main(@builtin(local_invocation_index) thread: u32) {
    let share = (stopping.tile_count + SCAN_THREADS - 1u) / SCAN_THREADS;
    let first = thread * share;
    let end = min(first + share, stopping.tile_count);
    var sum = 0u;
    for (var tile = first; tile < end; tile++) {
        sum += tile_counts[tile];
    }
    sums[thread] = sum;
    workgroupBarrier();
    var before = 0u;
    for (var other = 0u; other < thread; other++) {
        before += sums[other];
    }
    if thread == SCAN_THREADS - 1u {
        dispatch.active_count = before + sum;
        atomicStore(&dispatch.block_samples, 0u);
    }
    for (var tile = first; tile < end; tile++) {
        let count = tile_counts[tile];
        tile_counts[tile] = before;
        before += count;
    }
}
