//! glTF materials, and the textures that they use. Their extensions are in `material_extensions`.

use super::buffers::Buffers;
use super::document::Document;
use super::images::Images;
use super::members::Members;
use super::notices::Notices;
use super::textures::TextureReader;
use super::uv_sets;
use crate::Result;
use crate::scene::ColorSpace::{self, Linear, Srgb};
use crate::scene::{AlphaMode, Image, Material, TextureRef};
use glam::Vec3;
use gltf::json;
use serde_json::Value;

/// What was read.
pub(super) struct Materials {
    /// In the file's order.
    pub(super) materials: Vec<Material>,
    /// For each, the sets of texture coordinates that its meshes hold.
    pub(super) uv_sets: Vec<[u32; 2]>,
    /// The images that they use.
    pub(super) images: Vec<Image>,
}

/// Reads all materials and the images that they use; `max_texture_size` as in
/// [`LoadOptions`](super::LoadOptions).
pub(super) fn read(
    document: &Document,
    buffers: &Buffers,
    max_texture_size: Option<u32>,
    notices: &mut Notices,
) -> Result<Materials> {
    let mut images = Images::default();
    let (mut materials, mut sets) = (Vec::new(), Vec::new());
    let sources = document.raw.get("materials").and_then(Value::as_array);
    for (index, source) in sources.into_iter().flatten().enumerate() {
        let index = json::Index::new(index as u32);
        let place = document.label::<json::Material>(index);
        let source = Members::of("the material", source)
            .map_err(|message| document.error(format!("{place}: {message}")))?;
        let textures =
            TextureReader { document, buffers, images: &mut images, notices, place: &place };
        let mut reader = MaterialReader { textures };
        let mut material = reader.material(source)?;
        sets.push(reader.assign_uv_sets(&mut material));
        material.name = document.name::<json::Material>(index);
        materials.push(material);
    }
    let images = images.decode(document, max_texture_size, notices)?;
    Ok(Materials { materials, uv_sets: sets, images })
}

/// Reads one material.
pub(super) struct MaterialReader<'a, 'b> {
    textures: TextureReader<'a, 'b>,
}

impl MaterialReader<'_, '_> {
    fn material(&mut self, source: Members) -> Result<Material> {
        let extensions = self.checked(source.object("extensions"))?;
        if self.checked(extensions.optional("KHR_materials_unlit"))?.is_some() {
            return self.unlit(source, extensions);
        }
        let mut material = self.core(source)?;
        self.extensions(extensions, &mut material)?;
        Ok(material)
    }

    /// What glTF 2.0 itself defines.
    fn core(&mut self, source: Members) -> Result<Material> {
        let pbr = self.checked(source.object("pbrMetallicRoughness"))?;
        if source.has("occlusionTexture") {
            self.ignored("occlusionTexture: path tracing computes occlusion itself");
        }
        let (normal_texture, normal_scale) = self.normals(source, "normalTexture")?;
        Ok(Material {
            metallic: self.unit(pbr, "metallicFactor", 1.0)?,
            roughness: self.unit(pbr, "roughnessFactor", 1.0)?,
            metallic_roughness_texture: self.texture(pbr, "metallicRoughnessTexture", Linear)?,
            normal_texture,
            normal_scale,
            emission: self.emission(source)?,
            emission_texture: self.texture(source, "emissiveTexture", Srgb)?,
            ..self.base(source, pbr)?
        })
    }

    /// Base colour and coverage: what an unlit material has as well.
    fn base(&mut self, source: Members, pbr: Members) -> Result<Material> {
        let [red, green, blue, alpha] = self.checked(pbr.numbers("baseColorFactor", [1.0; 4]))?;
        Ok(Material {
            base_color: self.clamped_unit([red, green, blue], "baseColorFactor").into(),
            base_color_texture: self.texture(pbr, "baseColorTexture", Srgb)?,
            alpha_mode: self.alpha_mode(source)?,
            alpha: self.clamped_unit([alpha], "baseColorFactor alpha")[0],
            double_sided: self.checked(source.flag("doubleSided"))?,
            ..Material::default()
        })
    }

    fn alpha_mode(&mut self, source: Members) -> Result<AlphaMode> {
        match self.checked(source.text("alphaMode"))? {
            None | Some("OPAQUE") => Ok(AlphaMode::Opaque),
            Some("MASK") => Ok(AlphaMode::Mask(self.non_negative(source, "alphaCutoff", 0.5)?)),
            Some("BLEND") => Ok(AlphaMode::Blend),
            Some(_) => Err(self.error("unknown alphaMode")),
        }
    }

    /// KHR_materials_unlit: the base colour alone. It wins over all that scatters.
    fn unlit(&mut self, source: Members, extensions: Members) -> Result<Material> {
        for name in extensions.keys().filter(|&name| name != "KHR_materials_unlit") {
            if name.starts_with("KHR_materials_") {
                self.ignored(&format!("{name} of an unlit material"));
            }
        }
        let pbr = self.checked(source.object("pbrMetallicRoughness"))?;
        Ok(Material { unlit: true, ..self.base(source, pbr)? })
    }

    /// emissiveFactor × emissiveStrength.
    fn emission(&mut self, source: Members) -> Result<Vec3> {
        let factor = self.non_negative_color(source, "emissiveFactor", Vec3::ZERO)?;
        if factor.max_element() > 1.0 {
            self.approximated("emissiveFactor above 1 is taken as it is");
        }
        let extensions = self.checked(source.object("extensions"))?;
        let strength = self.checked(extensions.object("KHR_materials_emissive_strength"))?;
        let emission = factor * self.non_negative(strength, "emissiveStrength", 1.0)?;
        match emission.is_finite() {
            true => Ok(emission),
            false => Err(self.error("emissiveFactor × emissiveStrength is too large a number")),
        }
    }

    /// Sorts the sets of texture coordinates in use into the two that a vertex has.
    fn assign_uv_sets(&mut self, material: &mut Material) -> [u32; 2] {
        let (sets, left_out) = uv_sets::assign(material);
        if left_out {
            let message = "textures with a third set of texture coordinates: left out, \
                 a material can use two";
            self.ignored(message);
        }
        sets
    }

    /// A normal texture and its scale.
    pub(super) fn normals(
        &mut self,
        from: Members,
        key: &str,
    ) -> Result<(Option<TextureRef>, f32)> {
        let Some(slot) = self.checked(from.slot(key))? else { return Ok((None, 1.0)) };
        let scale = match slot.scale() {
            Ok(scale) => scale,
            Err(message) => return Err(self.error(&format!("{key}.scale: {message}"))),
        };
        Ok((self.textures.read(slot, Linear)?, scale))
    }

    /// The texture of a slot.
    pub(super) fn texture(
        &mut self,
        from: Members,
        key: &str,
        color_space: ColorSpace,
    ) -> Result<Option<TextureRef>> {
        match self.checked(from.slot(key))? {
            Some(slot) => self.textures.read(slot, color_space),
            None => Ok(None),
        }
    }

    /// A number brought into [0, 1].
    pub(super) fn unit(&mut self, from: Members, key: &str, default: f32) -> Result<f32> {
        let value = self.checked(from.number(key, default))?;
        Ok(self.clamped_unit([value], key)[0])
    }

    /// A colour brought into [0, 1].
    pub(super) fn unit_color(&mut self, from: Members, key: &str, default: Vec3) -> Result<Vec3> {
        let values = self.checked(from.numbers(key, default.into()))?;
        Ok(self.clamped_unit(values, key).into())
    }

    /// A number brought to 0 if it is below.
    pub(super) fn non_negative(&mut self, from: Members, key: &str, default: f32) -> Result<f32> {
        let value = self.checked(from.number(key, default))?;
        if value < 0.0 {
            self.approximated(&format!("negative {key} clamped to 0"));
        }
        Ok(value.max(0.0))
    }

    /// A colour whose components are brought to 0 where they are below.
    pub(super) fn non_negative_color(
        &mut self,
        from: Members,
        key: &str,
        default: Vec3,
    ) -> Result<Vec3> {
        let color = Vec3::from(self.checked(from.numbers(key, default.into()))?);
        if color.min_element() < 0.0 {
            self.approximated(&format!("negative {key} clamped to 0"));
        }
        Ok(color.max(Vec3::ZERO))
    }

    pub(super) fn clamped_unit<const N: usize>(
        &mut self,
        values: [f32; N],
        what: &str,
    ) -> [f32; N] {
        let clamped = values.map(|value| value.clamp(0.0, 1.0));
        if clamped != values {
            self.approximated(&format!("{what} outside [0, 1] clamped"));
        }
        clamped
    }

    /// A value, or an error that names the material.
    pub(super) fn checked<T>(&self, value: std::result::Result<T, String>) -> Result<T> {
        value.map_err(|message| self.error(&message))
    }

    fn error(&self, message: &str) -> crate::Error {
        self.textures.document.error(format!("{}: {message}", self.textures.place))
    }

    pub(super) fn approximated(&mut self, message: &str) {
        self.textures.notices.approximated(message, self.textures.place);
    }

    pub(super) fn ignored(&mut self, message: &str) {
        self.textures.notices.ignored(message, self.textures.place);
    }
}
