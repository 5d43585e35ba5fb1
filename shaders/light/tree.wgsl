// Lights with a place, chosen by what they may give to a receiver: a walk down a tree of their
// bounds (A. Conty Estevez and C. Kulla 2018, "Importance sampling of many lights with adaptive
// tree splitting"; Pharr, Jakob and Humphreys, 4th ed., section 12.6.3). By the receiver's place
// alone, so that a ray that finds a light knows its probability without the surface it came from.
#import frame/frame
#import sample/pcg

// First the least corner of the box about all lights, and one over its longest side, the unit of
// what follows. Then slots of two: pairs of nodes and single lights, the root's pair first. A light
// is its index. A pair is two nodes of three words (x and y of the centre; z, and the radius as a
// half; octahedral axis, half-angle's sine of the cone that holds the normals, cosine of the angle to
// them that light leaves under), the upper halves of two intensities, and the first of the two
// slots that follow with the flags of both. Then the ways to the lights: bit k says which of the pair on
// level k. All small, because lanes that part load word by word.
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

// Where a place is in the tree's unit.
fn light_tree_place(from_point: vec3<f32>) -> vec3<f32> {
    let unit = bitcast<vec4<f32>>(light_tree[0]);
    return (from_point - unit.xyz) * unit.w;
}

// As light_tree/mod.rs folds it.
fn light_tree_axis(e: vec2<f32>) -> vec3<f32> {
    let z = 1.0 - abs(e.x) - abs(e.y);
    let t = max(-z, 0.0);
    return normalize(vec3<f32>(e + select(vec2<f32>(t), vec2<f32>(-t), e >= vec2<f32>(0.0)), z));
}

// About the most that a node's lights give to a place: intensity, times the cosine of the least
// angle to their normals, over squared distance, which counts as the radius at least.
fn light_tree_importance(node: vec3<u32>, intensity: f32, both_sides: bool, place: vec3<f32>) -> f32 {
    let toward = place - vec3<f32>(unpack2x16unorm(node.x), unpack2x16unorm(node.y).x);
    let radius = unpack2x16float(node.y).y;
    let cone = unpack4x8snorm(node.z);
    let d2 = dot(toward, toward);
    let near = 1.0 / max(d2, radius * radius);
    let per_distance = sqrt(near);
    var cosine = clamp(dot(light_tree_axis(cone.xy), toward) * per_distance, -1.0, 1.0);
    if both_sides {
        cosine = abs(cosine);
    }
    let widest = vec2<f32>(2.0 * cone.z * sqrt((1.0 - cone.z) * (1.0 + cone.z)), 1.0 - 2.0 * cone.z * cone.z);
    let seen = light_tree_less(light_tree_angle(cosine), widest);
    // The angle under which the sphere about them is seen.
    let sine = min(radius * per_distance, 1.0);
    let ball = vec2<f32>(sine, sqrt((1.0 - sine) * (1.0 + sine)));
    let least = select(light_tree_less(seen, ball).y, 1.0, d2 <= radius * radius);
    return select(0.0, intensity * max(least, LIGHT_TREE_COSINE) * near, least > cone.w);
}

struct LightPair {
    // Probability of the first.
    first: f32,
    // The slots that follow, and flags.
    link: u32,
}

// Behind both, by intensity: someone must be chosen.
fn light_tree_pair(slot: u32, place: vec3<f32>) -> LightPair {
    let x = light_tree[2u * slot + 1u];
    let y = light_tree[2u * slot + 2u];
    let intensity = bitcast<vec2<f32>>(vec2<u32>(y.z & 0xffff0000u, y.z << 16u));
    var a = light_tree_importance(x.xyz, intensity.x, (y.w & LIGHT_NODE_BOTH_SIDES) != 0u, place);
    let second = vec3<u32>(x.w, y.xy);
    var b = light_tree_importance(second, intensity.y, (y.w & (2u * LIGHT_NODE_BOTH_SIDES)) != 0u, place);
    if !(a + b > 0.0) {
        a = intensity.x;
        b = intensity.y;
    }
    let share = a / (a + b);
    let safe = clamp(share, LIGHT_TREE_LEAST, 1.0 - LIGHT_TREE_LEAST);
    return LightPair(select(share, safe, a > 0.0 && b > 0.0), y.w);
}

fn light_tree_is_light(link: u32, is_first: bool) -> bool {
    return (link & select(2u * LIGHT_NODE_LEAF, LIGHT_NODE_LEAF, is_first)) != 0u;
}

// One light of the tree. `choice` and `fresh` are uniform; the latter may come from a hash.
fn light_tree_choose(from_point: vec3<f32>, choice: f32, fresh: f32) -> LightChoice {
    let place = light_tree_place(from_point);
    var pmf = frame.finite_light_share;
    var x = choice;
    var is_fresh = false;
    var slot = 0u;
    for (var level = 0u; level < LIGHT_TREE_DEPTH; level++) {
        let pair = light_tree_pair(slot, place);
        let is_first = x < pair.first;
        let share = select(1.0 - pair.first, pair.first, is_first);
        x = min(select((x - pair.first) / share, x / share, is_first), ONE_BELOW);
        pmf *= share;
        if pmf < LIGHT_TREE_FRESH && !is_fresh {
            is_fresh = true;
            x = fresh;
        }
        slot = (pair.link & LIGHT_NODE_SLOTS) + select(1u, 0u, is_first);
        if light_tree_is_light(pair.link, is_first) {
            return LightChoice(light_tree[2u * slot + 1u].x, pmf);
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
    let place = light_tree_place(from_point);
    var pmf = frame.finite_light_share;
    var slot = 0u;
    for (var level = 0u; level < LIGHT_TREE_DEPTH; level++) {
        let pair = light_tree_pair(slot, place);
        let is_first = ((way >> level) & 1u) == 0u;
        pmf *= select(1.0 - pair.first, pair.first, is_first);
        slot = (pair.link & LIGHT_NODE_SLOTS) + select(1u, 0u, is_first);
        if light_tree_is_light(pair.link, is_first) {
            return pmf;
        }
    }
    return 0.0;
}
