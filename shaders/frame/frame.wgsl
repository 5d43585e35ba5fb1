// What changes between dispatches or renders without another compilation.
#import generated

struct Camera {
    position: vec3<f32>,
    // Radius of the thin lens in metres; 0 is a pinhole.
    aperture_radius: f32,
    right: vec3<f32>,
    // Distance of the plane in focus along the view axis.
    focus_distance: f32,
    up: vec3<f32>,
    // Perspective: tan(yfov / 2). Orthographic: half the height in metres.
    half_height: f32,
    // Opposite of the view direction.
    back: vec3<f32>,
    half_width: f32,
    orthographic: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

struct Frame {
    camera: Camera,
    // Rows of the rotation from world space to the environment map's.
    environment_x: vec4<f32>,
    environment_y: vec4<f32>,
    environment_z: vec4<f32>,
    environment_size: vec2<u32>,
    // Probability with which a light sample is the environment's.
    environment_pmf: f32,
    light_count: u32,
    // The whole picture, pixels.
    resolution: vec2<u32>,
    // First pixel of the rendered window within the picture.
    window_origin: vec2<u32>,
    window_size: vec2<u32>,
    // Tiles across the window.
    tiles_across: u32,
    // First tile of the region that the film buffer holds.
    region_first_tile: u32,
    // First tile of this dispatch, counted within the region.
    dispatch_first_tile: u32,
    // First sample index and number of samples of this dispatch.
    sample_first: u32,
    sample_count: u32,
    seed: u32,
    // INVALID is no limit.
    max_bounces: u32,
    // INVALID is all of them.
    only_bounce: u32,
    light_samples: u32,
    // Brute force only: how many primitives there are.
    triangle_count: u32,
    sphere_count: u32,
    // Layout of `attributes`.
    attribute_base: u32,
    attribute_stride: u32,
    // Tiles of this dispatch.
    dispatch_tile_count: u32,
    // Adaptive renders: samples of the smallest block and of the largest, and most of a pixel.
    block_unit: u32,
    largest_block: u32,
    sample_limit: u32,
    // Texels a side of a cell of the environment's sampling table.
    environment_block: u32,
    // With a light tree: how many lights are in it, which are the first, and with which
    // probability one of them is chosen; where the ways to them begin in `light_tree`.
    finite_light_count: u32,
    finite_light_share: f32,
    light_tree_trails: u32,
    // Of a light sample, where there are many lights.
    light_candidates: u32,
}

@group(0) @binding(0) var<uniform> frame: Frame;
