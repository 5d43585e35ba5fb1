// A path between two rays, and what happens to it at a surface or on leaving the scene.
#import frame/frame
#import film/fault
#import geometry/surface
#import material/material
#import bsdf/scatter
#if MIS
#import strategy/mis
#endif
#if LIGHT_ONLY
#import strategy/light
#endif
#if SCATTER_ONLY
#import strategy/scatter
#endif
#if LIGHT_SURFACES
#import light/light
#endif
#if ENVIRONMENT
#import light/environment
#endif
#if MEDIA
#import path/media
#endif

// Roulette begins at this bounce. A path that keeps the share a of its light goes on with probability
// sqrt(2 a), and never with a smaller one than this: both the light that it may still bring and what is
// lost with it grow with a, so that the best probability grows with its root (docs/kernels.md). One that has
// lost less than half goes on: were it ended by chance, the weight of those that survive, and the
// variance with it, would grow without bound where the albedo is near 1.
// So after roulette no path weighs more than 1, or than its samples weighed.
const ROULETTE_START: u32 = 3u;
const ROULETTE_LEAST: f32 = 0.1;
#if ROULETTE
#if DELTA
// That would go on for ever where light is caught, by total reflection round the inside of a ball:
// of 4.1e7 samples of cornell-spheres five had more than 64 bounces, and none of these came out
// before PATH_LENGTH_LIMIT. After so many reflections and refractions in a row a path goes on with this
// probability, whatever it has lost: 3e-7 reach the limit. Light that does come out late
// keeps its mean; its paths weigh e times as much, and their variance is as much greater, every
// 256 bounces.
const DELTA_RUN: u32 = 256u;
const DELTA_SURVIVAL: f32 = 1.0 - 1.0 / 256.0;
#endif
#endif

struct Path {
    ray: Ray,
    is_alive: bool,
    throughput: vec3<f32>,
    radiance: vec3<f32>,
    // Density of the direction that the ray took, for the weight of emission it meets.
    scatter_pdf: f32,
    // Where it left the last surface.
    scatter_point: vec3<f32>,
    // How refraction scaled the throughput: no loss, so roulette ignores it.
    eta_scale: f32,
#if PATH_REUSE
    // Largest component of the throughput up to where that began anew.
    prefix: f32,
#endif
#if MEDIA
    // The volumes that it is in.
    media: vec4<u32>,
#endif
#if DISPERSION
    // The channel that it carries alone, or INVALID.
    channel: u32,
#endif
#if ROULETTE
#if DELTA
    // Scatterings without a density in a row, up to here.
    delta_run: u32,
#endif
#endif
}

fn path_new(ray: Ray, is_active: bool) -> Path {
    var p: Path;
    p.ray = ray;
    p.is_alive = is_active;
    p.throughput = vec3<f32>(1.0);
    p.scatter_pdf = PDF_DELTA;
    p.scatter_point = ray.origin;
    p.eta_scale = 1.0;
#if PATH_REUSE
    p.prefix = 1.0;
#endif
#if MEDIA
    p.media = media_none();
#endif
#if DISPERSION
    p.channel = INVALID;
#endif
    return p;
}

#if DISPERSION
// At a surface that refracts the channels differently the path goes on with one of the three,
// chosen by u, and carries three times its light.
fn path_choose_channel(path: Path, m: Material, u: f32) -> Path {
    var p = path;
    if p.channel == INVALID && m.dispersion > 0.0 && (m.flags & MATERIAL_VOLUME) != 0u && m.transmission > 0.0 {
        p.channel = min(u32(3.0 * u), 2u);
        p.throughput *= 3.0 * vec3<f32>(vec3<u32>(p.channel) == vec3<u32>(0u, 1u, 2u));
    }
    return p;
}
#endif

// Whether light that was scattered `bounce` times belongs to the picture.
fn path_keeps(bounce: u32) -> bool {
    return frame.only_bounce == INVALID || frame.only_bounce == bounce;
}

#if ENVIRONMENT
fn path_environment(p: Path) -> vec3<f32> {
    let d = p.ray.direction;
    let w = strategy_emission_weight(p.scatter_pdf, environment_pdf(d));
    return p.throughput * environment_emitted(d) * w;
}
#endif

#if LIGHT_SURFACES
fn path_emission(p: Path, m: Material, s: Surface) -> vec3<f32> {
    let w = strategy_emission_weight(p.scatter_pdf, light_surface_pdf(s, p.scatter_point, p.ray.direction));
    return p.throughput * material_emitted(m, s) * w;
}
#endif

// The relative index at the surface: of the side of wo over that of the other side.
fn path_eta(p: Path, m: Material, s: Surface) -> f32 {
    var channel = INVALID;
#if DISPERSION
    channel = p.channel;
#endif
    var around = 1.0;
#if MEDIA
    let outside = media_outside(p.media, s);
    if outside != INVALID {
        around = material_ior(materials[outside], channel);
    }
#endif
    return material_eta(m, s, channel, around);
}

// Draws the next direction; the path ends where there is none.
fn path_scatter(path: Path, s: Surface, b: Bsdf, frame_s: mat3x3<f32>, u: vec2<f32>, roulette: f32, bounce: u32) -> Path {
    var p = path;
    let scattered = bsdf_sample(b, s.wo * frame_s, u, roulette);
    let wi = frame_s * scattered.wi;
    // A shading normal can send light through the true surface, or the reverse: such a path ends.
    let crosses = (scattered.wi.z < 0.0) != (dot(wi, s.ng) < 0.0);
    p.is_alive = scattered.pdf != 0.0 && !crosses;
    p.throughput *= scattered.weight;
    p.eta_scale *= scattered.eta_scale;
    p.scatter_pdf = scattered.pdf;
    p.scatter_point = s.position;
    p.ray = ray_new(ray_spawn(s.position, s.ng, s.offset, wi), wi);
#if MEDIA
    if scattered.wi.z < 0.0 {
        p.media = media_beyond(p.media, s);
    }
#endif
#if ROULETTE
    if bounce + 1u >= ROULETTE_START {
        var kept = max_component(p.throughput) / p.eta_scale;
#if PATH_REUSE
        kept *= p.prefix;
#endif
        var q = clamp(sqrt(2.0 * kept), ROULETTE_LEAST, 1.0);
#if DELTA
        p.delta_run = select(0u, p.delta_run + 1u, scattered.pdf == PDF_DELTA);
        q = select(q, min(q, DELTA_SURVIVAL), p.delta_run > DELTA_RUN);
#endif
        p.is_alive = p.is_alive && scattered.choice < q;
        p.throughput /= q;
    }
#endif
    return p;
}
