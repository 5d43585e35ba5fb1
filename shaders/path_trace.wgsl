// The path integrator: one thread traces the samples of one pixel and adds them
// to the pixel's block, in sample order.
#import frame/frame
#import film/film
#import camera/camera
#if BRUTE_FORCE
#import geometry/brute_force
#else
#import geometry/bvh
#endif
#import geometry/surface
#import material/material
#import bsdf/scatter
#if TEXTURES
#import material/normal_map
#endif
#if SOBOL
#import sample/sampler_sobol
#else
#import sample/sampler_independent
#endif
#if MIS
#import strategy/mis
#endif
#if LIGHT_ONLY
#import strategy/light
#endif
#if SCATTER_ONLY
#import strategy/scatter
#endif
#if NEE
#import light/direct
#endif
#if LIGHT_SURFACES
#import light/light
#endif
#if ENVIRONMENT
#import light/environment
#endif

// Roulette begins at this bounce, and never lets a path go on with less or more than these.
const ROULETTE_START: u32 = 5u;
const ROULETTE_LEAST: f32 = 0.05;
const ROULETTE_MOST: f32 = 0.95;

var<private> path_ray_count: u32 = 0u;

// Whether light that was scattered `bounce` times belongs to the picture.
fn path_keeps(bounce: u32) -> bool {
    return frame.only_bounce == INVALID || frame.only_bounce == bounce;
}

// Radiance along one camera path.
fn path_radiance(sampler_p: Sampler, camera: Ray) -> vec3<f32> {
    var ray = camera;
    var radiance = vec3<f32>(0.0);
    var throughput = vec3<f32>(1.0);
    // Density of the direction that the ray took, for the weight of emission it meets.
    var scatter_pdf = PDF_DELTA;
    // Where it left the last surface.
    var scatter_point = camera.origin;
    var eta_scale = 1.0;
    for (var bounce = 0u; bounce < PATH_LENGTH_LIMIT; bounce++) {
        ray.alpha_seed = sampler_alpha_seed(sampler_p, bounce);
        let hit = bvh_closest_hit(ray);
        path_ray_count += 1u;
        if hit.primitive == INVALID {
#if ENVIRONMENT
            if path_keeps(bounce) && frame.environment_size.x > 0u {
                let w = strategy_emission_weight(scatter_pdf, environment_pdf(ray.direction));
                radiance += throughput * environment_emitted(ray.direction) * w;
            }
#endif
            return radiance;
        }
        var s = surface_at(ray, hit);
        let m = materials[s.material];
#if TEXTURES
        s.ns = normal_map_ns(m, s);
#endif
#if LIGHT_SURFACES
        if s.light != INVALID && path_keeps(bounce) {
            let w = strategy_emission_weight(scatter_pdf, light_surface_pdf(s, hit.is_sphere, scatter_point));
            radiance += throughput * material_emitted(m, s) * w;
        }
#endif
        if bounce >= frame.max_bounces {
            return radiance;
        }
        let b = material_bsdf(m, s);
        let frame_s = frame_from_normal(s.ns);
        let u = sampler_vertex(sampler_p, bounce);
#if NEE
        if path_keeps(bounce + 1u) {
            radiance += throughput * direct_light(s, b, frame_s, sampler_p, bounce, u.xy);
        }
#endif
        let scattered = bsdf_sample(b, s.wo * frame_s, u.zw);
        let wi = frame_s * scattered.wi;
        // A shading normal can send light through the true surface, or the reverse: such a path ends.
        let crosses = (scattered.wi.z < 0.0) != (dot(wi, s.ng) < 0.0);
        if scattered.pdf == 0.0 || crosses {
            return radiance;
        }
        throughput *= scattered.weight;
        eta_scale *= scattered.eta_scale;
#if ROULETTE
        if bounce + 1u >= ROULETTE_START {
            let q = clamp(max_component(throughput) / eta_scale, ROULETTE_LEAST, ROULETTE_MOST);
            if sampler_choice(sampler_p, bounce).x >= q {
                return radiance;
            }
            throughput /= q;
        }
#endif
        scatter_pdf = scattered.pdf;
        scatter_point = s.position;
        ray = ray_new(ray_spawn(s.position, s.ng, s.offset, wi), wi);
    }
    fault_raise(FAULT_LOOP_BOUND);
    return radiance;
}

// Pixel of the picture that thread `local` of a tile works on: a tile is 8 by 8
// pixels, eight neighbouring threads are a block of 4 by 2.
fn path_pixel(tile: u32, local: u32) -> vec2<u32> {
    let x = (local & 3u) | ((local >> 1u) & 4u);
    let y = ((local >> 2u) & 1u) | ((local >> 3u) & 6u);
    return vec2<u32>(tile % frame.tiles_across, tile / frame.tiles_across) * 8u + vec2<u32>(x, y);
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
#if !BRUTE_FORCE
    bvh_lane = local;
#endif
    let tile = frame.dispatch_first_tile + group.x;
    let in_window = path_pixel(frame.region_first_tile + tile, local);
    if any(in_window >= frame.window_size) {
        return;
    }
    let at = frame.window_origin + in_window;
    let index = tile * WORKGROUP_SIZE + local;
    var pixel = film[index];
    for (var i = 0u; i < frame.sample_count; i++) {
        let sampler_p = Sampler(at.x | (at.y << 16u), frame.sample_first + i);
        let jitter = sampler_pair(sampler_p, GROUP_PIXEL);
        let position = (vec2<f32>(at) + jitter) / vec2<f32>(frame.resolution);
        let film_position = vec2<f32>(2.0 * position.x - 1.0, 1.0 - 2.0 * position.y);
#if LENS
        let lens = sampler_pair(sampler_p, GROUP_LENS);
#else
        let lens = vec2<f32>(0.5);
#endif
        let radiance = path_radiance(sampler_p, camera_ray(film_position, lens));
        pixel = film_add(pixel, radiance, sampler_p.sample_index);
    }
    pixel.closest_ray_count += path_ray_count;
#if NEE
    pixel.shadow_ray_count += direct_ray_count;
#endif
    film[index] = pixel;
}
