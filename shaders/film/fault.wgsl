// Faults of the running sample: each is reported, none is repaired in silence.
#import math/math

// Bit i of `fault_bits` is cause i (FAULT_NON_FINITE, FAULT_NEGATIVE, FAULT_LOOP_BOUND, FAULT_STACK).
var<private> fault_bits: u32 = 0u;

fn fault_raise(cause: u32) {
    fault_bits = fault_bits | (1u << cause);
}
