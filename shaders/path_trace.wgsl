// The path integrator: one thread traces the samples of one pixel and adds them
// to the pixel's block, in sample order. Rays are traced by all threads of a
// subgroup at once: a thread whose path has ended goes along until all have.
#import frame/frame
#import film/film
#import film/tile
#import camera/camera
#import path/radiance
#if ADAPTIVE
#import stopping/blocks
#endif

@compute @workgroup_size(WORKGROUP_SIZE)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
#if PACKETS
    @builtin(subgroup_invocation_id) lane: u32,
#endif
) {
#if PACKETS
    packet_lane = lane;
#endif
#if !BRUTE_FORCE
    stack_lane = local;
#endif
#if PATH_REUSE
#if !PACKETS
    exchange_thread = local;
#endif
#endif
    let thread = group.x * WORKGROUP_SIZE + local;
    let in_dispatch = thread / TILE_PIXELS;
    let index = frame.dispatch_first_tile * TILE_PIXELS + thread;
    var pixel = film[index];
#if ADAPTIVE
    let in_window = tile_pixel(pixel.pixel / TILE_PIXELS, pixel.pixel % TILE_PIXELS);
    let is_active = in_dispatch < frame.dispatch_tile_count && pixel.pixel != INVALID;
    let sample_first = pixel.sample_first + frame.sample_first;
    let sample_end = block_end(pixel.sample_first);
#else
    let tile = frame.region_first_tile + frame.dispatch_first_tile + in_dispatch;
    let in_window = tile_pixel(tile, thread % TILE_PIXELS);
    let is_active = in_dispatch < frame.dispatch_tile_count && all(in_window < frame.window_size);
    let sample_first = frame.sample_first;
#endif
    let at = frame.window_origin + in_window;
    for (var i = 0u; i < frame.sample_count; i++) {
        let sampler_p = Sampler(at.x | (at.y << 16u), sample_first + i);
#if ADAPTIVE
        // Pixels with fewer samples take shorter blocks.
        let is_wanted = is_active && sampler_p.sample_index < sample_end;
#else
        let is_wanted = is_active;
#endif
        let jitter = sampler_pair(sampler_p, GROUP_PIXEL);
        let position = (vec2<f32>(at) + jitter) / vec2<f32>(frame.resolution);
        let film_position = vec2<f32>(2.0 * position.x - 1.0, 1.0 - 2.0 * position.y);
#if LENS
        let lens = sampler_pair(sampler_p, GROUP_LENS);
#else
        let lens = vec2<f32>(0.5);
#endif
        let radiance = path_radiance(sampler_p, camera_ray(film_position, lens), is_wanted);
        if is_wanted {
            pixel = film_add(pixel, radiance, sampler_p.sample_index);
        }
    }
    pixel.closest_ray_count += path_ray_count;
    pixel.shadow_ray_count += path_shadow_ray_count;
    if is_active {
        film[index] = pixel;
    }
}
