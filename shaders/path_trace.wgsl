// The path integrator: one thread traces the samples of one pixel and adds them
// to the pixel's block, in sample order. Rays are traced by all threads of a
// subgroup at once: a thread whose path has ended goes along until all have.
#import frame/frame
#import film/film
#import film/tile
#import camera/camera
#import geometry/trace
#import path/path
#if TEXTURES
#import material/normal_map
#endif
#if SOBOL
#import sample/sampler_sobol
#else
#import sample/sampler_independent
#endif
#if NEE
#import light/direct
#endif
#if ADAPTIVE
#import stopping/blocks
#endif

// Rays traced by this thread.
var<private> path_ray_count: u32 = 0u;
var<private> path_shadow_ray_count: u32 = 0u;

// Radiance along one camera path.
fn path_radiance(sampler_p: Sampler, camera: Ray, is_active: bool) -> vec3<f32> {
    var p = path_new(camera, is_active);
    var material = INVALID;
    for (var bounce = 0u; bounce < PATH_LENGTH_LIMIT; bounce++) {
        p.ray.alpha_seed = sampler_alpha_seed(sampler_p, bounce);
#if CULLING
        leaf_is_camera = bounce == 0u;
#endif
        let hit = trace_closest(p.ray, p.is_alive);
#if CULLING
        leaf_is_camera = false;
#endif
        path_ray_count += select(0u, 1u, p.is_alive);
        let has_hit = p.is_alive && hit.primitive != INVALID;
#if MEDIA
        if p.is_alive && !has_hit {
            p.throughput *= media_transmittance(p.media, MEDIA_FAR);
        }
#endif
#if ENVIRONMENT
        if p.is_alive && !has_hit && path_keeps(bounce) && frame.environment_size.x > 0u {
            p.radiance += path_environment(p);
        }
#endif
        p.is_alive = has_hit;
        var s: Surface;
        var b: Bsdf;
        var frame_s: mat3x3<f32>;
        if has_hit {
            s = surface_at(p.ray, hit);
            material = s.material;
            let m = materials[material];
#if MEDIA
            p.media = media_before(p.media, s);
            p.throughput *= media_transmittance(p.media, hit.t);
#endif
#if TEXTURES
            s.ns = normal_map_ns(m, s);
#endif
            s.ns = surface_bend(s.ns, s.ng, s.wo);
#if LIGHT_SURFACES
            if s.light != INVALID && path_keeps(bounce) {
                p.radiance += path_emission(p, m, s);
            }
#endif
#if DISPERSION
            p = path_choose_channel(p, m, sampler_choice(sampler_p, bounce, 0u).z);
#endif
            frame_s = material_frame(m, s);
            b = material_bsdf(m, s, frame_s, path_eta(p, m, s));
        }
        fault_watch(p.radiance, bounce, material);
        p.is_alive = p.is_alive && bounce < frame.max_bounces;
        if !trace_any_lane(p.is_alive) {
            return p.radiance;
        }
        let u = sampler_vertex(sampler_p, bounce);
#if NEE
        if frame.light_count > 0u && path_keeps(bounce + 1u) {
            for (var i = 0u; i < frame.light_samples; i++) {
                var d = direct_none();
                if p.is_alive {
                    d = direct_sample(s, b, frame_s, sampler_p, bounce, u.xy, i);
#if MEDIA
                    d.radiance *= media_along(p.media, s, d.ray);
#endif
                }
                let has_ray = max_component(d.radiance) > 0.0;
                path_shadow_ray_count += select(0u, 1u, has_ray);
                let is_blocked = trace_any(d.ray, has_ray);
                p.radiance += p.throughput * select(d.radiance, vec3<f32>(0.0), is_blocked);
            }
            fault_watch(p.radiance, bounce, material);
        }
#endif
        if p.is_alive {
            p = path_scatter(p, s, b, frame_s, u.zw, sampler_choice(sampler_p, bounce, 0u).x, bounce);
        }
    }
    if p.is_alive {
        fault_raise(FAULT_LOOP_BOUND);
    }
    return p.radiance;
}

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
