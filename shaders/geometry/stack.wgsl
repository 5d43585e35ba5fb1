// Pending links of a walk, one column a thread; as deep as the scene's trees need.
#import film/fault

var<workgroup> stack_links: array<u32, BVH_STACK_TOTAL>;
var<private> stack_lane: u32;

// A link beyond the end goes astray, and is counted: the host sized the stack wrongly.
fn stack_set(height: u32, link: u32) {
    fault_bits |= select(0u, 1u << FAULT_STACK, height >= BVH_STACK_SIZE);
    stack_links[height * WORKGROUP_SIZE + stack_lane] = link;
}

fn stack_get(height: u32) -> u32 {
    return stack_links[height * WORKGROUP_SIZE + stack_lane];
}

// At the end of a walk. A driver that ends loops early leaves entries behind.
fn stack_check(height: u32) {
    if height != 0u {
        fault_raise(FAULT_LOOP_BOUND);
    }
}
