// Path reuse (Bekaert, Sbert and Halton 2002): the eight pixels of a block of 4 by 2 continue their
// paths from each other's second vertices. Each lane scatters from its first vertex x to a second
// vertex y and traces on from there. Where y's surface looks the same from everywhere, what it sends
// out serves the other seven lanes too: for one shadow ray each they have a sample of indirect light
// that would have cost a path.
//
// The lanes' densities of finding y are the techniques of one balance heuristic (Veach 1997), each
// with its visibility: a lane that does not see y could not have found it.
#import frame/frame
#import path/path
#if PACKETS
#import path/exchange_subgroup
#else
#import path/exchange_workgroup
#endif

// Lanes that share.
const REUSE_LANES: u32 = 8u;
// Seeds of the alpha tests along connections follow those of this bounce's segments.
const REUSE_ALPHA: u32 = 64u;

// What a lane gives to the others, and what it needs to take from them.
struct Reuse {
    // The first vertex.
    x: Surface,
    b: Bsdf,
    frame_x: mat3x3<f32>,
    // Whether the others can look from it into air.
    can_take: bool,
    // The second vertex.
    y: ReuseVertex,
    can_give: bool,
    // Density per solid angle at x of the direction to y, and the throughput at y.
    pdf: f32,
    throughput: vec3<f32>,
    // Radiance of the path before y.
    head: vec3<f32>,
}

struct ReuseVertex {
    position: vec3<f32>,
    offset: f32,
    ng: vec3<f32>,
    is_given: bool,
    ns: vec3<f32>,
}

// From a lane's x to a lane's y: densities and values are per area at y.
struct Connection {
    ray: Ray,
    // 0 where the lane could not have found y.
    pdf: f32,
    // BSDF times both cosines over the squared distance.
    value: vec3<f32>,
}

fn connection_none() -> Connection {
    return Connection(ray_new(vec3<f32>(0.0), vec3<f32>(0.0, 0.0, 1.0)), 0.0, vec3<f32>(0.0));
}

fn reuse_in_air(p: Path) -> bool {
#if MEDIA
    if p.media.x != INVALID {
        return false;
    }
#endif
#if DISPERSION
    if p.channel != INVALID {
        return false;
    }
#endif
    return true;
}

// Remembers the first vertex.
fn reuse_first(p: Path, s: Surface, b: Bsdf, frame_s: mat3x3<f32>) -> Reuse {
    var r: Reuse;
    r.x = s;
    r.b = b;
    r.frame_x = frame_s;
    r.can_take = p.is_alive && bsdf_is_smooth(b) && reuse_in_air(p);
    return r;
}

// At the second vertex, of which `ns` is the normal before it was turned to face the ray.
fn reuse_second(first: Reuse, p: Path, s: Surface, b: Bsdf, ns: vec3<f32>) -> Reuse {
    var r = first;
    let is_above = dot(p.ray.direction, r.x.ng) > 0.0;
    r.can_give = r.can_take && p.is_alive && p.scatter_pdf > 0.0 && is_above && bsdf_is_matte(b)
        && reuse_in_air(p) && all(ns == s.ns) && any(s.position != r.x.position);
    r.y = ReuseVertex(s.position, s.offset, s.ng, r.can_give, s.ns);
    r.pdf = p.scatter_pdf;
    r.throughput = p.throughput;
    r.head = p.radiance;
    return r;
}

// Squared distance to solid angle: |cos| at y over the squared distance.
fn reuse_projection(x: vec3<f32>, y: ReuseVertex) -> f32 {
    let d = y.position - x;
    let d2 = dot(d, d);
    return abs(dot(y.ng, d)) / (d2 * sqrt(d2));
}

fn reuse_connect(r: Reuse, y: ReuseVertex) -> Connection {
    let d = y.position - r.x.position;
    if all(d == vec3<f32>(0.0)) {
        return connection_none();
    }
    let w = normalize(d);
    let wi = w * r.frame_x;
    // As path_scatter and the second vertex's own lane demand.
    let is_above = wi.z > 0.0 && dot(w, r.x.ng) > 0.0;
    if !is_above || dot(y.ng, w) >= 0.0 || any(surface_bend(y.ns, y.ng, -w) != y.ns) {
        return connection_none();
    }
    let wo = r.x.wo * r.frame_x;
    let projection = reuse_projection(r.x.position, y);
    let origin = ray_spawn(r.x.position, r.x.ng, r.x.offset, w);
    let ray = Ray(origin, 1.0, ray_spawn(y.position, y.ng, y.offset, -w) - origin, 0u);
    return Connection(ray, bsdf_pdf(r.b, wo, wi) * projection, bsdf_eval(r.b, wo, wi) * projection);
}

// The y of the lane `ahead` of this one.
fn reuse_vertex(r: Reuse, ahead: u32) -> ReuseVertex {
    let position = exchange(vec4<f32>(r.y.position, r.y.offset), ahead);
    let ng = exchange(vec4<f32>(r.y.ng, select(0.0, 1.0, r.can_give)), ahead);
    let ns = exchange(vec4<f32>(r.y.ns, 0.0), ahead);
    return ReuseVertex(position.xyz, position.w, ng.xyz, ng.w > 0.0, ns.xyz);
}

// From the second vertex on, if it is shared, the path gathers what leaves this.
fn reuse_part(path: Path, r: Reuse) -> Path {
    var p = path;
    if r.can_give {
        p.radiance = vec3<f32>(0.0);
        p.prefix = max_component(p.throughput);
        p.throughput = vec3<f32>(1.0);
    }
    return p;
}
