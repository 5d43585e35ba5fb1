//! Writes the bundled scenes, the same bytes every time:
//!
//! ```sh
//! cargo run --release --example make_scenes [-- --only NAME] [--out FOLDER]
//! cargo run --release --example make_scenes -- --large | --knot AxB [--out FOLDER]
//! ```
//!
//! Run it in the repository root. `--large` writes a variant of the statue with a
//! million triangles to `out/` instead, which is too big to be committed; `--knot` one
//! whose knot has A cells along and B around, two triangles each.

mod cornell;
mod document;
mod environment;
mod hdr;
mod instances;
mod known_radiance;
mod many_lights;
mod material;
mod readme;
mod shapes;
mod statue;
mod veach;

use document::Document;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Where a scene belongs.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// To be looked at.
    Picture,
    /// A known answer; in the folder `tests`.
    Test,
}

/// A bundled scene and what the README says about it.
struct Entry {
    /// Names the folder and the files in it.
    name: &'static str,
    kind: Kind,
    purpose: &'static str,
    /// Where its numbers are from.
    source: &'static str,
    build: fn(&mut Document),
}

const OWN: &str = "own design";
const CORNELL: &str = "[1], [2]";

const SCENES: &[Entry] = &[
    Entry {
        name: "cornell-box",
        kind: Kind::Picture,
        purpose: "area light, indirect light, colour bleeding; compare with the published picture",
        source: CORNELL,
        build: cornell::with_blocks,
    },
    Entry {
        name: "cornell-uplight",
        kind: Kind::Picture,
        purpose: "indirect light alone: a lamp that shines at the ceiling",
        source: "[1], [2], own lamp",
        build: cornell::with_uplight,
    },
    Entry {
        name: "cornell-spheres-diffuse",
        kind: Kind::Picture,
        purpose: "analytic spheres",
        source: CORNELL,
        build: cornell::with_diffuse_spheres,
    },
    Entry {
        name: "cornell-spheres",
        kind: Kind::Picture,
        purpose: "mirror and glass; the caustic on the floor is found only by chance",
        source: CORNELL,
        build: cornell::with_mirror_and_glass,
    },
    Entry {
        name: "veach-mis",
        kind: Kind::Picture,
        purpose: "multiple importance sampling: four roughnesses, four sizes of light",
        source: "[3], own plates",
        build: veach::build,
    },
    Entry {
        name: "statue",
        kind: Kind::Picture,
        purpose: "many triangles in one mesh: build and traversal of the BVH",
        source: OWN,
        build: |document| statue::build(document, statue::CELLS),
    },
    Entry {
        name: "instances",
        kind: Kind::Picture,
        purpose: "7,500 placements of six small meshes: instancing; sun and constant sky",
        source: "[4], own design",
        build: instances::build,
    },
    Entry {
        name: "environment",
        kind: Kind::Picture,
        purpose: "light from an environment map only: metal, plastic, glass, clay",
        source: OWN,
        build: environment::build,
    },
    Entry {
        name: "many-lights",
        kind: Kind::Picture,
        purpose: "choosing among 5,000 emissive triangles: strings of lamps, lanterns, uplights",
        source: OWN,
        build: many_lights::build,
    },
    test("furnace-box", "emission and all bounces in a closed cube", known_radiance::furnace_box),
    test("furnace-sphere", "the same inside an analytic sphere", known_radiance::furnace_sphere),
    test("white-furnace", "Lambertian sphere of albedo 1", known_radiance::white_furnace),
    test(
        "white-furnace-mixed",
        "Lambertian, mirror and glass spheres that lose nothing",
        known_radiance::white_furnace_mixed,
    ),
    test("point-light", "point light above a quad", known_radiance::point_light),
    test("spot-light", "spot light above a quad", known_radiance::spot_light),
    test("directional-light", "slanting parallel light", known_radiance::directional_light),
    test("sphere-light", "emitting sphere above a quad", known_radiance::sphere_light),
    test("quad-light", "emitting square above a quad", known_radiance::quad_light),
    test("point-in-sphere", "point light and all bounces", known_radiance::point_in_sphere),
    test("sphere-in-sphere", "occlusion, lights and all bounces", known_radiance::sphere_in_sphere),
    test("glass-slab", "Fresnel and repeated reflection", known_radiance::glass_slab),
    test("metal-fresnel", "Schlick's Fresnel term of a mirror", known_radiance::metal_fresnel),
];

/// A scene with a known answer.
const fn test(name: &'static str, purpose: &'static str, build: fn(&mut Document)) -> Entry {
    Entry { name, kind: Kind::Test, purpose, source: "formula", build }
}

/// What was written for one entry.
struct Written {
    entry: &'static Entry,
    triangle_count: usize,
    /// Bytes of all files.
    size: u64,
    document: Document,
}

/// The command line.
#[derive(Default)]
struct Options {
    only: Option<String>,
    out: Option<PathBuf>,
    /// Another statue instead: its name and the cells of its knot.
    statue: Option<(String, [u32; 2])>,
}

impl Options {
    fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut options = Self::default();
        while let Some(flag) = arguments.next() {
            let mut value = || arguments.next().ok_or(format!("{flag} needs a value"));
            match flag.as_str() {
                "--only" => options.only = Some(value()?),
                "--out" => options.out = Some(PathBuf::from(value()?)),
                "--large" => options.statue = Some(("statue-large".into(), statue::LARGE_CELLS)),
                "--knot" => {
                    let value = value()?;
                    options.statue = Some((format!("statue-{value}"), cells(&value)?));
                }
                _ => {
                    let known = "--only NAME, --out FOLDER, --large, --knot AxB";
                    return Err(format!("{flag}: known are {known}"));
                }
            }
        }
        if options.statue.is_some() && options.only.is_some() {
            return Err("--large and --knot write one statue alone: leave --only out".into());
        }
        Ok(options)
    }
}

/// Cells along and around a knot, such as 1200x60.
fn cells(text: &str) -> Result<[u32; 2], String> {
    let side = |side: &str| side.parse().ok().filter(|n| (3..=10_000).contains(n));
    let sides = text.split_once('x').and_then(|(a, b)| Some([side(a)?, side(b)?]));
    sides.ok_or(format!("--knot {text}: two numbers from 3 to 10000, such as 1200x60"))
}

fn main() -> ExitCode {
    let options = match Options::parse(std::env::args().skip(1)) {
        Ok(options) => options,
        Err(message) => {
            eprintln!("make_scenes: {message}");
            return ExitCode::from(2);
        }
    };
    match run(&options) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("make_scenes: {message}");
            ExitCode::FAILURE
        }
    }
}

fn run(options: &Options) -> Result<(), String> {
    let out = |default: &str| options.out.clone().unwrap_or_else(|| PathBuf::from(default));
    if let Some((name, cells)) = &options.statue {
        let mut document = Document::new(name);
        statue::build(&mut document, *cells);
        let folder = out("out").join(name);
        let size = document.write(&folder).map_err(|e| at(&folder, &e))?;
        report(&folder, document.triangle_count(), size);
        return Ok(());
    }
    let out = out("scenes");
    let chosen: Vec<&'static Entry> = SCENES
        .iter()
        .filter(|entry| options.only.as_ref().is_none_or(|name| name == entry.name))
        .collect();
    if chosen.is_empty() {
        let names: Vec<&str> = SCENES.iter().map(|entry| entry.name).collect();
        return Err(format!("no scene has this name; there are {}", names.join(", ")));
    }
    let written =
        chosen.into_iter().map(|entry| write(entry, &out)).collect::<Result<Vec<_>, _>>()?;
    if options.only.is_none() {
        let path = out.join("README.md");
        std::fs::write(&path, readme::text(&written)).map_err(|e| at(&path, &e))?;
    }
    Ok(())
}

fn write(entry: &'static Entry, out: &Path) -> Result<Written, String> {
    let folder = match entry.kind {
        Kind::Picture => out.join(entry.name),
        Kind::Test => out.join("tests").join(entry.name),
    };
    let mut document = Document::new(entry.name);
    (entry.build)(&mut document);
    let mut size = document.write(&folder).map_err(|e| at(&folder, &e))?;
    if entry.name == "environment" {
        let path = folder.join("sky.hdr");
        size += hdr::write(&path, environment::SKY_SIZE[0], &environment::sky())
            .map_err(|e| at(&path, &e))?;
    }
    report(&folder, document.triangle_count(), size);
    Ok(Written { entry, triangle_count: document.triangle_count(), size, document })
}

fn report(folder: &Path, triangle_count: usize, size: u64) {
    // A closed pipe does not matter: the files are what counts.
    let _ = writeln!(
        std::io::stdout(),
        "{}: {triangle_count} triangles, {size} bytes",
        folder.display()
    );
}

fn at(path: &Path, error: &std::io::Error) -> String {
    format!("{}: {error}", path.display())
}
