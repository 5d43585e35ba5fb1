//! Layers that camera rays tell of.

use super::LayerKind;
use super::cryptomatte::Cryptomatte;
use super::motion::Motion;
use crate::Result;
use crate::gpu::{Device, GpuFirstHit, Objects};
use crate::image::{Attribute, ChannelData, Layer};
use crate::passes::{Extras, FirstHits, RayId, Tuning};
use crate::renderer::PreparedScene;
use crate::scene::Scene;
use crate::settings::{Crop, RenderSettings};
use crate::shader::generated::{INVALID, TILE_SIDE};
use std::sync::Arc;

/// Pixels that are traced, and told apart ray by ray, at a time.
const PIXELS: u32 = 1 << 18;

/// Traces camera rays for layers of a picture: those that the render's first samples begin with.
pub struct LayerTracer {
    device: Arc<Device>,
    hits: FirstHits,
    objects: Objects,
    kinds: Vec<LayerKind>,
    rays: u32,
    mattes: Vec<(LayerKind, Cryptomatte)>,
    motion: Option<Motion>,
    faulty_pixels: usize,
}

impl LayerTracer {
    /// Compiles what `kinds` need. `scene` is the one that `prepared` was made from, but for its
    /// cameras; `rays`: of each pixel.
    ///
    /// # Errors
    /// [`crate::Error::Settings`], [`crate::Error::Limit`], [`crate::Error::DeviceLost`],
    /// [`crate::Error::Shader`].
    pub fn new(
        prepared: &PreparedScene,
        scene: &Scene,
        settings: &RenderSettings,
        kinds: &[LayerKind],
        rays: u32,
        tuning: &Tuning,
    ) -> Result<Self> {
        let kinds: Vec<_> = kinds.iter().copied().filter(|kind| kind.is_traced()).collect();
        let objects = scene.instances.iter().map(|i| &i.name[..]);
        let objects = objects.chain(scene.spheres.iter().map(|s| &s.name[..]));
        let materials = scene.materials.iter().map(|m| &m.name[..]);
        let mut mattes = Vec::new();
        if kinds.contains(&LayerKind::CryptoObject) {
            mattes.push((LayerKind::CryptoObject, Cryptomatte::new("CryptoObject", objects)));
        }
        if kinds.contains(&LayerKind::CryptoMaterial) {
            mattes.push((LayerKind::CryptoMaterial, Cryptomatte::new("CryptoMaterial", materials)));
        }
        let window = settings.window();
        let band = Crop { height: rows_at_once(window).min(window.height), ..window };
        let settings = &RenderSettings { crop: Some(band), ..settings.clone() };
        let extras = Extras { visits: false, ray_ids: if mattes.is_empty() { 0 } else { rays } };
        Ok(Self {
            device: prepared.device().clone(),
            hits: prepared.first_hits(scene, settings, extras, tuning)?,
            objects: Objects::new(scene, settings.accel),
            kinds,
            rays,
            mattes,
            motion: None,
            faulty_pixels: 0,
        })
    }

    /// With [`LayerKind::Motion`] since the time of `before`: the same file at that time. `scene` and
    /// `settings` are those of [`Self::new`].
    ///
    /// # Errors
    /// [`crate::Error::Settings`] where it has other objects then.
    pub fn with_motion(
        mut self,
        scene: &Scene,
        before: Scene,
        settings: &RenderSettings,
    ) -> Result<Self> {
        self.motion = Some(Motion::new(scene, before, settings)?);
        Ok(self)
    }

    /// The layers of a part of the picture, whatever parts there were before: the same bits.
    ///
    /// # Errors
    /// [`crate::Error::DeviceLost`].
    pub fn trace(&mut self, window: Crop) -> Result<Vec<Layer>> {
        let mut layers: Vec<_> = self.kinds.iter().filter_map(|kind| empty(*kind)).collect();
        let rows = rows_at_once(window);
        for first in (0..window.height).step_by(rows as usize) {
            let height = rows.min(window.height - first);
            self.hits.move_to(Crop { y: window.y + first, height, ..window });
            self.hits.run(&self.device, self.rays)?;
            self.faulty_pixels += self.hits.hits().iter().filter(|hit| hit.faults != 0).count();
            let plain = self.kinds.iter().filter(|kind| empty(**kind).is_some());
            for (kind, layer) in plain.zip(&mut layers) {
                fill(*kind, layer, self.hits.hits(), &self.objects);
            }
            self.add_to_mattes();
            if let Some(motion) = &self.motion
                && let Some(layer) = layers.iter_mut().find(|layer| layer.name == "motion")
            {
                let origin = (window.x, window.y + first);
                add_motion(motion, layer, origin, window.width, self.hits.hits(), &self.objects);
            }
        }
        layers.extend(self.mattes.iter_mut().flat_map(|(_, matte)| matte.take_layers()));
        Ok(layers)
    }

    /// Attributes of a file with the layers.
    pub fn metadata(&self) -> Vec<(String, Attribute)> {
        self.mattes.iter().flat_map(|(_, matte)| matte.metadata()).collect()
    }

    /// Pixels so far of which a ray's walk has failed.
    pub fn faulty_pixels(&self) -> usize {
        self.faulty_pixels
    }

    fn add_to_mattes(&mut self) {
        let Self { hits, objects, mattes, rays, .. } = self;
        // Neighbouring rays mostly meet the same.
        let mut last: (RayId, Option<u32>) = ([INVALID; 2], None);
        let mut met = vec![None; *rays as usize];
        for ids in hits.ray_ids().chunks_exact(*rays as usize) {
            for (object, id) in met.iter_mut().zip(ids) {
                if *id != last.0 {
                    last = (*id, objects.find(id[0], id[1]));
                }
                *object = last.1;
            }
            for (kind, matte) in mattes.iter_mut() {
                match kind {
                    LayerKind::CryptoObject => matte.add(met.iter().copied()),
                    _ => matte.add(met.iter().map(|o| o.map(|o| objects.material(o)))),
                }
            }
        }
    }
}

/// Whole rows of tiles.
fn rows_at_once(window: Crop) -> u32 {
    (PIXELS / window.width).max(1).next_multiple_of(TILE_SIDE)
}

/// The layer of a kind, without values; none for a Cryptomatte.
fn empty(kind: LayerKind) -> Option<Layer> {
    let (name, channels): (_, &[&str]) = match kind {
        LayerKind::Albedo => ("albedo", &["R", "G", "B"]),
        LayerKind::ShadingNormal => ("N", &["X", "Y", "Z"]),
        LayerKind::GeometricNormal => ("Ng", &["X", "Y", "Z"]),
        LayerKind::Depth => ("", &["Z"]),
        LayerKind::Position => ("P", &["X", "Y", "Z"]),
        LayerKind::Uv => ("uv", &["U", "V"]),
        LayerKind::Coverage => ("coverage", &["A"]),
        LayerKind::Motion => ("motion", &["X", "Y"]),
        LayerKind::Id => ("id", &["object", "material"]),
        LayerKind::CryptoObject | LayerKind::CryptoMaterial | LayerKind::Variance => return None,
    };
    let data = || match kind {
        LayerKind::Id => ChannelData::U32(Vec::new()),
        _ => ChannelData::F32(Vec::new()),
    };
    let channels = channels.iter().map(|channel| ((*channel).to_owned(), data())).collect();
    Some(Layer { name: name.into(), channels })
}

/// Appends the motion of `hits`, rows of `width` pixels whose first begins at `origin`.
fn add_motion(
    motion: &Motion,
    layer: &mut Layer,
    origin: (u32, u32),
    width: u32,
    hits: &[GpuFirstHit],
    objects: &Objects,
) {
    let [(_, ChannelData::F32(x)), (_, ChannelData::F32(y))] = &mut layer.channels[..] else {
        return;
    };
    for (i, hit) in (0..).zip(hits) {
        let moved = motion.of((origin.0 + i % width, origin.1 + i / width), hit, objects);
        x.push(moved[0]);
        y.push(moved[1]);
    }
}

/// Appends the values of `hits`.
fn fill(kind: LayerKind, layer: &mut Layer, hits: &[GpuFirstHit], objects: &Objects) {
    if kind == LayerKind::Motion {
        return;
    }
    for (k, (_, data)) in layer.channels.iter_mut().enumerate() {
        match data {
            ChannelData::F32(values) => values.extend(hits.iter().map(|hit| value(kind, k, hit))),
            ChannelData::U32(values) => values.extend(hits.iter().map(|hit| {
                let object = objects.find(hit.source, hit.instance);
                let id = if k == 0 { object } else { object.map(|o| objects.material(o)) };
                id.unwrap_or(INVALID)
            })),
        }
    }
}

/// Value of channel `k`: a mean over the rays that hit.
fn value(kind: LayerKind, k: usize, hit: &GpuFirstHit) -> f32 {
    if hit.hit_count == 0 {
        return if kind == LayerKind::Depth { f32::INFINITY } else { 0.0 };
    }
    let count = hit.hit_count as f32;
    match kind {
        LayerKind::Albedo => hit.albedo[k] / count,
        LayerKind::ShadingNormal => hit.shading_normal[k] / count,
        LayerKind::GeometricNormal => hit.geometric_normal[k] / count,
        LayerKind::Depth => hit.axial_depth / count,
        LayerKind::Position => hit.position[k] / count,
        LayerKind::Uv => hit.uv[k] / count,
        LayerKind::Coverage => count / hit.ray_count as f32,
        LayerKind::Id
        | LayerKind::CryptoObject
        | LayerKind::CryptoMaterial
        | LayerKind::Motion
        | LayerKind::Variance => 0.0,
    }
}
