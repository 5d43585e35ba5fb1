// Radiance along one camera path. All threads of a subgroup come here together.
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
#if PATH_REUSE
#import path/reuse
#endif

// Rays traced by this thread.
var<private> path_ray_count: u32 = 0u;
var<private> path_shadow_ray_count: u32 = 0u;

fn path_radiance(sampler_p: Sampler, camera: Ray, is_active: bool) -> vec3<f32> {
    var p = path_new(camera, is_active);
    var material = INVALID;
#if PATH_REUSE
    var reuse: Reuse;
#endif
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
#if PATH_REUSE
        var ns: vec3<f32>;
#endif
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
#if PATH_REUSE
            ns = s.ns;
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
            break;
        }
#if PATH_REUSE
        if bounce == 0u {
            reuse = reuse_first(p, s, b, frame_s);
        }
        if bounce == 1u {
            reuse = reuse_second(reuse, p, s, b, ns);
            p = reuse_part(p, reuse);
        }
#endif
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
#if PATH_REUSE
    return radiance_shared(sampler_p, reuse, p);
#else
    return p.radiance;
#endif
}

#if PATH_REUSE
// The path's radiance, where what its second vertex sends out, p.radiance, is weighed with what
// those of the other lanes do. They all have walked their paths to the end.
fn radiance_shared(sampler_p: Sampler, parted: Reuse, p: Path) -> vec3<f32> {
    var r = parted;
    let own = p.radiance;
    if !r.can_give {
        r.head = own;
    }
    r.can_give = r.can_give && max_component(own) > 0.0;
    if !reuse_any(r.can_give) {
        return r.head;
    }
    // The sum of all lanes' densities of finding this lane's y, and which lanes' y this one sees.
    let own_pdf = r.pdf * reuse_projection(r.x.position, r.y);
    var density = own_pdf;
    var is_seen = 0u;
    for (var ahead = 1u; ahead < REUSE_LANES; ahead++) {
        let y = reuse_vertex(r, ahead);
        var c = connection_none();
        if r.can_take && y.is_given {
            c = reuse_connect(r, y);
            c.ray.alpha_seed = sampler_alpha_seed(sampler_p, REUSE_ALPHA + ahead);
        }
        path_shadow_ray_count += select(0u, 1u, c.pdf > 0.0);
        let is_blocked = trace_any(c.ray, c.pdf > 0.0);
        let pdf = select(c.pdf, 0.0, is_blocked);
        is_seen |= select(0u, 1u << ahead, pdf > 0.0);
        density += exchange(vec4<f32>(pdf), REUSE_LANES - ahead).x;
    }
    var radiance = r.head;
    if r.can_give {
        radiance += r.throughput * own * (own_pdf / density);
    }
    for (var ahead = 1u; ahead < REUSE_LANES; ahead++) {
        let y = reuse_vertex(r, ahead);
        let sent = exchange(vec4<f32>(own, density), ahead);
        if (is_seen & (1u << ahead)) != 0u {
            radiance += reuse_connect(r, y).value * sent.xyz / sent.w;
        }
    }
    return radiance;
}
#endif
