//! Every shader for every set of features that can occur: composes, and
//! validates with naga. Needs no device.

use steradian::gpu::validate;
use steradian::shader::{Feature, Features, compose, generated, library};

/// Storage buffers that every device can bind in one stage.
const MOST_STORAGE_BUFFERS: usize = 8;

/// More of them that hold what one cannot, where a device can bind them.
const SPLIT: [(Feature, usize); 4] = [
    (Feature::SplitTextures, 3),
    (Feature::SplitPrimitives, 3),
    (Feature::SplitAttributes, 3),
    (Feature::SplitNodes, 1),
];

/// `set` with what its members cannot occur without.
fn with_implied(mut set: Features) -> Features {
    use Feature::*;
    let implied = [
        (SplitTextures, Textures),
        (SplitAttributes, Attributes),
        (Textures, VertexData),
        (VertexData, Attributes),
        (Attributes, Triangles),
        (Instances, Triangles),
        (LightTriangles, Triangles),
        (AnchoredSpheres, Spheres),
        (LightSpheres, Spheres),
        (LightTriangles, LightSurfaces),
        (LightSpheres, LightSurfaces),
        (RoughTransmission, Transmission),
        (TransmissionTexture, Transmission),
        (Dispersion, Transmission),
        (Transmission, Delta),
        (Transmission, SplitFresnel),
        (Iridescence, SplitFresnel),
        (EnergyCompensation, SplitFresnel),
        (RoughTransmission, Ggx),
        (RoughTransmission, LowerLobes),
        (DiffuseTransmission, LowerLobes),
        (Anisotropy, Ggx),
        (ClearcoatNormal, Clearcoat),
        (Clearcoat, Ggx),
        (Clearcoat, Delta),
        (ClearcoatNormal, Textures),
        (SpecularTextures, Textures),
        (TransmissionTexture, Textures),
        (LightPunctual, Nee),
        (ManyLightSamples, Nee),
        (Hemisphere, ScatterOnly),
    ];
    for _ in 0..5 {
        for (feature, needs) in implied {
            set = set.with_if(needs, set.has(feature));
        }
    }
    // Something is traced, lights on surfaces are of some kind, and one strategy is chosen.
    set = set.with_if(Triangles, !set.has(Spheres));
    let lit = set.has(LightTriangles) || set.has(LightSpheres);
    set = set.with_if(LightTriangles, set.has(LightSurfaces) && !lit && set.has(Triangles));
    set = set.with_if(LightSpheres, set.has(LightSurfaces) && !lit && set.has(Spheres));
    let chosen = set.has(Mis) || set.has(LightOnly) || set.has(ScatterOnly);
    set = set.with_if(Mis, set.has(Nee) && !chosen).with_if(ScatterOnly, !set.has(Nee) && !chosen);
    set.with_if(Nee, set.has(Mis) || set.has(LightOnly))
}

/// Whether the set holds two strategies.
fn is_contradictory(set: Features) -> bool {
    use Feature::*;
    [Mis, LightOnly, ScatterOnly].iter().filter(|f| set.has(**f)).count() > 1
        || (set.has(Nee) && set.has(ScatterOnly))
        || (set.has(BruteForce) && (set.has(Instances) || set.has(Packets)))
}

fn feature_sets() -> Vec<Features> {
    let none = Features::default();
    let mut sets = vec![none];
    for &a in Feature::ALL {
        for &b in Feature::ALL {
            sets.push(none.with(a).with(b));
        }
    }
    let scene = none.with_all_of_scenes();
    for strategy in [Feature::Mis, Feature::LightOnly, Feature::ScatterOnly, Feature::Hemisphere] {
        let set = scene.with(strategy);
        sets.push(set);
        sets.push(set.with(Feature::Sobol).with(Feature::Roulette));
        sets.push(set.with_if(Feature::ManyLightSamples, strategy != Feature::Hemisphere));
    }
    let sets = sets.into_iter().map(with_implied).filter(|s| !is_contradictory(*s));
    let mut unique = Vec::new();
    for set in sets {
        if !unique.contains(&set) {
            unique.push(set);
        }
    }
    unique
}

#[test]
fn every_entry_composes_and_validates_for_every_feature_set() {
    let library = library();
    let entries: Vec<_> = library.keys().filter(|k| !k.contains('/')).collect();
    assert!(!entries.is_empty());
    let generated = generated::wgsl(32, 64);
    let sets = feature_sets();
    assert!(sets.len() > 200, "{} sets", sets.len());
    let mut failures = Vec::new();
    for entry in entries {
        for &set in &sets {
            let checked = compose(&library, entry, set, &generated)
                .and_then(|composed| validate(entry, &composed));
            match checked {
                Err(e) => failures.push(format!("[{set}] {e}")),
                Ok(module) => {
                    let storage = module
                        .global_variables
                        .iter()
                        .filter(|(_, v)| matches!(v.space, naga::AddressSpace::Storage { .. }))
                        .count();
                    let is_split = SPLIT.iter().filter(|(feature, _)| set.has(*feature));
                    let extra: usize = is_split.map(|(_, more)| more).sum();
                    if storage > MOST_STORAGE_BUFFERS + extra {
                        failures.push(format!("[{set}] {entry}: {storage} storage buffers"));
                    }
                    let entry_points = module.entry_points.len();
                    if entry_points != 1 || module.entry_points[0].name != "main" {
                        failures.push(format!("[{set}] {entry}: {entry_points} entry points"));
                    }
                }
            }
        }
    }
    let count = failures.len();
    failures.truncate(5);
    assert!(failures.is_empty(), "{count} failures:\n{}", failures.join("\n"));
}

#[test]
fn modules_have_no_entry_point() {
    for (path, text) in library().iter().filter(|(path, _)| path.contains('/')) {
        assert!(!text.contains("@compute"), "{path}.wgsl");
    }
}

/// Text import has no namespaces: a function belongs to the module that its name begins with.
#[test]
fn no_name_is_defined_by_two_modules_that_can_meet() {
    use std::collections::BTreeMap;
    let alternatives = [
        ["bsdf/smooth", "bsdf/smooth_hemisphere"],
        ["geometry/trace_lane", "geometry/trace_packet"],
        ["geometry/trace_lane", "geometry/trace_brute_force"],
        ["geometry/trace_packet", "geometry/trace_brute_force"],
        ["path/exchange_subgroup", "path/exchange_workgroup"],
        ["sample/sampler_sobol", "sample/sampler_independent"],
        ["strategy/mis", "strategy/light"],
        ["strategy/mis", "strategy/scatter"],
        ["strategy/light", "strategy/scatter"],
    ];
    let mut owners: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    let library = library();
    // Entries never meet: each has a main, and functions of its own.
    for (path, text) in library.iter().filter(|(path, _)| path.contains('/')) {
        for line in text.lines().filter_map(|l| l.strip_prefix("fn ")) {
            owners.entry(line.split('(').next().unwrap()).or_default().push(path);
        }
    }
    for (name, paths) in owners {
        for (i, a) in paths.iter().enumerate() {
            for b in &paths[i + 1..] {
                let is_allowed = alternatives.iter().any(|p| p.contains(a) && p.contains(b));
                assert!(is_allowed, "{name} is defined in {a} and {b}");
            }
        }
    }
}
