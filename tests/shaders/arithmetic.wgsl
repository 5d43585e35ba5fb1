// Sums with and without compensation, and classification by bits.
#import math/math

// x, y, a runtime zero; rounds of Kahan's sum in w.
@group(0) @binding(20) var<storage, read> inputs: array<vec4<f32>>;
// Two words for each input: errors of TwoSum without and with the barrier, Kahan's sum of x
// and `rounds` times y without and with; then is_finite(x), x is NaN by comparison, and
// what clamping makes of x.
@group(0) @binding(21) var<storage, read_write> outputs: array<vec4<f32>>;

// The identity, if a compiler does not know that `zero` is zero.
fn opaque(x: f32, zero: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) ^ bitcast<u32>(zero));
}

fn two_sum_error(a: f32, b: f32, zero: f32, has_barrier: bool) -> f32 {
    let s = select(a + b, opaque(a + b, zero), has_barrier);
    if has_barrier {
        let v = opaque(s - a, zero);
        return opaque(a - opaque(s - v, zero), zero) + opaque(b - v, zero);
    }
    let v = s - a;
    return (a - (s - v)) + (b - v);
}

fn kahan(first: f32, other: f32, rounds: u32) -> f32 {
    var sum = first;
    var lost = 0.0;
    for (var i = 0u; i < rounds; i++) {
        let y = other - lost;
        let t = sum + y;
        lost = (t - sum) - y;
        sum = t;
    }
    return sum;
}

fn kahan_opaque(first: f32, other: f32, rounds: u32, zero: f32) -> f32 {
    var sum = first;
    var lost = 0.0;
    for (var i = 0u; i < rounds; i++) {
        let y = other - lost;
        let t = opaque(sum + y, zero);
        lost = opaque(t - sum, zero) - y;
        sum = t;
    }
    return sum;
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = inputs[id.x];
    let rounds = u32(i.w);
    outputs[2u * id.x] = vec4<f32>(
        two_sum_error(i.x, i.y, i.z, false),
        two_sum_error(i.x, i.y, i.z, true),
        kahan(i.x, i.y, rounds),
        kahan_opaque(i.x, i.y, rounds, i.z),
    );
    outputs[2u * id.x + 1u] = vec4<f32>(
        select(0.0, 1.0, is_finite(vec3<f32>(i.x))),
        select(0.0, 1.0, i.x != i.x),
        clamp(i.x, 0.0, 1.0),
        0.0,
    );
}
