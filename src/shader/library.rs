//! The WGSL files of the program.

use std::borrow::Cow;
use std::collections::BTreeMap;

/// WGSL texts by path within `shaders/`, without the ending.
pub type Library = BTreeMap<&'static str, Cow<'static, str>>;

macro_rules! files {
    ($($path:literal),* $(,)?) => {
        [$(($path, include_str!(concat!("../../shaders/", $path, ".wgsl")).into())),*]
    };
}

/// The files compiled into the program. A path without a folder is an entry;
/// all others are modules.
pub fn library() -> Library {
    Library::from(files![
        "accumulate",
        "bsdf/albedo_tables",
        "bsdf/bsdf",
        "bsdf/clearcoat",
        "bsdf/dielectric",
        "bsdf/fresnel",
        "bsdf/ggx",
        "bsdf/interface",
        "bsdf/lambert",
        "bsdf/rough_refraction",
        "bsdf/scatter",
        "bsdf/sheen",
        "bsdf/smooth",
        "bsdf/smooth_hemisphere",
        "bsdf/split_fresnel",
        "bsdf/thin_film",
        "bsdf/width",
        "camera/camera",
        "compact",
        "dispatch_size",
        "film/fault",
        "film/film",
        "film/tile",
        "first_hit",
        "float_environment",
        "frame/frame",
        "geometry/attributes",
        "geometry/leaf",
        "geometry/nodes",
        "geometry/primitive",
        "geometry/ray",
        "geometry/shear",
        "geometry/slab",
        "geometry/sphere",
        "geometry/stack",
        "geometry/surface",
        "geometry/surface_sphere",
        "geometry/surface_triangle",
        "geometry/trace",
        "geometry/trace_brute_force",
        "geometry/trace_lane",
        "geometry/trace_packet",
        "geometry/tree_ray",
        "geometry/triangle",
        "geometry/visits",
        "judge",
        "light/candidates",
        "light/direct",
        "light/environment",
        "light/light",
        "light/punctual",
        "light/sphere",
        "light/tree",
        "light/triangle",
        "material/alpha",
        "material/anisotropy",
        "material/layers",
        "material/material",
        "material/normal_map",
        "material/texture",
        "math/exponential",
        "math/math",
        "path/exchange_subgroup",
        "path/exchange_workgroup",
        "path/media",
        "path/path",
        "path/radiance",
        "path/reuse",
        "path_trace",
        "sample/pcg",
        "sample/sampler",
        "sample/sampler_independent",
        "sample/sampler_sobol",
        "sample/sobol",
        "sample/warp",
        "scan",
        "stopping/blocks",
        "stopping/calibrated",
        "stopping/dispatch",
        "stopping/moments",
        "stopping/runs",
        "stopping/seed",
        "stopping/tally",
        "strategy/light",
        "strategy/mis",
        "strategy/scatter",
    ])
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn walk(folder: &Path, prefix: &str, found: &mut Vec<String>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
            if path.is_dir() {
                walk(&path, &format!("{prefix}{name}/"), found);
            } else {
                found.push(format!("{prefix}{name}"));
            }
        }
    }

    #[test]
    fn lists_every_file_of_the_folder() {
        let mut found = Vec::new();
        walk(&Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders"), "", &mut found);
        found.sort();
        let listed: Vec<String> = library().keys().map(|k| k.to_string()).collect();
        assert_eq!(found, listed);
    }
}
