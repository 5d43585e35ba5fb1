//! glTF meshes to [`Mesh`]es, one for each primitive, or to analytic spheres.

use super::accessor::Accessors;
use super::deform::{self, Deformation, Skinning};
use super::extras::{self, MeshExtras};
use super::materials::Materials;
use super::nodes::Placement;
use super::normals;
use super::notices::Notices;
use super::skins;
use super::tangents;
use super::triangles::{self, Assembled};
use super::variants::Variants;
use crate::Result;
use crate::scene::{AlphaMode, Material, Mesh, Treatment};
use glam::{Vec2, Vec3, Vec4};
use gltf::json::accessor::{ComponentType, Type};
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::validation::Checked;
use gltf::json::{self, Index};
use std::collections::BTreeMap;

/// What a glTF mesh is to us.
pub(super) enum Shape {
    /// Indices of meshes, one for each primitive that has triangles.
    Meshes(Vec<u32>),
    /// A sphere around the origin of object space.
    Sphere {
        /// In object space, positive and finite.
        radius: f32,
        /// Index of the material.
        material: u32,
    },
}

/// The shapes of placements. Those of the same mesh are shared, unless morph targets or a skin
/// make them differ.
#[derive(Default)]
pub(super) struct Shapes {
    shapes: Vec<Shape>,
    of_placements: Vec<Option<usize>>,
}

impl Shapes {
    /// What the placement of this number shows.
    pub(super) fn of(&self, placement: usize) -> Option<&Shape> {
        self.of_placements[placement].map(|shape| &self.shapes[shape])
    }
}

/// What shapes differ by: the mesh, the bits of weights of morph targets, the node of a skin.
type ShapeKey = (usize, Vec<u64>, Option<usize>);

/// Reads the meshes that visible placements use.
pub(super) fn read(
    accessors: &Accessors,
    placements: &[Placement],
    variants: &Variants,
    materials: &mut Materials,
    notices: &mut Notices,
) -> Result<(Shapes, Vec<Mesh>)> {
    let document = accessors.document;
    let mut shapes = Shapes::default();
    let mut known: BTreeMap<ShapeKey, usize> = BTreeMap::new();
    let mut reader = GeometryReader {
        accessors,
        variants,
        materials: &mut materials.materials,
        uv_sets: &materials.uv_sets,
        default_material: None,
        deformation: Deformation::default(),
        meshes: Vec::new(),
        notices,
    };
    for placement in placements {
        let node = document.get(placement.node, "the scene")?;
        let Some(index) = node.mesh.filter(|_| placement.is_visible) else {
            shapes.of_placements.push(None);
            continue;
        };
        let label = document.label(placement.node);
        let mesh = document.get(index, &label)?;
        let weights = deform::weights(placement.weights.as_ref(), mesh);
        let error = |message: String| document.error(format!("{label}: {message}"));
        document.budget.take_elements(weights.len() as u64).map_err(error)?;
        let bits = weights.iter().map(|w| w.to_bits()).collect();
        let key = (index.value(), bits, node.skin.map(|_| placement.node.value()));
        let shape = match known.get(&key) {
            Some(&shape) => shape,
            None => {
                let skin = match node.skin {
                    None => None,
                    Some(skin) => Some(Skinning {
                        world_from_bind: skins::world_from_bind(
                            accessors,
                            placements,
                            skin.value(),
                            &label,
                        )?,
                        world_from_node: placement.world_from_node,
                    }),
                };
                reader.deformation = Deformation { weights, skin };
                shapes.shapes.push(reader.shape(index, mesh)?);
                known.insert(key, shapes.shapes.len() - 1);
                shapes.shapes.len() - 1
            }
        };
        shapes.of_placements.push(Some(shape));
    }
    Ok((shapes, reader.meshes))
}

struct GeometryReader<'a> {
    accessors: &'a Accessors<'a>,
    variants: &'a Variants,
    materials: &'a mut Vec<Material>,
    /// Sets of texture coordinates that the file's materials use.
    uv_sets: &'a [[u32; 2]],
    /// Where glTF's default material is, once a primitive needed it.
    default_material: Option<u32>,
    /// Of the placement whose shape is read.
    deformation: Deformation,
    meshes: Vec<Mesh>,
    notices: &'a mut Notices,
}

impl GeometryReader<'_> {
    fn shape(&mut self, index: Index<json::Mesh>, mesh: &json::Mesh) -> Result<Shape> {
        let document = self.accessors.document;
        let label = document.label(index);
        let error = |message: String| document.error(format!("{label}: {message}"));

        let extras: Option<MeshExtras> = extras::steradian(&mesh.extras).map_err(error)?;
        if let Some(sphere) = extras.and_then(|extras| extras.sphere) {
            let radius = sphere.radius;
            if !(radius > 0.0 && radius.is_finite()) {
                return Err(error(format!(
                    "the sphere's radius is {radius}; it must be above 0 and finite"
                )));
            }
            let material = match mesh.primitives.first() {
                Some(primitive) => self.material(primitive, &label)?,
                None => self.default_material(),
            };
            self.note_sphere(material, &label);
            return Ok(Shape::Sphere { radius, material });
        }

        let mut indices = Vec::new();
        for (i, primitive) in mesh.primitives.iter().enumerate() {
            let what = format!("{label}, primitive {i}");
            if let Some(mut mesh_of_primitive) = self.primitive(primitive, &what)? {
                mesh_of_primitive.name = match mesh.primitives.len() {
                    1 => document.name(index),
                    _ => format!("{}, primitive {i}", document.name(index)),
                };
                indices.push(self.meshes.len() as u32);
                self.meshes.push(mesh_of_primitive);
            }
        }
        Ok(Shape::Meshes(indices))
    }

    /// What an analytic sphere does not have.
    fn note_sphere(&mut self, material: u32, what: &str) {
        let material = &self.materials[material as usize];
        if material.alpha_mode != AlphaMode::Opaque {
            self.notices.approximated("alpha of an analytic sphere: drawn opaque", what);
        }
        if !self.deformation.weights.is_empty() || self.deformation.skin.is_some() {
            self.notices.ignored("morph targets and skins of an analytic sphere", what);
        }
        if material.textures().next().is_some() {
            let message = "textures of an analytic sphere: taken at coordinates (0, 0)";
            self.notices.approximated(message, what);
        }
    }

    /// Index of the primitive's material in the chosen variant, or of the default one.
    fn material(&mut self, primitive: &Primitive, what: &str) -> Result<u32> {
        let document = self.accessors.document;
        let of_variant = self.variants.material(document, primitive, what)?;
        let Some(index) = of_variant.or(primitive.material) else {
            return Ok(self.default_material());
        };
        document.get(index, what)?;
        Ok(index.value() as u32)
    }

    fn default_material(&mut self) -> u32 {
        *self.default_material.get_or_insert_with(|| {
            self.materials.push(Material::default());
            self.materials.len() as u32 - 1
        })
    }

    /// `None`, with a notice, for a primitive without triangles.
    fn primitive(&mut self, primitive: &Primitive, what: &str) -> Result<Option<Mesh>> {
        let document = self.accessors.document;
        let Checked::Valid(mode) = primitive.mode else {
            return Err(document.error(format!("{what}: unknown mode")));
        };
        let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).copied();
        let Some(positions) = attribute(Semantic::Positions) else {
            self.notices.ignored("primitive without POSITION: not drawn", what);
            return Ok(None);
        };
        let positions = self.vec3(positions, &format!("{what}, POSITION"))?;
        let Some(triangles) = self.triangles(primitive, mode, positions.len(), what)? else {
            return Ok(None);
        };
        let material = self.material(primitive, what)?;
        let sets = self.uv_sets.get(material as usize).copied().unwrap_or([0, 1]);
        let [first, second] = sets.map(|set| (set, attribute(Semantic::TexCoords(set))));
        let mut mesh = Mesh {
            normals: self.normals(attribute(Semantic::Normals), &positions, &triangles, what)?,
            tangents: self.tangents(attribute(Semantic::Tangents), what)?,
            uvs: [
                self.uvs(first, positions.len(), what)?,
                self.uvs(second, positions.len(), what)?,
            ],
            colors: self.colors(attribute(Semantic::Colors(0)), &format!("{what}, COLOR_0"))?,
            material,
            positions,
            triangles,
            name: String::new(),
        };
        self.check_lengths(&mesh, what)?;
        if mesh.normals.is_empty() {
            // Without normals, tangents are to be ignored (glTF 2.0, 3.7.2.1).
            mesh.tangents = Vec::new();
        }
        let Deformation { weights, skin } = &self.deformation;
        if !weights.is_empty() {
            deform::morph(self.accessors, primitive, weights, &mut mesh, self.notices, what)?;
        }
        if let Some(skin) = skin {
            deform::skin(self.accessors, primitive, skin, &mut mesh, self.notices, what)?;
        }
        let degenerate = triangles::count_degenerate(&mesh.triangles, &mesh.positions);
        let message = "triangles without area: nothing hits them";
        self.notices.note_many(Treatment::Honoured, message, degenerate, what);
        self.note_missing_attributes(&mesh, what);
        tangents::add(&mut mesh, &self.materials[material as usize], what, self.notices);
        Ok(Some(mesh))
    }

    fn triangles(
        &mut self,
        primitive: &Primitive,
        mode: json::mesh::Mode,
        vertex_count: usize,
        what: &str,
    ) -> Result<Option<Vec<[u32; 3]>>> {
        let document = self.accessors.document;
        let indices = match primitive.indices {
            Some(index) => self.accessors.indices(index, &format!("{what}, indices"))?,
            None => (0..vertex_count as u32).collect(),
        };
        if let Some(index) = indices.iter().find(|&&index| index as usize >= vertex_count) {
            return Err(document
                .error(format!("{what}: index {index} exceeds the {vertex_count} vertices")));
        }
        let Some(Assembled { triangles, left_over }) = triangles::assemble(mode, &indices) else {
            self.notices.ignored("points and lines: not drawn", what);
            return Ok(None);
        };
        document
            .budget
            .take_triangles(triangles.len() as u64)
            .map_err(|message| document.error(format!("{what}: {message}")))?;
        if left_over > 0 {
            let message = "indices that make no whole triangle left out";
            self.notices.approximated(message, what);
        }
        if triangles.is_empty() {
            self.notices.ignored("primitive without triangles: not drawn", what);
            return Ok(None);
        }
        Ok(Some(triangles))
    }

    fn normals(
        &mut self,
        index: Option<Index<json::Accessor>>,
        positions: &[Vec3],
        triangles: &[[u32; 3]],
        what: &str,
    ) -> Result<Vec<Vec3>> {
        let Some(index) = index else { return Ok(Vec::new()) };
        let place = format!("{what}, NORMAL");
        let normals = self.accessors.floats_unchecked::<3>(index, &[Type::Vec3], 0.0, &place)?;
        let mut normals: Vec<Vec3> = normals.into_iter().map(Vec3::from).collect();
        self.check_length(normals.len(), positions.len(), &place)?;
        let done = normals::normalize(&mut normals, positions, triangles);
        for (message, count) in [
            ("normals without direction replaced by the average of face normals", done.replaced),
            ("normals of another length than 1: scaled", done.scaled),
        ] {
            self.notices.note_many(Treatment::Approximated, message, count, what);
        }
        Ok(normals)
    }

    fn tangents(&mut self, index: Option<Index<json::Accessor>>, what: &str) -> Result<Vec<Vec4>> {
        let Some(index) = index else { return Ok(Vec::new()) };
        let place = format!("{what}, TANGENT");
        let tangents = self.accessors.floats_unchecked::<4>(index, &[Type::Vec4], 0.0, &place)?;
        let mut tangents: Vec<Vec4> = tangents.into_iter().map(Vec4::from).collect();
        if !normals::normalize_tangents(&mut tangents) {
            let message =
                "tangents without direction: left out, and made anew where they are needed";
            self.notices.approximated(message, what);
            tangents.clear();
        }
        Ok(tangents)
    }

    fn vec3(&self, index: Index<json::Accessor>, what: &str) -> Result<Vec<Vec3>> {
        let elements = self.accessors.floats::<3>(index, &[Type::Vec3], 0.0, what)?;
        Ok(elements.into_iter().map(Vec3::from).collect())
    }

    fn uvs(
        &self,
        (set, index): (u32, Option<Index<json::Accessor>>),
        vertex_count: usize,
        what: &str,
    ) -> Result<Vec<Vec2>> {
        let Some(index) = index else { return Ok(Vec::new()) };
        let what = format!("{what}, TEXCOORD_{set}");
        let elements = self.accessors.floats::<2>(index, &[Type::Vec2], 0.0, &what)?;
        self.check_length(elements.len(), vertex_count, &what)?;
        Ok(elements.into_iter().map(Vec2::from).collect())
    }

    fn colors(&mut self, index: Option<Index<json::Accessor>>, what: &str) -> Result<Vec<Vec4>> {
        let Some(index) = index else { return Ok(Vec::new()) };
        let accessor = self.accessors.document.get(index, what)?;
        let is_float = matches!(
            &accessor.component_type,
            Checked::Valid(json::accessor::GenericComponentType(ComponentType::F32))
        );
        if !is_float && !accessor.normalized {
            let message = format!("{what}: integer colours must be normalized");
            return Err(self.accessors.document.error(message));
        }
        // RGB colours are opaque.
        let colors = self.accessors.floats::<4>(index, &[Type::Vec3, Type::Vec4], 1.0, what)?;
        let mut colors: Vec<Vec4> = colors.into_iter().map(Vec4::from).collect();
        let mut is_clamped = false;
        for color in &mut colors {
            let clamped = color.clamp(Vec4::ZERO, Vec4::ONE);
            is_clamped |= clamped != *color;
            *color = clamped;
        }
        if is_clamped {
            self.notices.approximated("vertex colours outside [0, 1] clamped", what);
        }
        Ok(colors)
    }

    fn check_lengths(&self, mesh: &Mesh, what: &str) -> Result<()> {
        let lengths = [("TANGENT", mesh.tangents.len()), ("COLOR_0", mesh.colors.len())];
        for (name, length) in lengths.into_iter().filter(|&(_, length)| length > 0) {
            self.check_length(length, mesh.positions.len(), &format!("{what}, {name}"))?;
        }
        Ok(())
    }

    fn check_length(&self, length: usize, vertex_count: usize, what: &str) -> Result<()> {
        if length == vertex_count {
            return Ok(());
        }
        Err(self
            .accessors
            .document
            .error(format!("{what} has {length} elements for {vertex_count} vertices")))
    }

    /// Notes what the material uses and the mesh lacks.
    fn note_missing_attributes(&mut self, mesh: &Mesh, what: &str) {
        let material = &self.materials[mesh.material as usize];
        if material.textures().any(|texture| mesh.uvs[texture.uv_set as usize].is_empty()) {
            let message = "texture on a mesh without its texture coordinates: looked up at (0, 0)";
            self.notices.approximated(message, what);
        }
    }
}
