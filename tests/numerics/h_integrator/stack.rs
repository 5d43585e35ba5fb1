//! The traversal stack keeps what fits and counts what does not.

use crate::common::{Call, harness};
use steradian::shader::generated::Fault;

#[test]
fn h6_a_link_beyond_the_end_of_the_stack_is_a_fault() {
    // Batches have a stack of one link a thread.
    let heights: Vec<u32> = (0..64).map(|i| i % 2).collect();
    let outputs: Vec<[u32; 4]> = Call::new(harness!("stack"), &[]).run(&heights, 1);
    for (height, [faults, _, size, _]) in heights.into_iter().zip(outputs) {
        assert_eq!(size, 1);
        assert_eq!(faults, u32::from(height >= size) << Fault::Stack as u32, "height {height}");
    }
    // What fits is kept: every thread has a column of its own.
    let outputs: Vec<[u32; 4]> = Call::new(harness!("stack"), &[]).run(&[0_u32; 64], 1);
    for (i, [faults, link, ..]) in (0..).zip(outputs) {
        assert_eq!((faults, link), (0, 1000 + i));
    }
}
