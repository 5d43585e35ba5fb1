// Closest and any hit over the tree: each lane walks by itself. A leaf of the
// top tree is an instance, whose own tree is walked in its object space.
#import geometry/slab
#import geometry/leaf
#import film/fault

// Tree nodes, two vec4 each: a child's box planes and link (src/bvh/node.rs);
// and records of instances, TREE_RECORD_SIZE vec4 each.
@group(0) @binding(2) var<storage, read> nodes: array<vec4<u32>>;

// Pending links, one column a thread. Its depth is that of the scene's trees.
var<workgroup> bvh_stack: array<u32, BVH_STACK_TOTAL>;
var<private> bvh_lane: u32;
var<private> bvh_node_count: u32;

// Not a node: nothing is left in this tree.
const LINK_DONE: u32 = 0xffffffffu;
// Not a node: back from an instance to the top tree.
const LINK_RETURN: u32 = 0xfffffffeu;

// The ray in the space of the tree that is being walked.
struct TreeRay {
    origin: vec3<f32>,
    direction: vec3<f32>,
    slab: Slab,
    instance: u32,
}

fn tree_ray_world(ray: Ray) -> TreeRay {
    let lo = bitcast<vec4<f32>>(nodes[0]);
    let scale = bitcast<vec4<f32>>(nodes[1]);
    return TreeRay(ray.origin, ray.direction, slab_new(ray.origin, ray.direction, lo.xyz, scale.xyz), INVALID);
}

#if INSTANCES
// Rows of object_from_world at 2, 3, 4 of the instance's record, behind its tree's header.
fn tree_ray_instance(ray: Ray, record: u32) -> TreeRay {
    let lo = bitcast<vec4<f32>>(nodes[record]);
    let scale = bitcast<vec4<f32>>(nodes[record + 1u]);
    let x = bitcast<vec4<f32>>(nodes[record + 2u]);
    let y = bitcast<vec4<f32>>(nodes[record + 3u]);
    let z = bitcast<vec4<f32>>(nodes[record + 4u]);
    let p = vec4<f32>(ray.origin, 1.0);
    let o = vec3<f32>(dot(x, p), dot(y, p), dot(z, p));
    let d = vec3<f32>(dot(x.xyz, ray.direction), dot(y.xyz, ray.direction), dot(z.xyz, ray.direction));
    return TreeRay(o, d, slab_new(o, d, lo.xyz, scale.xyz), record);
}
#endif

fn link_count(link: u32) -> u32 {
    return (link >> LINK_COUNT_SHIFT) & LINK_COUNT_MASK;
}

// Nearest hit in (0, ray.t_max).
fn bvh_closest_hit(ray: Ray) -> Hit {
    return bvh_walk(ray, false);
}

// Whether anything is hit in (0, ray.t_max).
fn bvh_any_hit(ray: Ray) -> bool {
    return bvh_walk(ray, true).primitive != INVALID;
}

fn bvh_push(height: u32, link: u32) -> u32 {
    if height >= BVH_STACK_SIZE {
        fault_raise(FAULT_STACK);
        return height;
    }
    bvh_stack[height * WORKGROUP_SIZE + bvh_lane] = link;
    return height + 1u;
}

fn bvh_walk(ray: Ray, any_hit: bool) -> Hit {
    var best = hit_none(ray);
    var tree = tree_ray_world(ray);
    var link = nodes[0].w;
    var height = bvh_push(0u, LINK_DONE);
    loop {
        // Down to a leaf, nearer child first.
        while (link & LINK_LEAF) == 0u {
            let left = nodes[link];
            let right = nodes[link + 1u];
            let a = slab_hit(tree.slab, left, best.t);
            let b = slab_hit(tree.slab, right, best.t);
            let hit_a = a.x <= a.y;
            let hit_b = b.x <= b.y;
            if hit_a && hit_b {
                let swap = b.x < a.x;
                height = bvh_push(height, select(right.w, left.w, swap));
                link = select(left.w, right.w, swap);
            } else if hit_a || hit_b {
                link = select(right.w, left.w, hit_a);
            } else {
                height -= 1u;
                link = bvh_stack[height * WORKGROUP_SIZE + bvh_lane];
            }
        }
        if link == LINK_DONE {
            break;
        }
        let first = link & LINK_FIRST_MASK;
#if INSTANCES
        if link == LINK_RETURN {
            tree = tree_ray_world(ray);
            height -= 1u;
            link = bvh_stack[height * WORKGROUP_SIZE + bvh_lane];
            continue;
        }
        if (link & LINK_KIND_MASK) == LINK_KIND_INSTANCE && link_count(link) > 0u {
            height = bvh_push(height, LINK_RETURN);
            tree = tree_ray_instance(ray, first * TREE_RECORD_SIZE);
            link = nodes[tree.instance].w;
            continue;
        }
#endif
        let end = first + link_count(link);
        for (var i = first; i < end; i++) {
#if TRIANGLES
            if (link & LINK_KIND_MASK) == LINK_KIND_TRIANGLE {
                best = leaf_triangle(ray, tree.origin, tree.direction, i, tree.instance, best);
            }
#endif
#if SPHERES
            if (link & LINK_KIND_MASK) == LINK_KIND_SPHERE {
                best = leaf_sphere(ray, i, best);
            }
#endif
        }
        if any_hit && best.primitive != INVALID {
            return best;
        }
        height -= 1u;
        link = bvh_stack[height * WORKGROUP_SIZE + bvh_lane];
    }
    // A driver that ends loops early leaves entries behind.
    if height != 0u {
        fault_raise(FAULT_LOOP_BOUND);
    }
    return best;
}
