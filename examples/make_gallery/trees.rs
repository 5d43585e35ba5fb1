//! Trees by the surface area heuristic and by medians, and no tree.

use crate::error::{epsilon, error, largest_difference};
use crate::page::{commands, sheet, short, table};
use crate::renders::{FOLDER, Job, Program, Shot, bundled, make_scenes};
use crate::trees_count::{Figures, Triangles};
use std::path::Path;

const SIDE: u32 = 64;
const SPP: u32 = 256;
const REFERENCE_SPP: u32 = 1024;
/// Pixels of a side for which rays are counted.
const COUNTED: u32 = 128;
/// Cells of the knot along and around; the last statue is the bundled one.
const KNOTS: [&str; 3] = ["60x6", "180x10", "700x35"];

fn job(scene: &str, spp: u32, accel: &str) -> Job {
    Job::new(scene, SIDE, spp, &format!("--max-bounces 1 --accel {accel}"))
}

/// One size of the statue.
struct Size {
    triangles: Triangles,
    sah: Shot,
    reference: Shot,
    rows: Vec<Vec<String>>,
    shots: Vec<Shot>,
    /// Largest difference between the pictures with and without a tree.
    difference: f64,
}

fn measure(program: &Program, scene: &str) -> Result<Size, String> {
    let triangles = Triangles::load(scene, COUNTED)?;
    let sah = program.shot(&job(scene, SPP, "bvh"))?;
    let median = program.shot(&job(scene, SPP, "median"))?;
    let one = program.shot(&job(scene, 1, "bvh"))?;
    // Every ray tests every triangle: one sample is enough to wait for.
    // Some drivers end long loops early, which the renderer notices.
    let none = program.attempt(&job(scene, 1, "none"))?;
    let reference = program.shot(&job(scene, SPP, "bvh").reference(REFERENCE_SPP))?;
    let count = triangles.len();
    let row = |way: &str, figures: Option<Figures>, shot: &Shot| {
        let touched = figures.map_or(["", "", ""].map(str::to_owned), |f| {
            [1e3 * f.build_seconds, f.nodes, f.triangles].map(|x| format!("{x:.1}"))
        });
        let [build, nodes, tests] = touched;
        let tests = if tests.is_empty() { count.to_string() } else { tests };
        let samples = shot.stats["spp"].as_f64().unwrap_or(f64::NAN);
        let frame = match shot.faults {
            0 => format!("{:.1}", 1e3 * shot.seconds / samples),
            _ => "fails: the driver cuts the loop off".to_owned(),
        };
        vec![count.to_string(), way.to_owned(), build, nodes, tests, frame]
    };
    let rows = vec![
        row("none", None, &none),
        row("median", Some(triangles.median()), &median),
        row("SAH", Some(triangles.sah()), &sah),
    ];
    let mut difference = largest_difference(&median.picture, &sah.picture);
    if none.faults == 0 {
        difference = difference.max(largest_difference(&none.picture, &one.picture));
    }
    Ok(Size { triangles, sah, reference, rows, shots: vec![median, one, none], difference })
}

/// How much longer frames of the largest statue take.
fn speed(largest: &Size) -> String {
    let [median, _, none] = &largest.shots[..] else { return String::new() };
    let frame = largest.sah.seconds / f64::from(SPP);
    let of_median = median.seconds / largest.sah.seconds;
    let of_none = match none.faults {
        0 => {
            format!("some {:.0}00 times as long without a tree, and ", none.seconds / frame / 100.0)
        }
        _ => String::new(),
    };
    format!("A frame of the largest takes {of_none}{of_median:.1} times as long by medians.")
}

/// Four sizes of the statue.
pub(crate) fn run(program: &Program) -> Result<String, String> {
    let mut scenes = Vec::new();
    let mut lines = Vec::new();
    for knot in KNOTS {
        let arguments = format!("--knot {knot} --out {FOLDER}/scenes");
        let scene = format!("{FOLDER}/scenes/statue-{knot}/statue-{knot}.gltf");
        if !Path::new(&scene).exists() {
            make_scenes(&arguments)?;
        }
        lines.push(format!("cargo run --release --example make_scenes -- {arguments}"));
        scenes.push(scene);
    }
    scenes.push(bundled("statue"));
    let sizes: Vec<Size> =
        scenes.iter().map(|scene| measure(program, scene)).collect::<Result<_, _>>()?;
    let pictures: Vec<_> = sizes.iter().map(|size| (&size.sah.picture, 0.0)).collect();
    let largest = sizes.iter().map(|size| size.difference).fold(0.0, f64::max);
    let counts: Vec<_> = sizes.iter().map(|size| size.triangles.len().to_string()).collect();
    let errors = sizes.iter().map(|size| {
        let e = error(&size.sah.picture, &size.reference.picture);
        format!("{} (ε {})", short(e), epsilon(&size.reference.picture))
    });
    let errors: Vec<_> = errors.collect();
    for size in &sizes {
        let shots = [&size.sah, &size.reference].into_iter().chain(&size.shots);
        lines.extend(shots.map(|shot| shot.command.clone()));
    }
    let rows = sizes.iter().flat_map(|size| size.rows.clone());
    let head = [
        "triangles",
        "tree",
        "build, ms",
        "nodes per ray",
        "triangles per ray",
        "time of a frame, ms",
    ];
    Ok(format!(
        "{}\n\
         The statue with {} triangles, of which 1656 are the room and the plinth;\n\
         direct light, {SPP} samples per pixel. {}\n\
         Nodes (of two boxes) and triangles that a camera ray is tested against are counted on the\n\
         processor by the twin of the shaders' traversal, for the {COUNTED}x{COUNTED} rays through the centres of\n\
         pixels; the device itself walks four boxes a node in packets of eight rays where it can, and\n\
         without a tree every ray by itself. A frame is {SIDE}x{SIDE} pixels at one sample per pixel, two rays\n\
         a sample. Builds are processor time too, the geometry alone. The pictures with and without a tree\n\
         (at one sample), and by either split, differ by {} of the mean luminance at most in any pixel.\n\n{}\n\
         Errors of the pictures against {REFERENCE_SPP} samples per pixel of the same scenes: {}.\n\n{}",
        sheet("trees", "Four sizes of the statue", &pictures, 4, 3)?,
        counts.join(", "),
        speed(&sizes[sizes.len() - 1]),
        short(largest),
        table(&head, rows),
        errors.join(", "),
        commands(lines.iter().map(String::as_str)),
    ))
}
