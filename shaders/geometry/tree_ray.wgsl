// A ray in the space of one tree, with what its box and triangle tests share.
#import geometry/slab
#import geometry/ray
#import geometry/nodes
#import geometry/shear

struct TreeRay {
    origin: vec3<f32>,
    direction: vec3<f32>,
    slab: Slab,
    shear: Shear,
    // The instance's record, or INVALID in world space.
    instance: u32,
}

fn tree_ray_new(o: vec3<f32>, d: vec3<f32>, record: u32, instance: u32) -> TreeRay {
    let low = bitcast<vec4<f32>>(node_word(record));
    let scale = bitcast<vec4<f32>>(node_word(record + 1u));
    return TreeRay(o, d, slab_new(o, d, low.xyz, scale.xyz), shear_new(d), instance);
}

fn tree_ray_world(ray: Ray) -> TreeRay {
    return tree_ray_new(ray.origin, ray.direction, 0u, INVALID);
}

#if INSTANCES
fn tree_ray_instance(ray: Ray, record: u32) -> TreeRay {
    let x = bitcast<vec4<f32>>(node_word(record + 2u));
    let y = bitcast<vec4<f32>>(node_word(record + 3u));
    let z = bitcast<vec4<f32>>(node_word(record + 4u));
    let p = vec4<f32>(ray.origin, 1.0);
    let o = vec3<f32>(dot(x, p), dot(y, p), dot(z, p));
    let d = vec3<f32>(dot(x.xyz, ray.direction), dot(y.xyz, ray.direction), dot(z.xyz, ray.direction));
    return tree_ray_new(o, d, record, record);
}
#endif
