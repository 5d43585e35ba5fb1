// Makes the list of active pixels, in the order of tiles: an empty block for each.
#import film/film
#import stopping/tally
#import stopping/blocks
#import stopping/dispatch

@group(0) @binding(5) var<storage, read_write> tile_counts: array<u32>;

// One bit for each pixel of the tile.
var<workgroup> active_pixels: array<atomic<u32>, 2>;

@compute @workgroup_size(TILE_PIXELS)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = tally_thread(group, groups, local);
    let is_active = tally_is_in_window(pixel) && tallies[pixel].reason == STOP_UNFINISHED;
    if local < 2u {
        atomicStore(&active_pixels[local], 0u);
    }
    workgroupBarrier();
    if is_active {
        atomicOr(&active_pixels[local / 32u], 1u << (local % 32u));
    }
    workgroupBarrier();
    if is_active {
        let below = (1u << (local % 32u)) - 1u;
        var rank = countOneBits(atomicLoad(&active_pixels[local / 32u]) & below);
        if local >= 32u {
            rank += countOneBits(atomicLoad(&active_pixels[0]));
        }
        let entry = tile_counts[pixel / TILE_PIXELS] + rank;
        let count = tallies[pixel].sample_count;
        film[entry] = film_empty(pixel, count);
        atomicMax(&dispatch.block_samples, block_end(count) - count);
    }
    // What is left of the last workgroup of the path tracer holds nobody.
    let end = min((dispatch.active_count + LIST_PADDING - 1u) / LIST_PADDING * LIST_PADDING, arrayLength(&film));
    if pixel < TILE_PIXELS {
        for (var tail = dispatch.active_count + pixel; tail < end; tail += TILE_PIXELS) {
            film[tail] = film_empty(INVALID, 0u);
        }
    }
}
