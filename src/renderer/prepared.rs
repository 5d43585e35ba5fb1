//! A scene on a device: what stays when camera, picture and sampling change.

use super::RenderStatistics;
use crate::Result;
use crate::bvh::KeptTrees;
use crate::gpu::{Device, DeviceKind, GpuScene, SceneBuffers, TreeWidth};
use crate::passes::FloatEnvironment;
use crate::scene::Scene;
use crate::settings::{Accel, LightSelection, RenderSettings};
use crate::shader::{Feature, Features};
use std::sync::Arc;
use std::time::Instant;

/// Trees, tables and buffers of a scene, for any number of renders.
pub struct PreparedScene {
    pub(super) device: Arc<Device>,
    pub(super) buffers: GpuScene,
    pub(super) stack_size: u32,
    /// Counts and times of the preparation; the rest is empty.
    pub(super) statistics: RenderStatistics,
    accel: Accel,
    light_selection: LightSelection,
    has_packets: bool,
    has_anchors: bool,
}

impl PreparedScene {
    /// Builds trees and uploads. Of `settings` the acceleration structure, the choice of
    /// lights and the energy compensation count.
    ///
    /// # Errors
    /// [`crate::Error::Limit`], [`crate::Error::DeviceLost`].
    pub fn new(device: Arc<Device>, scene: &Scene, settings: &RenderSettings) -> Result<Self> {
        Self::with_trees(device, scene, settings, None)
    }

    /// [`PreparedScene::new`] with the trees of the frame before where they are those of this one.
    ///
    /// # Errors
    /// As [`PreparedScene::new`].
    pub fn with_trees(
        device: Arc<Device>,
        scene: &Scene,
        settings: &RenderSettings,
        kept: Option<&KeptTrees>,
    ) -> Result<Self> {
        let begin = Instant::now();
        let accel = settings.accel;
        let has_packets = device.traces_packets() && accel != Accel::None;
        let width = if has_packets { TreeWidth::Four } else { TreeWidth::Two };
        let built = SceneBuffers::build_with(scene, settings, width, kept)?;
        let bvh_seconds = begin.elapsed().as_secs_f64();
        let buffers = built.upload(&device)?;
        let world = built.world.statistics();
        let statistics = RenderStatistics {
            float_environment: Some(FloatEnvironment::of(&device)?),
            bvh_seconds,
            triangle_count: world.triangle_count,
            sphere_count: world.sphere_count,
            instance_count: world.instance_count,
            node_count: world.node_count,
            sah_cost: world.sah_cost,
            tree_depth: world.tree_depth,
            trees: world.trees,
            device_bytes: buffers.bytes(),
            ..Default::default()
        };
        Ok(Self {
            device,
            buffers,
            stack_size: built.world.stack_size.max(1),
            statistics,
            accel,
            light_selection: settings.light_selection,
            has_packets,
            has_anchors: scene.spheres.iter().any(|s| scene.anchor_of(s).is_some()),
        })
    }

    /// The same in the environment that `scene` has now; trees and materials are shared.
    ///
    /// # Errors
    /// [`crate::Error::Limit`], [`crate::Error::DeviceLost`].
    pub fn relit(&self, scene: &Scene) -> Result<Self> {
        let buffers = self.buffers.relit(&self.device, scene)?;
        let device_bytes = buffers.bytes();
        Ok(Self {
            device: self.device.clone(),
            buffers,
            statistics: RenderStatistics { device_bytes, ..self.statistics.clone() },
            ..*self
        })
    }

    /// The device that it is on.
    pub fn device(&self) -> &Arc<Device> {
        &self.device
    }

    /// Seconds that trees and tables took.
    pub fn build_seconds(&self) -> f64 {
        self.statistics.bvh_seconds
    }

    /// Whether a table is read as uniforms: on a GPU lanes that read different entries would wait for
    /// each other.
    fn reads_uniforms(&self, table: &str) -> bool {
        self.device.info().kind == DeviceKind::Cpu && self.buffers.is_uniform(table)
    }

    /// What a render needs. Spheres have the anchors that they were prepared with, wherever the
    /// camera is now, and trees are those that were built.
    pub(super) fn features(&self, scene: &Scene, settings: &RenderSettings) -> Features {
        let (accel, light_selection) = (self.accel, self.light_selection);
        let settings = RenderSettings { accel, light_selection, ..settings.clone() };
        let features = Features::of(scene, &settings)
            .with_if(Feature::Packets, self.has_packets)
            .with_if(Feature::UniformMaterials, self.reads_uniforms("materials"))
            .with_if(Feature::UniformLights, self.reads_uniforms("lights"))
            .union(self.buffers.split_features());
        match self.has_anchors || settings.all_features {
            true => features.with_if(Feature::AnchoredSpheres, self.has_anchors),
            false => features.without(Feature::AnchoredSpheres),
        }
    }
}
