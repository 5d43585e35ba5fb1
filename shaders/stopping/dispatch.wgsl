// How many pixels go on, and with them the size of the path tracer's next dispatch.

struct Dispatch {
    // Workgroups, as an indirect dispatch reads them.
    x: u32,
    y: u32,
    z: u32,
    active_count: u32,
    // Samples of the longest block that one of them takes next.
    block_samples: atomic<u32>,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

@group(0) @binding(6) var<storage, read_write> dispatch: Dispatch;
