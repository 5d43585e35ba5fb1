//! Builds small glTF scenes in a temporary folder.

#![allow(dead_code, reason = "each test program uses a part of this")]

use serde_json::{Value, json};
use std::path::PathBuf;
use steradian::scene::gltf::{LoadOptions, load, load_with};
use steradian::scene::{Scene, Treatment};
use tempfile::TempDir;

pub(crate) const BYTE: u32 = 5120;
pub(crate) const UNSIGNED_BYTE: u32 = 5121;
pub(crate) const UNSIGNED_SHORT: u32 = 5123;
pub(crate) const FLOAT: u32 = 5126;

/// The corners of the triangle in [`Fixture::triangle`].
pub(crate) const CORNERS: [f32; 9] = [0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 1.0, 0.0];

/// A glTF file to be, with one binary chunk.
pub(crate) struct Fixture {
    pub(crate) folder: TempDir,
    pub(crate) json: Value,
    bin: Vec<u8>,
}

impl Fixture {
    /// A scene without nodes.
    pub(crate) fn empty() -> Self {
        let json = json!({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}],
            "nodes": [], "meshes": [], "accessors": [], "bufferViews": [],
            "materials": [], "cameras": [], "images": [], "textures": [], "samplers": [],
        });
        Self { folder: TempDir::new().unwrap(), json, bin: Vec::new() }
    }

    /// Mesh 0 is a triangle without indices, normals and material; node 0 places it.
    pub(crate) fn triangle() -> Self {
        let mut fixture = Self::empty();
        let positions = fixture.floats("VEC3", &CORNERS);
        fixture.push("meshes", json!({"primitives": [{"attributes": {"POSITION": positions}}]}));
        fixture.node(json!({"mesh": 0}));
        fixture
    }

    /// A triangle with this material, and texture coordinates.
    pub(crate) fn with_material(material: Value) -> Self {
        let mut fixture = Self::triangle();
        let uvs = fixture.floats("VEC2", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
        fixture.attribute("TEXCOORD_0", uvs);
        fixture.primitive()["material"] = json!(0);
        fixture.push("materials", material);
        fixture
    }

    /// Appends to a top-level array; the index.
    pub(crate) fn push(&mut self, list: &str, value: Value) -> usize {
        let list = self.json[list].as_array_mut().unwrap();
        list.push(value);
        list.len() - 1
    }

    /// Appends a node and makes it a root of scene 0.
    pub(crate) fn node(&mut self, node: Value) -> usize {
        let index = self.push("nodes", node);
        self.json["scenes"][0]["nodes"].as_array_mut().unwrap().push(json!(index));
        index
    }

    /// A bufferView of these bytes.
    pub(crate) fn view(&mut self, bytes: &[u8]) -> usize {
        let offset = self.bin.len();
        self.bin.extend(bytes);
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let view = json!({"buffer": 0, "byteOffset": offset, "byteLength": bytes.len()});
        self.push("bufferViews", view)
    }

    /// Bytes of the binary chunk so far.
    pub(crate) fn bin_length(&self) -> usize {
        self.bin.len()
    }

    /// An accessor that is a whole view of these bytes.
    pub(crate) fn accessor(
        &mut self,
        component: u32,
        kind: &str,
        count: usize,
        bytes: &[u8],
    ) -> usize {
        let view = self.view(bytes);
        let accessor =
            json!({"bufferView": view, "componentType": component, "count": count, "type": kind});
        self.push("accessors", accessor)
    }

    pub(crate) fn floats(&mut self, kind: &str, values: &[f32]) -> usize {
        let width = match kind {
            "SCALAR" => 1,
            _ => kind[3..].parse::<usize>().unwrap(),
        };
        self.accessor(FLOAT, kind, values.len() / width, &bytes_of(values))
    }

    /// The first primitive of mesh 0.
    pub(crate) fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    /// Gives the primitive an attribute.
    pub(crate) fn attribute(&mut self, name: &str, accessor: usize) {
        self.primitive()["attributes"][name] = json!(accessor);
    }

    /// Gives the primitive indices of 16 bits.
    pub(crate) fn indices(&mut self, indices: &[u16]) {
        let bytes: Vec<u8> = indices.iter().flat_map(|i| i.to_le_bytes()).collect();
        let accessor = self.accessor(UNSIGNED_SHORT, "SCALAR", indices.len(), &bytes);
        self.primitive()["indices"] = json!(accessor);
    }

    /// The bytes of a GLB. An explicit `buffers` stands instead of the binary chunk's.
    pub(crate) fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        if json.get("buffers").is_none() {
            json["buffers"] = json!([{"byteLength": self.bin.len()}]);
        }
        let mut text = json.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut glb = b"glTF".to_vec();
        let length = 12 + 8 + text.len() + 8 + self.bin.len();
        for word in [2, length as u32, text.len() as u32] {
            glb.extend(word.to_le_bytes());
        }
        glb.extend(b"JSON");
        glb.extend(text);
        glb.extend((self.bin.len() as u32).to_le_bytes());
        glb.extend(b"BIN\0");
        glb.extend(&self.bin);
        glb
    }

    /// Writes a file into the scene's folder.
    pub(crate) fn write(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }

    pub(crate) fn load(&self) -> steradian::Result<Scene> {
        load(&self.write("scene.glb", &self.glb()))
    }

    /// The scene, which must load.
    pub(crate) fn scene(&self) -> Scene {
        self.load().unwrap_or_else(|e| panic!("{e}"))
    }

    pub(crate) fn load_strict(&self) -> steradian::Result<Scene> {
        self.load_with(&LoadOptions { strict: true, ..LoadOptions::default() })
    }

    pub(crate) fn load_with(&self, options: &LoadOptions) -> steradian::Result<Scene> {
        load_with(&self.write("scene.glb", &self.glb()), options)
    }

    /// The message with which the file is refused.
    pub(crate) fn refusal(&self) -> String {
        match self.load() {
            Ok(_) => panic!("the file was accepted"),
            Err(error) => {
                assert_eq!(error.exit_code(), 3, "{error}");
                error.to_string()
            }
        }
    }
}

/// Whether a notice of this treatment contains the text.
pub(crate) fn has_notice(scene: &Scene, treatment: Treatment, text: &str) -> bool {
    scene.notices.iter().any(|n| n.treatment == treatment && n.message.contains(text))
}

/// Panics, showing the text, unless it contains the part.
#[track_caller]
pub(crate) fn assert_contains(text: &str, part: &str) {
    assert!(text.contains(part), "{part:?} is not in {text:?}");
}

pub(crate) fn bytes_of(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// A PNG of 2 × 1 pixels, red and half transparent blue.
pub(crate) fn png() -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image::RgbaImage::from_raw(2, 1, vec![255, 0, 0, 255, 0, 0, 255, 128])
        .unwrap()
        .write_to(&mut bytes, image::ImageFormat::Png)
        .unwrap();
    bytes.into_inner()
}
