// Ray against boxes whose planes are 16-bit numbers on a grid (src/bvh/node.rs).
#import math/math

// plane distance = q * scale + bias, with q the plane's grid number.
struct Slab {
    scale: vec3<f32>,
    bias_near: vec3<f32>,
    bias_far: vec3<f32>,
    // 16 where the direction is negative: moves the near plane into the low half.
    shift: vec3<u32>,
}

// Biases are widened by more than the rounding error of the distances, so that
// no box that holds a hit is passed over (src/bvh/grid_ray.rs).
fn slab_new(o: vec3<f32>, d: vec3<f32>, grid_min: vec3<f32>, grid_scale: vec3<f32>) -> Slab {
    let tiny = abs(d) < vec3<f32>(MIN_DIRECTION);
    let signed_tiny = select(vec3<f32>(-MIN_DIRECTION), vec3<f32>(MIN_DIRECTION), d >= vec3<f32>(0.0));
    let inverse = 1.0 / select(d, signed_tiny, tiny);
    let scale = grid_scale * inverse;
    let bias = (grid_min - o) * inverse;
    let error = BOX_ERROR * (abs(bias) + GRID_MAX * abs(scale));
    let shift = select(vec3<u32>(0u), vec3<u32>(16u), inverse < vec3<f32>(0.0));
    return Slab(scale, bias - error, bias + error, shift);
}

// Distances (near, far) at which the ray is inside the child's box, as the bits of
// their floats: a hit where near <= far. `child` holds (x, y, z, link), lower plane in
// the low half. Signed integers order these as floats do, since near is at least 0, and
// a far below 0 is below every near; and need no care for NaN, of which there is none.
fn slab_hit(s: Slab, child: vec4<u32>, t_max: f32) -> vec2<i32> {
    let low_half = vec3<u32>(0xffffu);
    let near_q = vec3<f32>(vec3<i32>((child.xyz >> s.shift) & low_half));
    let far_q = vec3<f32>(vec3<i32>((child.xyz >> (vec3<u32>(16u) - s.shift)) & low_half));
    let near = bitcast<vec3<i32>>(near_q * s.scale + s.bias_near);
    let far = bitcast<vec3<i32>>(far_q * s.scale + s.bias_far);
    return vec2<i32>(
        max(max(near.x, near.y), max(near.z, 0)),
        min(min(far.x, far.y), min(far.z, bitcast<i32>(t_max))),
    );
}
