// What camera rays meet first: sums over the rays of a pixel's samples, which are those of its
// paths, and what the ray through the pixel's centre meets. One thread for each pixel.
#import frame/frame
#import film/tile
#import camera/camera
#import geometry/trace
#import material/material
#if TEXTURES
#import material/normal_map
#endif
#if SOBOL
#import sample/sampler_sobol
#else
#import sample/sampler_independent
#endif
#if VISIT_COUNTS
#import geometry/visits
#endif

struct FirstHit {
    // Sums over the rays that hit. Unit normals on the viewer's side.
    shading_normal: vec3<f32>,
    // Distances along the rays, metres.
    depth: f32,
    geometric_normal: vec3<f32>,
    hit_count: u32,
    // Base colours, linear.
    albedo: vec3<f32>,
    ray_count: u32,
    // World space, metres.
    position: vec3<f32>,
    // Distances along the camera's axis, metres.
    axial_depth: f32,
    // Set 0.
    uv: vec2<f32>,
    // Of the centre's ray: the material, or INVALID; what its walk cost.
    material: u32,
    node_visits: u32,
    primitive_visits: u32,
    // Bit i: a ray met fault i.
    faults: u32,
    // Of the centre's ray: the primitive's index in scene order, or INVALID, and `Hit.instance`.
    source: u32,
    instance: u32,
    // Its barycentric weights of the second and third vertex, and the distance along it, metres.
    weights: vec2<f32>,
    centre_depth: f32,
    padding_0: u32,
}

@group(0) @binding(1) var<storage, read_write> first_hits: array<FirstHit>;

#if RAY_IDS
// `frame.sample_limit` for each pixel: of every ray the primitive's index in scene order, or
// INVALID, and `Hit.instance`.
@group(0) @binding(14) var<storage, read_write> ray_ids: array<vec2<u32>>;
#endif

// The ray through a place of the picture, counted in pixels from its upper left corner.
fn first_hit_ray(place: vec2<f32>, lens: vec2<f32>) -> Ray {
    let position = place / vec2<f32>(frame.resolution);
    return camera_ray(vec2<f32>(2.0 * position.x - 1.0, 1.0 - 2.0 * position.y), lens);
}

fn first_hit_add(sum: FirstHit, ray: Ray, hit: Hit) -> FirstHit {
    var p = sum;
    p.ray_count += 1u;
    if hit.primitive == INVALID {
        return p;
    }
    var s = surface_at(ray, hit);
    let m = materials[s.material];
#if TEXTURES
    s.ns = normal_map_ns(m, s);
#endif
    s.ns = surface_bend(s.ns, s.ng, s.wo);
    p.hit_count += 1u;
    p.shading_normal += s.ns;
    p.geometric_normal += s.ng;
    p.depth += hit.t;
    p.position += s.position;
    p.axial_depth -= hit.t * dot(ray.direction, frame.camera.back);
    p.albedo += material_base(m, s);
    p.uv += s.uv.xy;
    return p;
}

// Leaves what its ray meets in `p`.
fn first_hit_centre(sum: FirstHit, ray: Ray, is_active: bool) -> FirstHit {
    var p = sum;
    let hit = trace_closest(ray, is_active);
    p.material = INVALID;
    p.source = INVALID;
    p.instance = hit.instance;
    p.weights = vec2<f32>(hit.u, hit.v);
    p.centre_depth = hit.t;
    if hit.primitive != INVALID {
        let met = primitive_load(hit.primitive);
        p.material = primitive_material(met);
        p.source = primitive_source(met);
    }
#if VISIT_COUNTS
    p.node_visits = visit_nodes;
    p.primitive_visits = visit_primitives;
#endif
    return p;
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
#if CULLING
    leaf_is_camera = true;
#endif
    let thread = group.x * WORKGROUP_SIZE + local;
    let in_dispatch = thread / TILE_PIXELS;
    let index = frame.dispatch_first_tile * TILE_PIXELS + thread;
    let tile = frame.region_first_tile + frame.dispatch_first_tile + in_dispatch;
    let in_window = tile_pixel(tile, thread % TILE_PIXELS);
    let is_active = in_dispatch < frame.dispatch_tile_count && all(in_window < frame.window_size);
    let at = frame.window_origin + in_window;
    var pixel = first_hits[index];
    if frame.sample_first == 0u {
        var ray = first_hit_ray(vec2<f32>(at) + 0.5, vec2<f32>(0.5));
        ray.alpha_seed = sampler_alpha_seed(Sampler(at.x | (at.y << 16u), 0u), 0u);
        pixel = first_hit_centre(pixel, ray, is_active);
    }
    for (var i = 0u; i < frame.sample_count; i++) {
        let sampler_p = Sampler(at.x | (at.y << 16u), frame.sample_first + i);
#if LENS
        let lens = sampler_pair(sampler_p, GROUP_LENS);
#else
        let lens = vec2<f32>(0.5);
#endif
        var ray = first_hit_ray(vec2<f32>(at) + sampler_pair(sampler_p, GROUP_PIXEL), lens);
        ray.alpha_seed = sampler_alpha_seed(sampler_p, 0u);
        let hit = trace_closest(ray, is_active);
        if is_active {
            pixel = first_hit_add(pixel, ray, hit);
#if RAY_IDS
            var source = INVALID;
            if hit.primitive != INVALID {
                source = primitive_source(primitive_load(hit.primitive));
            }
            let slot = index * frame.sample_limit + frame.sample_first + i;
            ray_ids[slot] = vec2<u32>(source, hit.instance);
#endif
        }
    }
    if is_active {
        pixel.faults |= fault_bits;
        first_hits[index] = pixel;
    }
}
