//! Random changes to a JSON tree that keep it a JSON tree.

use serde_json::{Map, Value, json};

/// A source of random changes.
pub struct Edits {
    state: u64,
}

/// Numbers at the edges of types, and what a float cannot be.
const NUMBERS: [f64; 18] = [
    0.0, 1.0, -1.0, 2.0, 3.0, 255.0, 256.0, 65535.0, 65536.0, 2147483647.0, 4294967295.0,
    4294967296.0, 1e16, 1e38, 1e39, -1e308, 1e-45, 0.5,
];

/// Names that the loader knows, and a few that it does not.
const NAMES: &str = "extensions extras steradian sphere radius environment uri radiance rotation intensity \
    nodes mesh meshes children matrix translation scale camera cameras skin skins joints weights targets \
    inverseBindMatrices skeleton primitives attributes POSITION NORMAL TANGENT TEXCOORD_0 TEXCOORD_1 TEXCOORD_2 \
    COLOR_0 COLOR_1 JOINTS_0 WEIGHTS_0 _CUSTOM indices material materials mode accessors bufferView bufferViews \
    byteOffset byteLength byteStride buffer buffers count componentType type normalized sparse values min max \
    images textures samplers source sampler index texCoord mimeType wrapS wrapT magFilter minFilter \
    pbrMetallicRoughness baseColorFactor baseColorTexture metallicFactor roughnessFactor \
    metallicRoughnessTexture normalTexture occlusionTexture emissiveTexture emissiveFactor strength alphaMode \
    alphaCutoff doubleSided perspective orthographic yfov aspectRatio xmag ymag znear zfar apertureRadius \
    focusDistance animations channels input output interpolation target node path lights light spot \
    innerConeAngle outerConeAngle color range KHR_lights_punctual KHR_materials_ior ior \
    KHR_materials_specular specularFactor specularColorFactor specularTexture specularColorTexture \
    KHR_materials_transmission transmissionFactor transmissionTexture KHR_materials_volume thicknessFactor \
    attenuationDistance attenuationColor KHR_materials_emissive_strength emissiveStrength \
    KHR_texture_transform offset KHR_mesh_quantization KHR_materials_clearcoat clearcoatFactor \
    clearcoatRoughnessFactor clearcoatNormalTexture KHR_materials_sheen sheenColorFactor \
    sheenRoughnessFactor KHR_materials_iridescence iridescenceFactor iridescenceIor \
    iridescenceThicknessMinimum iridescenceThicknessMaximum KHR_materials_anisotropy anisotropyStrength \
    anisotropyRotation KHR_materials_dispersion dispersion KHR_materials_diffuse_transmission \
    diffuseTransmissionFactor diffuseTransmissionColorFactor KHR_materials_unlit KHR_materials_variants variants \
    mappings KHR_materials_pbrSpecularGlossiness diffuseFactor glossinessFactor EXT_mesh_gpu_instancing \
    TRANSLATION ROTATION SCALE KHR_node_visibility visible EXT_texture_webp KHR_texture_basisu \
    EXT_meshopt_compression KHR_meshopt_compression KHR_draco_mesh_compression filter EXT_lights_image_based \
    irradianceCoefficients specularImages specularImageSize KHR_animation_pointer pointer scene scenes asset \
    version minVersion extensionsUsed extensionsRequired name";

/// Values of members that are words.
const WORDS: &str = "SCALAR VEC2 VEC3 VEC4 MAT2 MAT3 MAT4 OPAQUE MASK BLEND perspective orthographic point spot \
    directional 2.0 2.1 image/png image/jpeg image/webp image/ktx2 LINEAR STEP CUBICSPLINE translation \
    rotation scale weights pointer ATTRIBUTES TRIANGLES INDICES NONE OCTAHEDRAL QUATERNION EXPONENTIAL \
    data:,x data:;base64,AAAA x.bin ../x";

impl Edits {
    /// The changes are a function of the seed.
    pub fn new(seed: u32) -> Self {
        Self { state: u64::from(seed).wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1 }
    }

    /// A number from 0 to below `count`, or 0 where that is 0 (xorshift64*).
    pub fn below(&mut self, count: usize) -> usize {
        self.state ^= self.state >> 12;
        self.state ^= self.state << 25;
        self.state ^= self.state >> 27;
        let word = self.state.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 32;
        (word as usize) % count.max(1)
    }

    /// True half of the time.
    pub fn toss(&mut self) -> bool {
        self.below(2) == 0
    }

    /// Changes the tree in one to four places.
    pub fn change(&mut self, root: &mut Value) {
        for _ in 0..=self.below(4) {
            let donor = self.donor(root);
            let target = self.below(count(root));
            let target = nth(root, target);
            self.change_one(target, donor);
        }
    }

    /// A copy of a part of the tree that is not large, to put elsewhere.
    fn donor(&mut self, root: &mut Value) -> Value {
        for _ in 0..4 {
            let index = self.below(count(root));
            let part = nth(root, index);
            if count(part) < 40 {
                return part.clone();
            }
        }
        Value::Null
    }

    fn change_one(&mut self, target: &mut Value, donor: Value) {
        match target {
            Value::Object(members) => match self.below(4) {
                0 => {
                    members.insert(self.name(), donor);
                }
                1 => {
                    let value = self.leaf();
                    members.insert(self.name(), value);
                }
                2 => {
                    let name = self.name();
                    members.insert(name, Value::Object(Map::new()));
                }
                _ => {
                    let index = self.below(members.len());
                    let name = members.keys().nth(index).cloned();
                    if let Some(value) = name.and_then(|name| members.remove(&name))
                        && self.toss()
                    {
                        members.insert(self.name(), value);
                    }
                }
            },
            Value::Array(items) => match self.below(4) {
                0 if !items.is_empty() => {
                    items.remove(self.below(items.len()));
                }
                1 if !items.is_empty() && items.len() < 64 => {
                    let item = items[self.below(items.len())].clone();
                    items.push(item);
                }
                2 => items.push(self.leaf()),
                _ => items.push(donor),
            },
            leaf if self.below(3) == 0 => *leaf = donor,
            leaf => *leaf = self.leaf(),
        }
    }

    fn leaf(&mut self) -> Value {
        match self.below(8) {
            0 => json!(self.toss()),
            1 => json!(self.word(WORDS)),
            2 => json!(NUMBERS[self.below(NUMBERS.len())]),
            3 => json!([5120, 5121, 5122, 5123, 5125, 5126, 9728, 33071][self.below(8)]),
            4 => (0..self.below(17)).map(|_| json!(self.below(3) as f64 * 0.5)).collect(),
            5 => json!(self.below(100)),
            _ => json!(self.below(6)),
        }
    }

    fn name(&mut self) -> String {
        self.word(NAMES)
    }

    fn word(&mut self, list: &str) -> String {
        let index = self.below(list.split_whitespace().count());
        list.split_whitespace().nth(index).unwrap_or_default().to_owned()
    }
}

/// Number of values in a tree.
fn count(value: &Value) -> usize {
    1 + match value {
        Value::Array(items) => items.iter().map(count).sum(),
        Value::Object(members) => members.values().map(count).sum::<usize>(),
        _ => 0,
    }
}

/// The value of this number in a tree; its own number is 0.
fn nth(value: &mut Value, mut index: usize) -> &mut Value {
    if index == 0 {
        return value;
    }
    index -= 1;
    let children: Vec<&mut Value> = match value {
        Value::Array(items) => items.iter_mut().collect(),
        Value::Object(members) => members.values_mut().collect(),
        _ => unreachable!("a leaf has no other number"),
    };
    for child in children {
        let size = count(child);
        if index < size {
            return nth(child, index);
        }
        index -= size;
    }
    unreachable!("the index is below the count")
}
