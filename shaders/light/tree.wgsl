// Lights with a place, chosen by what they may give to a receiver: a walk down a tree of their
// bounds (A. Conty Estevez and C. Kulla 2018, "Importance sampling of many lights with adaptive
// tree splitting"; Pharr, Jakob and Humphreys, 4th ed., section 12.6.3). By the receiver's place
// alone, so that a ray that finds a light knows its probability without the surface it came from.
#import frame/frame
#import sample/pcg

// Pairs, the root's first, four words of four each: of both in the pair the centre and radius; x and
// y of the axis, z and (upper half of an f32) intensity, cosines (of the cone that holds the normals,
// of the angle to them that light leaves under), link. Then the ways to the lights: bit k says which
// of the pair on level k.
@group(0) @binding(13) var<storage, read> light_tree: array<vec4<u32>>;

// Levels at most.
const LIGHT_TREE_DEPTH: u32 = 32u;
// Nothing with any share has less: a rounded share of 0 would lose its lights.
const LIGHT_TREE_LEAST: f32 = 1e-6;
// A cosine at least, of what is not behind all lights.
const LIGHT_TREE_COSINE: f32 = 1e-3;
// Below this the choice goes on with a fresh number: the rest of the old one has few bits.
const LIGHT_TREE_FRESH: f32 = 9.765625e-4;

struct LightChoice {
    index: u32,
    // 0 is none.
    pmf: f32,
}

// Sine and cosine of the angle a - b, of 0 if that is negative.
fn light_tree_less(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    let difference = vec2<f32>(a.x * b.y - a.y * b.x, a.y * b.y + a.x * b.x);
    return select(difference, vec2<f32>(0.0, 1.0), a.y >= b.y);
}

// Of an angle with this cosine.
fn light_tree_angle(cosine: f32) -> vec2<f32> {
    return vec2<f32>(sqrt(max(0.0, (1.0 - cosine) * (1.0 + cosine))), cosine);
}

fn light_tree_intensity(record: u32) -> f32 {
    return bitcast<f32>(light_tree[record + 1u].y & 0xffff0000u);
}

// About the most that the lights of a record give to a place: intensity, times the cosine of the
// least angle to their normals, over squared distance, which counts as the radius at least.
fn light_tree_importance(record: u32, from_point: vec3<f32>) -> f32 {
    let place = bitcast<vec4<f32>>(light_tree[record]);
    let shape = light_tree[record + 1u];
    let axis = vec3<f32>(unpack2x16snorm(shape.x), unpack2x16snorm(shape.y).x);
    let cosines = unpack2x16snorm(shape.z);
    let toward = from_point - place.xyz;
    let d2 = dot(toward, toward);
    let r2 = place.w * place.w;
    let near = 1.0 / max(max(d2, r2), 1e-37);
    let per_distance = sqrt(near);
    var cosine = clamp(dot(axis, toward) * per_distance, -1.0, 1.0);
    if (shape.w & LIGHT_NODE_DOUBLE_SIDED) != 0u {
        cosine = abs(cosine);
    }
    let seen = light_tree_less(light_tree_angle(cosine), light_tree_angle(cosines.x));
    // The angle under which the sphere about them is seen.
    let sine = min(place.w * per_distance, 1.0);
    let ball = vec2<f32>(sine, sqrt((1.0 - sine) * (1.0 + sine)));
    let least = select(light_tree_less(seen, ball).y, 1.0, d2 <= r2);
    let intensity = bitcast<f32>(shape.y & 0xffff0000u);
    return select(0.0, intensity * max(least, LIGHT_TREE_COSINE) * near, least > cosines.y);
}

// Probability of the first of a pair. Behind both, by intensity: someone must be chosen.
fn light_tree_first(base: u32, from_point: vec3<f32>) -> f32 {
    var a = light_tree_importance(base, from_point);
    var b = light_tree_importance(base + 2u, from_point);
    if !(a + b > 0.0) {
        a = light_tree_intensity(base);
        b = light_tree_intensity(base + 2u);
    }
    let share = a / (a + b);
    let safe = clamp(share, LIGHT_TREE_LEAST, 1.0 - LIGHT_TREE_LEAST);
    return select(share, safe, a > 0.0 && b > 0.0);
}

// One light of the tree. `choice` and `fresh` are uniform; the latter may come from a hash.
fn light_tree_choose(from_point: vec3<f32>, choice: f32, fresh: f32) -> LightChoice {
    var pmf = frame.finite_light_share;
    var x = choice;
    var is_fresh = false;
    var base = 0u;
    for (var level = 0u; level < LIGHT_TREE_DEPTH; level++) {
        let first = light_tree_first(base, from_point);
        let is_first = x < first;
        let share = select(1.0 - first, first, is_first);
        x = min(select((x - first) / share, x / share, is_first), ONE_BELOW);
        pmf *= share;
        if pmf < LIGHT_TREE_FRESH && !is_fresh {
            is_fresh = true;
            x = fresh;
        }
        let link = light_tree[base + select(3u, 1u, is_first)].w;
        base = link & ~(LIGHT_NODE_LEAF | LIGHT_NODE_DOUBLE_SIDED);
        if (link & LIGHT_NODE_LEAF) != 0u {
            return LightChoice(base, pmf);
        }
    }
    return LightChoice(0u, 0.0);
}

// Probability with which light_tree_choose gives a light: the same products in the same order.
fn light_tree_pmf(index: u32, from_point: vec3<f32>) -> f32 {
    let way = light_tree[frame.light_tree_trails + index / 4u][index % 4u];
    if way == INVALID {
        return 0.0;
    }
    var pmf = frame.finite_light_share;
    var base = 0u;
    for (var level = 0u; level < LIGHT_TREE_DEPTH; level++) {
        let first = light_tree_first(base, from_point);
        let is_first = ((way >> level) & 1u) == 0u;
        pmf *= select(1.0 - first, first, is_first);
        let link = light_tree[base + select(3u, 1u, is_first)].w;
        base = link & ~(LIGHT_NODE_LEAF | LIGHT_NODE_DOUBLE_SIDED);
        if (link & LIGHT_NODE_LEAF) != 0u {
            return pmf;
        }
    }
    return 0.0;
}
