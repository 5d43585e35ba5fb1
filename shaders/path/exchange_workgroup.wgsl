// Between the eight threads that trace the pixels of a block of 4 by 2: neighbours in a workgroup.
// All threads of the workgroup must come here together.
#import generated

var<workgroup> exchanged: array<vec4<f32>, WORKGROUP_SIZE>;
var<private> exchange_thread: u32;

// What the thread `ahead` of this one, counted round, has.
fn exchange(v: vec4<f32>, ahead: u32) -> vec4<f32> {
    workgroupBarrier();
    exchanged[exchange_thread] = v;
    workgroupBarrier();
    return exchanged[(exchange_thread & ~7u) | ((exchange_thread + ahead) & 7u)];
}

// Whether any thread that takes part in `exchange` may have `b`.
fn reuse_any(b: bool) -> bool {
    return true;
}
