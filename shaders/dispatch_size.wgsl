// Workgroups for the part of the active pixels that one dispatch of the path tracer is for.
#import frame/frame
#import stopping/dispatch

@compute @workgroup_size(1)
fn main() {
    let first = frame.dispatch_first_tile * TILE_PIXELS;
    let left = dispatch.active_count - min(first, dispatch.active_count);
    let threads = min(left, frame.dispatch_tile_count * TILE_PIXELS);
    dispatch.x = (threads + WORKGROUP_SIZE - 1u) / WORKGROUP_SIZE;
    dispatch.y = 1u;
    dispatch.z = 1u;
}
