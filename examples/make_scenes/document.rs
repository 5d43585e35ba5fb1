//! Builds one glTF 2.0 document with one buffer and writes it.

use crate::material::Material;
use crate::shapes::{Mesh, sphere};
use glam::{DMat3, DQuat, DVec3};
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;
use std::path::Path;
use std::{fs, io};

const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;

/// Index of a material in its document.
#[derive(Clone, Copy)]
pub(crate) struct MaterialId(usize);

/// Index of a mesh in its document.
#[derive(Clone, Copy)]
pub(crate) struct MeshId(usize);

/// Lens of a camera.
pub(crate) enum Lens {
    /// Full vertical angle in radians.
    Perspective { yfov: f64, aspect_ratio: f64 },
    /// Half the height of a square picture in metres.
    Orthographic { ymag: f64 },
}

/// A light of KHR_lights_punctual: intensity in W/sr, or W/m² if directional.
pub(crate) enum Light {
    Point { intensity: f64 },
    Spot { intensity: f64, inner_angle: f64, outer_angle: f64 },
    Directional { color: [f64; 3], irradiance: f64 },
}

/// A glTF document under construction.
pub(crate) struct Document {
    name: String,
    bin: Vec<u8>,
    buffer_views: Vec<Value>,
    accessors: Vec<Value>,
    materials: Vec<Value>,
    meshes: Vec<Value>,
    mesh_triangles: Vec<usize>,
    nodes: Vec<Value>,
    cameras: Vec<Value>,
    lights: Vec<Value>,
    extensions: BTreeSet<&'static str>,
    steradian: Map<String, Value>,
    triangle_count: usize,
}

impl Document {
    /// Empty; `name` is the stem of the files.
    pub(crate) fn new(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            bin: Vec::new(),
            buffer_views: Vec::new(),
            accessors: Vec::new(),
            materials: Vec::new(),
            meshes: Vec::new(),
            mesh_triangles: Vec::new(),
            nodes: Vec::new(),
            cameras: Vec::new(),
            lights: Vec::new(),
            extensions: BTreeSet::new(),
            steradian: Map::new(),
            triangle_count: 0,
        }
    }

    /// Triangles of all placements.
    pub(crate) fn triangle_count(&self) -> usize {
        self.triangle_count
    }

    /// Adds a material.
    pub(crate) fn material(&mut self, material: Material) -> MaterialId {
        let (value, extensions) = material.to_json();
        self.extensions.extend(extensions);
        self.materials.push(value);
        MaterialId(self.materials.len() - 1)
    }

    /// Adds a mesh with one primitive.
    pub(crate) fn mesh(&mut self, name: &str, mesh: &Mesh, material: MaterialId) -> MeshId {
        let positions = self.vectors(&mesh.positions, true);
        let normals = self.vectors(&mesh.normals, false);
        let indices = self.indices(&mesh.triangles, mesh.positions.len());
        self.meshes.push(json!({
            "name": name,
            "primitives": [{
                "attributes": { "NORMAL": normals, "POSITION": positions },
                "indices": indices,
                "material": material.0,
            }],
        }));
        self.mesh_triangles.push(mesh.triangles.len());
        MeshId(self.meshes.len() - 1)
    }

    /// Adds a sphere that Steradian traces as an exact one; other programs see
    /// its triangles.
    pub(crate) fn sphere(&mut self, name: &str, radius: f64, material: MaterialId) -> MeshId {
        let id = self.mesh(name, &sphere(radius), material);
        self.meshes[id.0]["extras"] = json!({ "steradian": { "sphere": { "radius": radius } } });
        id
    }

    /// Places a mesh without rotation or scale.
    pub(crate) fn place(&mut self, name: &str, mesh: MeshId, translation: DVec3) {
        let mut node = json!({ "name": name, "mesh": mesh.0 });
        if translation != DVec3::ZERO {
            node["translation"] = json!(rounded_vector(translation, 6));
        }
        self.push_node(node, Some(mesh));
    }

    /// Places a mesh with translation, rotation and uniform scale, all rounded to
    /// 5 digits, and without a name: for thousands of nodes.
    pub(crate) fn scatter(
        &mut self,
        mesh: MeshId,
        translation: DVec3,
        rotation: DQuat,
        scale: f64,
    ) {
        let node = json!({
            "mesh": mesh.0,
            "translation": rounded_vector(translation, 4),
            "rotation": rotation.to_array().map(|x| rounded(x, 5)),
            "scale": ([rounded(scale, 3); 3]),
        });
        self.push_node(node, Some(mesh));
    }

    fn push_node(&mut self, node: Value, mesh: Option<MeshId>) {
        self.triangle_count += mesh.map_or(0, |m| self.mesh_triangles[m.0]);
        self.nodes.push(node);
    }

    /// Adds a camera at `eye` that looks at `target` with +Y up, or -Z up when it
    /// looks straight up or down.
    pub(crate) fn camera(&mut self, eye: DVec3, target: DVec3, lens: Lens) {
        let (kind, values) = match lens {
            Lens::Perspective { yfov, aspect_ratio } => {
                ("perspective", json!({ "yfov": yfov, "aspectRatio": aspect_ratio, "znear": 0.01 }))
            }
            Lens::Orthographic { ymag } => (
                "orthographic",
                json!({ "xmag": ymag, "ymag": ymag, "znear": 0.001, "zfar": 100.0 }),
            ),
        };
        self.cameras.push(json!({ "name": "camera", "type": kind, kind: values }));
        self.push_node(
            json!({
                "name": "camera",
                "camera": self.cameras.len() - 1,
                "translation": rounded_vector(eye, 6),
                "rotation": looking(target - eye),
            }),
            None,
        );
    }

    /// Adds a light at `position` that shines along `direction`.
    pub(crate) fn light(&mut self, name: &str, light: Light, position: DVec3, direction: DVec3) {
        self.extensions.insert("KHR_lights_punctual");
        self.lights.push(match light {
            Light::Point { intensity } => {
                json!({ "name": name, "type": "point", "intensity": intensity })
            }
            Light::Spot { intensity, inner_angle, outer_angle } => json!({
                "name": name, "type": "spot", "intensity": intensity,
                "spot": { "innerConeAngle": inner_angle, "outerConeAngle": outer_angle },
            }),
            Light::Directional { color, irradiance } => json!({
                "name": name, "type": "directional", "color": color, "intensity": irradiance,
            }),
        });
        let index = self.lights.len() - 1;
        self.push_node(
            json!({
                "name": name,
                "translation": rounded_vector(position, 6),
                "rotation": looking(direction),
                "extensions": { "KHR_lights_punctual": { "light": index } },
            }),
            None,
        );
    }

    /// Puts `value` under `key` in the scene's `extras.steradian`.
    pub(crate) fn extra(&mut self, key: &str, value: Value) {
        self.steradian.insert(key.into(), value);
    }

    /// What [`Self::extra`] put under `key`.
    pub(crate) fn extra_value(&self, key: &str) -> Option<&Value> {
        self.steradian.get(key)
    }

    /// Number of placed meshes, cameras and lights.
    pub(crate) fn node_count(&self) -> usize {
        self.nodes.len()
    }

    /// Writes `<name>.gltf` and `<name>.bin` into `folder`, and returns the sum of
    /// their sizes in bytes.
    pub(crate) fn write(&self, folder: &Path) -> io::Result<u64> {
        fs::create_dir_all(folder)?;
        let text = lines(&self.root());
        fs::write(folder.join(format!("{}.gltf", self.name)), &text)?;
        fs::write(folder.join(format!("{}.bin", self.name)), &self.bin)?;
        Ok((text.len() + self.bin.len()) as u64)
    }

    fn root(&self) -> Value {
        let mut scene =
            json!({ "name": self.name, "nodes": (0..self.nodes.len()).collect::<Vec<_>>() });
        if !self.steradian.is_empty() {
            scene["extras"] = json!({ "steradian": self.steradian });
        }
        let mut root = json!({
            "asset": { "version": "2.0", "generator": "Steradian make_scenes" },
            "scene": 0,
            "scenes": [scene],
            "nodes": self.nodes,
            "cameras": self.cameras,
            "materials": self.materials,
            "meshes": self.meshes,
            "accessors": self.accessors,
            "bufferViews": self.buffer_views,
            "buffers": [{ "uri": format!("{}.bin", self.name), "byteLength": self.bin.len() }],
        });
        if !self.extensions.is_empty() {
            root["extensionsUsed"] = json!(self.extensions);
        }
        if !self.lights.is_empty() {
            root["extensions"] = json!({ "KHR_lights_punctual": { "lights": self.lights } });
        }
        root
    }

    /// Adds a buffer view; every one begins at a multiple of 4 bytes.
    fn view(&mut self, bytes: &[u8], target: u32) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        self.buffer_views.push(json!({
            "buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len(), "target": target,
        }));
        self.bin.extend_from_slice(bytes);
        self.buffer_views.len() - 1
    }

    fn vectors(&mut self, vectors: &[DVec3], with_bounds: bool) -> usize {
        let floats: Vec<[f32; 3]> = vectors.iter().map(|v| v.as_vec3().to_array()).collect();
        let mut accessor = json!({
            "bufferView": self.view(&little_endian(&floats), ARRAY_BUFFER),
            "componentType": FLOAT, "count": floats.len(), "type": "VEC3",
        });
        if with_bounds {
            // The bounds must be those of the stored f32 numbers, to the bit.
            let bound = |pick: fn(f32, f32) -> f32, start: f32| {
                let fold = |k| floats.iter().map(|v: &[f32; 3]| v[k]).fold(start, pick);
                [0, 1, 2].map(|k| f64::from(fold(k)))
            };
            accessor["min"] = json!(bound(f32::min, f32::INFINITY));
            accessor["max"] = json!(bound(f32::max, f32::NEG_INFINITY));
        }
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn indices(&mut self, triangles: &[[u32; 3]], vertex_count: usize) -> usize {
        // 65,535 itself is reserved for primitive restart.
        let (bytes, component) = if vertex_count <= 65_535 {
            let short = |i: &u32| (*i as u16).to_le_bytes();
            (triangles.as_flattened().iter().flat_map(short).collect::<Vec<u8>>(), UNSIGNED_SHORT)
        } else {
            let word = |i: &u32| i.to_le_bytes();
            (triangles.as_flattened().iter().flat_map(word).collect(), UNSIGNED_INT)
        };
        let view = self.view(&bytes, ELEMENT_ARRAY_BUFFER);
        self.accessors.push(json!({
            "bufferView": view, "componentType": component,
            "count": triangles.len() * 3, "type": "SCALAR",
        }));
        self.accessors.len() - 1
    }
}

fn little_endian(floats: &[[f32; 3]]) -> Vec<u8> {
    floats.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect()
}

/// `x` to so many decimal digits; never -0.
pub(crate) fn rounded(x: f64, digits: i32) -> f64 {
    let unit = 10_f64.powi(digits);
    (x * unit).round() / unit + 0.0
}

fn rounded_vector(v: DVec3, digits: i32) -> [f64; 3] {
    v.to_array().map(|x| rounded(x, digits))
}

/// The rotation that turns -Z to `direction` and keeps +Y as high as it can.
fn looking(direction: DVec3) -> [f64; 4] {
    let back = -direction.normalize();
    let up = if back.y.abs() > 0.999_999 { DVec3::NEG_Z } else { DVec3::Y };
    let right = up.cross(back).normalize();
    let frame = DMat3::from_cols(right, back.cross(right), back);
    DQuat::from_mat3(&frame).to_array().map(|x| rounded(x, 7))
}

/// JSON with one line for each element of a top-level array: short, and a change
/// of one object shows as one line.
fn lines(root: &Value) -> String {
    let object = root.as_object().expect("a glTF root is an object");
    let members: Vec<String> = object
        .iter()
        .map(|(key, value)| match value {
            Value::Array(items) => {
                let items: Vec<String> = items.iter().map(|item| format!("    {item}")).collect();
                format!("  \"{key}\": [\n{}\n  ]", items.join(",\n"))
            }
            other => format!("  \"{key}\": {other}"),
        })
        .collect();
    format!("{{\n{}\n}}\n", members.join(",\n"))
}
