// What light sampling can choose: one kind, one file. Densities are per solid
// angle at the receiver and include the probability of the choice.
#import geometry/surface
#import frame/frame
#if LIGHT_TRIANGLES
#import light/triangle
#endif
#if LIGHT_SPHERES
#import light/sphere
#endif
#if LIGHT_PUNCTUAL
#import light/punctual
#endif
#if ENVIRONMENT
#import light/environment
#endif
#if LIGHT_TREE
#import light/tree
#endif

// A direction from a receiver towards a light.
struct LightSample {
    // Unit.
    wi: vec3<f32>,
    // For the weights of strategies. PDF_DELTA: the light has no extent.
    pdf: f32,
    // Radiance over density; for a light without extent, its irradiance on a facing
    // surface over the probability of its choice. 0 is no sample.
    weight: vec3<f32>,
    // The point on the light, already moved off it towards the receiver; unused at infinity.
    target_point: vec3<f32>,
    is_infinite: bool,
}

struct Light {
    // LIGHT_ kind.
    kind: u32,
    // Sum of the probabilities of all lights before this one.
    cdf: f32,
    // Probability of its choice, by power; the tree's is filled in for a receiver.
    pmf: f32,
    material: u32,
    // Triangle: vertices. Sphere: centre; (radius, -, -). Point and spot:
    // position; direction of travel; (range, cos_inner, cos_outer). Directional: -; direction.
    a: vec3<f32>,
    // Emitted radiance, radiant intensity, or irradiance.
    red: f32,
    b: vec3<f32>,
    green: f32,
    c: vec3<f32>,
    blue: f32,
    // Triangle: its index in scene order.
    source: u32,
    // Both sides emit.
    is_double_sided: u32,
    // Triangle with a picture: it is light/triangle's cell of this number, of cell_side² that
    // follow each other. 0 and 1 for all others.
    cell: u32,
    cell_side: u32,
}

#if UNIFORM_LIGHTS
@group(0) @binding(6) var<uniform> lights: array<Light, LIGHT_SLOTS>;
#else
@group(0) @binding(6) var<storage, read> lights: array<Light>;
#endif

fn light_none() -> LightSample {
    return LightSample(vec3<f32>(0.0), 0.0, vec3<f32>(0.0), vec3<f32>(0.0), false);
}

fn light_color(l: Light) -> vec3<f32> {
    return vec3<f32>(l.red, l.green, l.blue);
}

// The last light whose cdf is at most u; with a tree, of those that are not in it.
fn light_pick(u: f32) -> u32 {
#if LIGHT_TREE
    var low = frame.finite_light_count;
#else
    var low = 0u;
#endif
    var high = frame.light_count;
    while high - low > 1u {
        let middle = (low + high) / 2u;
        if lights[middle].cdf <= u {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

// Probability of choosing a light at `from_point`.
fn light_pmf(index: u32, from_point: vec3<f32>) -> f32 {
#if LIGHT_TREE
    if index < frame.finite_light_count {
        return light_tree_pmf(index, from_point);
    }
#endif
    return lights[index].pmf;
}

#if LIGHT_TREE
// A light of the tree, or by power one that has no place.
fn light_choose(from_point: vec3<f32>, u: vec2<f32>, choice: f32) -> LightChoice {
    let share = frame.finite_light_share;
    if choice < share {
        let key = bitcast<vec3<u32>>(vec3<f32>(u, choice));
        let fresh = uniform_from_bits(pcg4d(vec4<u32>(key, frame.seed))).x;
        return light_tree_choose(from_point, min(choice / share, ONE_BELOW), fresh);
    }
    if frame.finite_light_count == frame.light_count {
        return LightChoice(0u, 0.0);
    }
    let index = light_pick(choice);
    return LightChoice(index, lights[index].pmf);
}
#endif

// One light and one direction towards it. `choice` picks among many lights.
fn light_sample(s: Surface, u: vec2<f32>, choice: f32) -> LightSample {
#if LIGHT_TREE
    let chosen = light_choose(s.position, u, choice);
    if chosen.pmf <= 0.0 {
        return light_none();
    }
    let index = chosen.index;
    var l = lights[index];
    l.pmf = chosen.pmf;
    let v = u;
#else
    let few = frame.light_count <= FEW_LIGHTS;
    let index = light_pick(select(choice, u.x, few));
    let l = lights[index];
    let rest = clamp((u.x - l.cdf) / l.pmf, 0.0, ONE_BELOW);
    let v = vec2<f32>(select(u.x, rest, few), u.y);
#endif
#if LIGHT_TRIANGLES
    if l.kind == LIGHT_TRIANGLE {
        return light_triangle_sample(l, index - l.cell, s, v);
    }
#endif
#if LIGHT_SPHERES
    if l.kind == LIGHT_SPHERE {
        return light_sphere_sample(l, s, v);
    }
#endif
#if LIGHT_PUNCTUAL
    if l.kind >= LIGHT_POINT && l.kind <= LIGHT_DIRECTIONAL {
        return light_punctual_sample(l, s);
    }
#endif
#if ENVIRONMENT
    if l.kind == LIGHT_ENVIRONMENT {
        return light_environment_sample(v);
    }
#endif
    return light_none();
}

// Density with which light_sample at `from_point` would have found the emitting surface `s` that a
// ray along `wi` met.
fn light_surface_pdf(s: Surface, from_point: vec3<f32>, wi: vec3<f32>) -> f32 {
    var l = lights[s.light];
#if LIGHT_TREE
    // Of a divided triangle the cell's own is looked up below.
    l.pmf = light_pmf(s.light, from_point);
#endif
#if LIGHT_SPHERES
    if l.kind == LIGHT_SPHERE {
        return light_sphere_pdf(l, s, from_point);
    }
#endif
#if LIGHT_TRIANGLES
    return light_triangle_pdf(l, s.light, from_point, wi);
#else
    return 0.0;
#endif
}
