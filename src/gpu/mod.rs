//! Everything that knows wgpu, except the passes.

mod albedos;
mod batch;
mod camera;
mod device;
mod emission;
mod environment;
mod frame;
mod light_tree;
mod lights;
mod limits;
mod materials;
mod objects;
mod pipeline;
mod readback;
mod scene;
mod split;
mod types;
mod wide;
mod world;
mod world_source;

pub use batch::{Batch, PreparedBatch};
pub use device::{Device, DeviceInfo, DeviceKind};
pub use frame::BufferFacts;
pub(crate) use limits::check_binding;
pub use objects::Objects;
pub use pipeline::{Kernel, validate};
pub use readback::Readback;
pub use scene::{GpuScene, SceneBuffers};
pub use types::{
    GpuCamera, GpuDispatch, GpuFilmPixel, GpuFirstHit, GpuFrame, GpuLight, GpuMaterial,
    GpuStopping, GpuTally, layouts,
};
pub use world::{TreeWidth, World, WorldStatistics};
