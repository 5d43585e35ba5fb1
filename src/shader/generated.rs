//! `#import generated`: numbers that both languages use, written once, here.

use crate::bvh;
use std::fmt::Write;

/// Threads in a workgroup, unless an experiment says otherwise.
pub const WORKGROUP_SIZE: u32 = 64;
/// Pixels along a tile's side.
pub const TILE_SIDE: u32 = 8;
/// Pixels of a tile; each is one thread's.
pub const TILE_PIXELS: u32 = TILE_SIDE * TILE_SIDE;
/// No index.
pub const INVALID: u32 = u32::MAX;
/// In place of a density: the direction has none.
pub const PDF_DELTA: f32 = -1.0;
/// Scattering events after which a path counts as a fault; its numbers are drawn by 12 bits of them.
pub const PATH_LENGTH_LIMIT: u32 = 4096;
/// Samples of a block at most: its faults are counted in 8 bits.
pub const MOST_BLOCK_SAMPLES: u32 = 128;
/// Runs of blocks that fill a pixel's memory; then pairs of them are merged.
pub const RUNS: u32 = 16;
/// Half the width of the central 95 % of a normal distribution, in standard deviations.
pub const NORMAL_95: f32 = 1.96;
/// Threads that sum up the tiles of a picture.
const SCAN_THREADS: u32 = 64;
/// The list of active pixels is filled up to a multiple of this: the largest workgroup.
pub const LIST_PADDING: u32 = 256;
/// Rows, and columns, of a table of directional albedos.
pub const ALBEDO_TABLE_SIDE: u32 = 48;
/// Fourth root of the alpha of its first row; the last one's is 1.
pub const ALBEDO_TABLE_LEAST: f32 = 0.177_827_94;
/// Materials, and lights, that a uniform buffer holds: at most 64 KiB of them.
pub const MATERIAL_SLOTS: u32 = 256;
/// See [`MATERIAL_SLOTS`].
pub const LIGHT_SLOTS: u32 = 512;
/// `vec4`s of an instance's record in the node buffer.
pub const TREE_RECORD_SIZE: u32 = 8;

/// Bit of a primitive's material word: its alpha must be tested.
pub const PRIMITIVE_HAS_ALPHA: u32 = 1 << 31;

/// Bit of a primitive's material word: camera rays pass through its back.
pub const PRIMITIVE_IS_CULLED: u32 = 1 << 30;

/// No more lights than this are chosen by power, and by the number that also places the sample.
pub const FEW_LIGHTS: u32 = 4;

/// Bit of a pair of the light tree: the first slot that follows is a light; twice that, the second.
pub const LIGHT_NODE_LEAF: u32 = 1 << 30;

/// Bit of a pair of the light tree: the first's lights shine to both sides; twice that, the second's.
pub const LIGHT_NODE_BOTH_SIDES: u32 = 1 << 28;

/// The other bits of a pair's link: the first slot that follows.
pub const LIGHT_NODE_SLOTS: u32 = LIGHT_NODE_BOTH_SIDES - 1;

/// Bits of a primitive's attributes.
pub mod attribute {
    /// Shading normals.
    pub const NORMAL: u32 = 1;
    /// Texture coordinates.
    pub const UV: u32 = 2;
    /// Vertex colours.
    pub const COLOR: u32 = 4;
    /// Tangents.
    pub const TANGENT: u32 = 8;
}

/// Bits of a material.
pub mod material {
    /// Emits from both sides.
    pub const EMITS_BEHIND: u32 = 1;
    /// Encloses a volume: light refracts.
    pub const VOLUME: u32 = 2;
    /// Vertex colours multiply its emission.
    pub const UNLIT: u32 = 4;
    /// Specular colour and glossiness stand in place of metallic and roughness.
    pub const SPECULAR_GLOSSINESS: u32 = 8;
}

/// Kinds of light.
pub mod light {
    /// Emissive triangle.
    pub const TRIANGLE: u32 = 0;
    /// Emissive sphere.
    pub const SPHERE: u32 = 1;
    /// Point light.
    pub const POINT: u32 = 2;
    /// Spot light.
    pub const SPOT: u32 = 3;
    /// Directional light.
    pub const DIRECTIONAL: u32 = 4;
    /// The environment.
    pub const ENVIRONMENT: u32 = 5;
}

/// Bits of a texture.
pub mod texture {
    /// Colour channels are sRGB encoded.
    pub const SRGB: u32 = 1;
    /// Uses the second set of texture coordinates.
    pub const UV_SET: u32 = 2;
    /// No filtering.
    pub const NEAREST: u32 = 4;
    /// Where the two bits of the wrap mode along u begin.
    pub const WRAP_U_SHIFT: u32 = 4;
    /// Where the two bits of the wrap mode along v begin.
    pub const WRAP_V_SHIFT: u32 = 6;
    /// Wrap mode: repeat.
    pub const WRAP_REPEAT: u32 = 0;
    /// Wrap mode: mirrored repeat.
    pub const WRAP_MIRROR: u32 = 1;
    /// Wrap mode: clamp to edge.
    pub const WRAP_CLAMP: u32 = 2;
}

/// Why a pixel has no more samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StopReason {
    /// The render ended before the pixel did.
    Unfinished = 0,
    /// Its half-width is within the tolerance.
    Converged = 1,
    /// It has all samples that a pixel may have, and is not converged.
    Limit = 2,
}

impl StopReason {
    /// All of them, by their numbers.
    pub const ALL: [StopReason; 3] =
        [StopReason::Unfinished, StopReason::Converged, StopReason::Limit];
}

/// Causes of faults: each is an 8-bit count of samples in the film.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// A sample was not finite.
    NonFinite = 0,
    /// A sample was negative.
    Negative = 1,
    /// A loop ended before its work was done.
    LoopBound = 2,
    /// The traversal stack was full.
    Stack = 3,
}

impl Fault {
    /// All causes in the order of their counts.
    pub const ALL: [Fault; 4] = [Fault::NonFinite, Fault::Negative, Fault::LoopBound, Fault::Stack];

    /// What it means, for messages.
    pub fn description(self) -> &'static str {
        match self {
            Fault::NonFinite => "not finite",
            Fault::Negative => "negative",
            Fault::LoopBound => "cut off by a loop's bound",
            Fault::Stack => "traversal stack overflow",
        }
    }
}

/// The module's text. `stack_size`: pending links that traversal can hold.
/// `workgroup_size`: threads of a workgroup.
pub fn wgsl(stack_size: u32, workgroup_size: u32) -> String {
    let mut text = String::new();
    let unsigned = [
        ("WORKGROUP_SIZE", workgroup_size),
        ("TILE_PIXELS", TILE_PIXELS),
        ("INVALID", INVALID),
        ("PATH_LENGTH_LIMIT", PATH_LENGTH_LIMIT),
        ("TREE_RECORD_SIZE", TREE_RECORD_SIZE),
        ("BVH_STACK_SIZE", stack_size),
        ("BVH_STACK_TOTAL", stack_size * workgroup_size),
        ("LINK_LEAF", bvh::LEAF_BIT),
        ("LINK_KIND_MASK", bvh::LEAF_KIND_MASK << bvh::LEAF_KIND_SHIFT),
        ("LINK_KIND_TRIANGLE", (bvh::PrimitiveKind::Triangle as u32) << bvh::LEAF_KIND_SHIFT),
        ("LINK_KIND_SPHERE", (bvh::PrimitiveKind::Sphere as u32) << bvh::LEAF_KIND_SHIFT),
        ("LINK_KIND_INSTANCE", (bvh::PrimitiveKind::Instance as u32) << bvh::LEAF_KIND_SHIFT),
        ("LINK_COUNT_SHIFT", bvh::LEAF_COUNT_SHIFT),
        ("LINK_COUNT_MASK", bvh::LEAF_COUNT_MASK),
        ("LINK_FIRST_MASK", bvh::LEAF_FIRST_MASK),
        ("PRIMITIVE_HAS_ALPHA", PRIMITIVE_HAS_ALPHA),
        ("PRIMITIVE_IS_CULLED", PRIMITIVE_IS_CULLED),
        ("ATTRIBUTE_NORMAL", attribute::NORMAL),
        ("ATTRIBUTE_UV", attribute::UV),
        ("ATTRIBUTE_COLOR", attribute::COLOR),
        ("ATTRIBUTE_TANGENT", attribute::TANGENT),
        ("MATERIAL_EMITS_BEHIND", material::EMITS_BEHIND),
        ("MATERIAL_VOLUME", material::VOLUME),
        ("MATERIAL_UNLIT", material::UNLIT),
        ("MATERIAL_SPECULAR_GLOSSINESS", material::SPECULAR_GLOSSINESS),
        ("MATERIAL_SLOTS", MATERIAL_SLOTS),
        ("LIGHT_SLOTS", LIGHT_SLOTS),
        ("FEW_LIGHTS", FEW_LIGHTS),
        ("LIGHT_NODE_LEAF", LIGHT_NODE_LEAF),
        ("LIGHT_NODE_BOTH_SIDES", LIGHT_NODE_BOTH_SIDES),
        ("LIGHT_NODE_SLOTS", LIGHT_NODE_SLOTS),
        ("LIGHT_TRIANGLE", light::TRIANGLE),
        ("LIGHT_SPHERE", light::SPHERE),
        ("LIGHT_POINT", light::POINT),
        ("LIGHT_SPOT", light::SPOT),
        ("LIGHT_DIRECTIONAL", light::DIRECTIONAL),
        ("LIGHT_ENVIRONMENT", light::ENVIRONMENT),
        ("TEXTURE_SRGB", texture::SRGB),
        ("TEXTURE_UV_SET", texture::UV_SET),
        ("TEXTURE_NEAREST", texture::NEAREST),
        ("TEXTURE_WRAP_U_SHIFT", texture::WRAP_U_SHIFT),
        ("TEXTURE_WRAP_V_SHIFT", texture::WRAP_V_SHIFT),
        ("TEXTURE_WRAP_MIRROR", texture::WRAP_MIRROR),
        ("TEXTURE_WRAP_CLAMP", texture::WRAP_CLAMP),
        ("FAULT_NON_FINITE", Fault::NonFinite as u32),
        ("FAULT_NEGATIVE", Fault::Negative as u32),
        ("FAULT_LOOP_BOUND", Fault::LoopBound as u32),
        ("FAULT_STACK", Fault::Stack as u32),
        ("STOP_UNFINISHED", StopReason::Unfinished as u32),
        ("STOP_CONVERGED", StopReason::Converged as u32),
        ("STOP_LIMIT", StopReason::Limit as u32),
        ("RUNS", RUNS),
        ("SCAN_THREADS", SCAN_THREADS),
        ("LIST_PADDING", LIST_PADDING),
        ("ALBEDO_TABLE_SIDE", ALBEDO_TABLE_SIDE),
        ("ALBEDO_TABLE_LENGTH", 2 * ALBEDO_TABLE_SIDE * ALBEDO_TABLE_SIDE / 4),
    ];
    for (name, value) in unsigned {
        writeln!(text, "const {name}: u32 = {value}u;").unwrap();
    }
    writeln!(text, "const BOX_ERROR: f32 = {:?};", bvh::BOX_ERROR).unwrap();
    writeln!(text, "const GRID_MAX: f32 = {:?};", bvh::GRID_MAX as f32).unwrap();
    writeln!(text, "const MIN_DIRECTION: f32 = {:?};", bvh::MIN_DIRECTION).unwrap();
    writeln!(text, "const PDF_DELTA: f32 = {PDF_DELTA:?};").unwrap();
    writeln!(text, "const ALBEDO_TABLE_LEAST: f32 = {ALBEDO_TABLE_LEAST:?};").unwrap();
    writeln!(text, "const NORMAL_95: f32 = {NORMAL_95:?};").unwrap();
    writeln!(text, "const ONE_BELOW: f32 = {:?};", 1.0_f32.next_down()).unwrap();
    text.push_str(&super::sobol::wgsl());
    text
}
