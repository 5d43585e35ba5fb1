// Faults of the running sample: each is reported, none is repaired in silence.
#import math/math

// Bit i of `fault_bits` is cause i (FAULT_NON_FINITE, FAULT_NEGATIVE, FAULT_LOOP_BOUND, FAULT_STACK).
var<private> fault_bits: u32 = 0u;
// Where along the path the first one came up: the bounce, and the material last met.
var<private> fault_bounce: u32 = INVALID;
var<private> fault_material: u32 = INVALID;

fn fault_raise(cause: u32) {
    fault_bits = fault_bits | (1u << cause);
}

// Raises what is wrong with a sample's radiance.
fn fault_check(radiance: vec3<f32>) {
    if !is_finite(radiance) {
        fault_raise(FAULT_NON_FINITE);
    } else if any(radiance < vec3<f32>(0.0)) {
        fault_raise(FAULT_NEGATIVE);
    }
}

// After each vertex of a path: remembers the first at which there is a fault.
fn fault_watch(radiance: vec3<f32>, bounce: u32, material: u32) {
    if fault_bounce != INVALID {
        return;
    }
    fault_check(radiance);
    if fault_bits != 0u {
        fault_bounce = bounce;
        fault_material = material;
    }
}
