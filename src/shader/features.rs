//! What a scene and its settings need of the shaders. One function decides,
//! [`Features::of`]; the names are the words behind `#if`.

use super::generated::FEW_LIGHTS;
use crate::scene::{LightKind, Projection, Scene};
use crate::settings::{Accel, LightSelection, RenderSettings, Sampler, Strategy};
use crate::stopping::StoppingRule;
use std::fmt;

macro_rules! features {
    ($($(#[$doc:meta])* $variant:ident = $name:literal,)*) => {
        /// Something that a shader contains only where it is needed.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Feature {
            $($(#[$doc])* $variant,)*
        }

        impl Feature {
            /// All of them, in order.
            pub const ALL: &[Feature] = &[$(Feature::$variant),*];

            /// The word used in `#if`.
            pub fn name(self) -> &'static str {
                match self { $(Feature::$variant => $name),* }
            }
        }
    };
}

features! {
    /// Triangles.
    Triangles = "TRIANGLES",
    /// Analytic spheres.
    Spheres = "SPHERES",
    /// Spheres so large that they need the anchored form.
    AnchoredSpheres = "ANCHORED_SPHERES",
    /// Meshes placed more than once.
    Instances = "INSTANCES",
    /// Any per-vertex data: normals at least.
    Attributes = "ATTRIBUTES",
    /// Texture coordinates, colours or tangents.
    VertexData = "VERTEX_DATA",
    /// Images.
    Textures = "TEXTURES",
    /// Nodes that need two buffers of the device.
    SplitNodes = "SPLIT_NODES",
    /// Primitives that need four.
    SplitPrimitives = "SPLIT_PRIMITIVES",
    /// Their attributes, too.
    SplitAttributes = "SPLIT_ATTRIBUTES",
    /// Images that need more than one buffer of the device.
    SplitTextures = "SPLIT_TEXTURES",
    /// Alpha MASK or BLEND.
    Alpha = "ALPHA",
    /// Camera rays pass through the backs of some triangles.
    Culling = "CULLING",
    /// A rough specular lobe.
    Ggx = "GGX",
    /// Mirrors and smooth interfaces.
    Delta = "DELTA",
    /// Light passes through surfaces.
    Transmission = "TRANSMISSION",
    /// It passes through rough ones: a lobe with a density.
    RoughTransmission = "ROUGH_TRANSMISSION",
    /// The transmitted share has a texture.
    TransmissionTexture = "TRANSMISSION_TEXTURE",
    /// An index of refraction for each channel.
    Dispersion = "DISPERSION",
    /// Diffuse light on the other side.
    DiffuseTransmission = "DIFFUSE_TRANSMISSION",
    /// Lobes with a density reach below the surface: either of these two.
    LowerLobes = "LOWER_LOBES",
    /// Metal and dielectric reflect each by a formula of its own.
    SplitFresnel = "SPLIT_FRESNEL",
    /// Textures of the dielectric's reflectance.
    SpecularTextures = "SPECULAR_TEXTURES",
    /// Specular colour and glossiness in place of metallic and roughness.
    SpecularGlossiness = "SPECULAR_GLOSSINESS",
    /// Stretched highlights.
    Anisotropy = "ANISOTROPY",
    /// A thin film on the base.
    Iridescence = "IRIDESCENCE",
    /// Fibres above the base.
    Sheen = "SHEEN",
    /// A clear layer above all else.
    Clearcoat = "CLEARCOAT",
    /// That layer has a normal map.
    ClearcoatNormal = "CLEARCOAT_NORMAL",
    /// Light passes into volumes: their absorption, and indices inside each other.
    Media = "MEDIA",
    /// Emission that vertex colours multiply.
    Unlit = "UNLIT",
    /// Emission is met by rays on surfaces.
    LightSurfaces = "LIGHT_SURFACES",
    /// Emissive triangles are sampled.
    LightTriangles = "LIGHT_TRIANGLES",
    /// Emissive spheres are sampled.
    LightSpheres = "LIGHT_SPHERES",
    /// Point, spot or directional lights.
    LightPunctual = "LIGHT_PUNCTUAL",
    /// Light from infinity.
    Environment = "ENVIRONMENT",
    /// Thin lens.
    Lens = "LENS",
    /// Orthographic camera.
    Orthographic = "ORTHOGRAPHIC",
    /// Lights are sampled at path vertices.
    Nee = "NEE",
    /// More than one light sample at a vertex.
    ManyLightSamples = "MANY_LIGHT_SAMPLES",
    /// Lights with a place are chosen by a tree.
    LightTree = "LIGHT_TREE",
    /// A light sample is one of several candidates.
    LightCandidates = "LIGHT_CANDIDATES",
    /// The threads of a subgroup of eight walk a tree of four children a node together.
    Packets = "PACKETS",
    /// Every primitive is tested, without a tree.
    BruteForce = "BRUTE_FORCE",
    /// Strategy `mis`.
    Mis = "MIS",
    /// Strategy `light`.
    LightOnly = "LIGHT_ONLY",
    /// Strategies `bsdf` and `hemisphere`.
    ScatterOnly = "SCATTER_ONLY",
    /// Strategy `hemisphere`.
    Hemisphere = "HEMISPHERE",
    /// Russian roulette.
    Roulette = "ROULETTE",
    /// Neighbouring pixels share their paths from the second vertex on.
    PathReuse = "PATH_REUSE",
    /// Sobol points instead of independent ones.
    Sobol = "SOBOL",
    /// The materials are few enough for a uniform buffer, which software devices read without branches.
    UniformMaterials = "UNIFORM_MATERIALS",
    /// The lights are, too.
    UniformLights = "UNIFORM_LIGHTS",
    /// Pixels stop one by one: the film is a list of those that go on.
    Adaptive = "ADAPTIVE",
    /// They stop by the seed's rule, which looks at single samples.
    SeedRule = "SEED_RULE",
    /// Traversals count what they visit.
    VisitCounts = "VISIT_COUNTS",
    /// First hits of every ray are told apart by what they met.
    RayIds = "RAY_IDS",
    /// What GGX loses by scattering once is given back.
    EnergyCompensation = "ENERGY_COMPENSATION",
}

impl Feature {
    /// The feature of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|f| f.name() == name)
    }

    /// Features that follow from settings and exclude others: `--features all` leaves them.
    pub fn is_choice(self) -> bool {
        use Feature::*;
        matches!(
            self,
            SplitNodes
                | SplitPrimitives
                | SplitAttributes
                | SplitTextures
                | Packets
                | UniformMaterials
                | UniformLights
                | BruteForce
                | Nee
                | ManyLightSamples
                | LightTree
                | LightCandidates
                | Mis
                | LightOnly
                | ScatterOnly
                | Hemisphere
                | Roulette
                | PathReuse
                | Sobol
                | Adaptive
                | SeedRule
                | VisitCounts
                | RayIds
                | EnergyCompensation
        )
    }
}

/// A set of [`Feature`]s.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub struct Features(u64);

impl Features {
    /// This set and `feature`.
    #[must_use]
    pub fn with(self, feature: Feature) -> Self {
        Self(self.0 | 1 << feature as u64)
    }

    /// This set, and `feature` if `needed`.
    #[must_use]
    pub fn with_if(self, feature: Feature, needed: bool) -> Self {
        if needed { self.with(feature) } else { self }
    }

    /// This set but for `feature`.
    #[must_use]
    pub fn without(self, feature: Feature) -> Self {
        Self(self.0 & !Self::default().with(feature).0)
    }

    /// What either set holds.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Whether it holds `feature`.
    pub fn has(self, feature: Feature) -> bool {
        self.0 & 1 << feature as u64 != 0
    }

    /// Everything that a scene could need, with the settings' own features of this set.
    #[must_use]
    pub fn with_all_of_scenes(self) -> Self {
        Feature::ALL.iter().fold(self, |set, &f| set.with_if(f, !f.is_choice()))
    }

    /// What `scene` needs when rendered with `settings`.
    pub fn of(scene: &Scene, settings: &RenderSettings) -> Self {
        let set = Self::of_settings(settings);
        let set = set.with_geometry(scene).with_materials(scene).with_lights(scene);
        let set = set.with_many_lights(scene, settings);
        let camera = &scene.cameras[settings.camera];
        let is_orthographic = matches!(camera.projection, Projection::Orthographic { .. });
        let set = set
            .with_if(Feature::Culling, scene.has_culled_backs(camera))
            .with_if(Feature::Lens, camera.aperture_radius > 0.0)
            .with_if(Feature::Orthographic, is_orthographic);
        if settings.all_features { set.with_all_of_scenes() } else { set }
    }

    fn of_settings(settings: &RenderSettings) -> Self {
        let strategy = settings.strategy;
        let nee = matches!(strategy, Strategy::Light | Strategy::Mis);
        Self::default()
            .with_if(Feature::Nee, nee)
            .with_if(Feature::ManyLightSamples, nee && settings.light_samples > 1)
            .with_if(Feature::Mis, strategy == Strategy::Mis)
            .with_if(Feature::LightOnly, strategy == Strategy::Light)
            .with_if(Feature::ScatterOnly, !nee)
            .with_if(Feature::Hemisphere, strategy == Strategy::Hemisphere)
            .with_if(Feature::BruteForce, settings.accel == Accel::None)
            .with_if(Feature::Roulette, settings.roulette)
            .with_if(Feature::PathReuse, settings.shares_paths())
            .with_if(Feature::Sobol, settings.sampler == Sampler::Sobol)
            .with_if(Feature::EnergyCompensation, settings.energy_compensation)
            .with_if(Feature::SplitFresnel, settings.energy_compensation)
            .with_if(Feature::Adaptive, settings.stopping_rule().is_some())
            .with_if(
                Feature::SeedRule,
                matches!(settings.stopping_rule(), Some(StoppingRule::Seed(_))),
            )
    }

    fn with_geometry(self, scene: &Scene) -> Self {
        let placed = || scene.instances.iter().map(|i| &scene.meshes[i.mesh as usize]);
        let has_data = |m: &crate::scene::Mesh| {
            !m.uvs[0].is_empty() || !m.uvs[1].is_empty() || !m.colors.is_empty()
        };
        self.with_if(Feature::Triangles, placed().next().is_some())
            .with_if(Feature::Spheres, !scene.spheres.is_empty())
            .with_if(
                Feature::AnchoredSpheres,
                scene.spheres.iter().any(|s| scene.anchor_of(s).is_some()),
            )
            .with_if(Feature::Instances, scene.shared_meshes().contains(&true))
            .with_if(Feature::Attributes, placed().any(|m| !m.normals.is_empty() || has_data(m)))
            .with_if(Feature::VertexData, placed().any(has_data))
    }

    fn with_lights(self, scene: &Scene) -> Self {
        let emits = |m: u32| scene.materials[m as usize].is_emissive();
        let spheres = scene.spheres.iter().any(|s| emits(s.material));
        let triangles =
            scene.instances.iter().any(|i| emits(scene.meshes[i.mesh as usize].material));
        let nee = self.has(Feature::Nee);
        let is_punctual = |k: &LightKind| {
            matches!(
                k,
                LightKind::Point { .. } | LightKind::Spot { .. } | LightKind::Directional { .. }
            )
        };
        self.with_if(Feature::LightSurfaces, spheres || triangles)
            .with_if(Feature::LightTriangles, triangles)
            .with_if(Feature::LightSpheres, spheres)
            .with_if(
                Feature::LightPunctual,
                nee && scene.lights.iter().any(|l| is_punctual(&l.kind)),
            )
            .with_if(Feature::Environment, scene.environment.is_some())
    }

    fn with_many_lights(self, scene: &Scene, settings: &RenderSettings) -> Self {
        let (nee, is_many) = (self.has(Feature::Nee), scene.finite_lights() > FEW_LIGHTS as usize);
        self.with_if(Feature::LightTree, nee && Self::has_light_tree(scene, settings))
            .with_if(Feature::LightCandidates, nee && is_many && settings.light_candidates > 1)
    }

    /// Whether lights are chosen by a tree, should they be sampled.
    pub(crate) fn has_light_tree(scene: &Scene, settings: &RenderSettings) -> bool {
        settings.light_selection == LightSelection::Tree
            && scene.finite_lights() > FEW_LIGHTS as usize
    }
}

impl fmt::Display for Features {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<_> =
            Feature::ALL.iter().filter(|x| self.has(**x)).map(|x| x.name()).collect();
        f.write_str(&names.join(" "))
    }
}
