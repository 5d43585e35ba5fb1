// Between the eight threads that trace the pixels of a block of 4 by 2: a subgroup.
#import geometry/trace_packet

// What the thread `ahead` of this one, counted round, has.
fn exchange(v: vec4<f32>, ahead: u32) -> vec4<f32> {
    return subgroupShuffle(v, (packet_lane + ahead) & 7u);
}

// Whether any thread that takes part in `exchange` has `b`.
fn reuse_any(b: bool) -> bool {
    return subgroupAny(b);
}
