// What the device makes of floating point: WGSL lets it fuse, reorder and flush, and assume
// that nothing is NaN. The operands come from a buffer, so that no compiler knows them.
#import math/math

// 1 + 2^-23, 1 - 2^-23, -1; 1e10, 1e-10; 2^24, 1; 2^-126, 1/2; NaN.
@group(0) @binding(0) var<storage, read> operands: array<f32>;
@group(0) @binding(1) var<storage, read_write> results: array<f32>;

// The rounding error of a sum (Knuth's TwoSum); 0 where a compiler takes it for algebra.
fn two_sum_error(a: f32, b: f32) -> f32 {
    let s = a + b;
    let v = s - a;
    return (a - (s - v)) + (b - v);
}

// Kahan's sum of `first` and a hundred times `other`, less `first`.
fn kahan_sum(first: f32, other: f32) -> f32 {
    var sum = first;
    var lost = 0.0;
    for (var i = 0u; i < 100u; i++) {
        let y = other - lost;
        let t = sum + y;
        lost = (t - sum) - y;
        sum = t;
    }
    return sum - first;
}

@compute @workgroup_size(1)
fn main() {
    results[0] = fma(operands[0], operands[1], operands[2]);
    results[1] = operands[0] * operands[1] + operands[2];
    results[2] = two_sum_error(operands[3], operands[4]);
    results[3] = kahan_sum(operands[5], operands[6]);
    results[4] = operands[7] * operands[8];
    results[5] = select(0.0, 1.0, operands[9] != operands[9]);
}
