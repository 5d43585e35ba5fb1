//! The README beside the scenes, with the numbers of what was really written.

use crate::{Kind, Written};

const HEAD: &str = "\
# Scenes

Written by `cargo run --release --example make_scenes` in the repository root, the same bytes
every time; change `examples/make_scenes`, not these files. Everything is glTF 2.0 in metres, so
other programs open it as well. Radiance is in W/(sr m²), linear Rec. 709.

| scene | what it is for | nodes | triangles | KiB | numbers from |
|---|---|---:|---:|---:|---|
";

const TESTS: &str = "
## Known answers (`tests/`)

Every pixel of these has the radiance below, with unlimited bounces. It is also in the file, in
the scene's `extras.steradian.truth`.

| scene | what it tests | radiance | formula |
|---|---|---:|---|
";

const FOOT: &str = "
`cargo run --release --example make_scenes -- --large` writes the statue with 1,020,000 triangles
in the knot to `out/statue-large/`. It is not committed.

An analytic sphere is a mesh with `extras.steradian.sphere.radius`: Steradian traces the exact
sphere, and other programs draw its 2,208 triangles.

## Sources

1. Geometry, camera and reflectance of the light: Cornell University Program of Computer Graphics,
   Cornell Box Data. Millimetres became metres, and the light is 0.5 mm below the ceiling, in which
   there is no hole.
2. Colours: not the measured spectra but the linear RGB values in common use for them, white
   (0.725, 0.71, 0.68), red (0.63, 0.065, 0.05), green (0.14, 0.45, 0.091), light (17, 12, 4)
   W/(sr m²), as in B. Bitterli's rendering resources (2016). The two scenes with spheres have
   twice this light.
3. E. Veach, Robust Monte Carlo Methods for Light Transport Simulation, 1997, figure 9.2; radii of
   the lights and GGX alphas 0.005, 0.02, 0.05, 0.1 as in later digital versions of it.
4. H. Vogel, A better way to construct the sunflower head, Mathematical Biosciences 44, 1979.

The knot, the sunflowers, the stage and its sky, and the hall are made by formulas in `examples/make_scenes`, and
are under the licence of this repository.
";

/// The whole text.
pub(crate) fn text(written: &[Written]) -> String {
    let mut text = HEAD.to_owned();
    for w in written.iter().filter(|w| w.entry.kind == Kind::Picture) {
        let entry = w.entry;
        text += &format!(
            "| [{0}]({0}/{0}.gltf) | {1} | {2} | {3} | {4} | {5} |\n",
            entry.name,
            entry.purpose,
            w.document.node_count(),
            w.triangle_count,
            w.size.div_ceil(1024),
            entry.source,
        );
    }
    text += TESTS;
    for w in written.iter().filter(|w| w.entry.kind == Kind::Test) {
        let truth = w.document.extra_value("truth").expect("every test scene has its truth");
        text += &format!(
            "| [{0}](tests/{0}/{0}.gltf) | {1} | {2} | {3} |\n",
            w.entry.name,
            w.entry.purpose,
            truth["radiance"][0],
            truth["formula"].as_str().unwrap_or_default(),
        );
    }
    text + FOOT
}
