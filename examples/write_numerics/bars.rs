//! What the renderer is held to, and the best that is known of others.

/// A bar and the cases of the catalogue that measure it.
pub(crate) struct Bar {
    pub(crate) number: u32,
    pub(crate) text: &'static str,
    pub(crate) cases: &'static [&'static str],
    pub(crate) elsewhere: &'static str,
}

/// In their order. Those on adaptive sampling and on comparisons of speed are not measured by
/// this catalogue.
pub(crate) const BARS: [Bar; 15] = [
    Bar {
        number: 1,
        text: "no ray leaves a closed mesh through an edge or a vertex, products fused or not",
        cases: &["B1", "B2", "B3"],
        elsewhere: "Embree's own test accepts 2e-5",
    },
    Bar {
        number: 2,
        text: "tree = brute force for every class of rays; shadow rays = nearest hits",
        cases: &["C1", "C2", "C8", "C9", "C10"],
        elsewhere: "",
    },
    Bar {
        number: 3,
        text: "furnaces, cube and sphere, sizes 1e-5 to 1e6: |L - 1| ≤ 1e-3",
        cases: &["E1"],
        elsewhere: "Mitsuba 0.52 at 1e-5, 0.85 at 1e-4; pbrt tests to 2.5e-2",
    },
    Bar {
        number: 4,
        text: "emissive sphere from inside: |L - 1| ≤ 2e-4",
        cases: &["F3"],
        elsewhere: "Mitsuba +1.4e-3 to +1.6e-2",
    },
    Bar {
        number: 5,
        text: "sphere lights, radius over distance 0.9 to 1e-6: irradiance within 1e-3",
        cases: &["F1", "F2"],
        elsewhere: "Mitsuba +7 % at 1e-3, black at 1e-4",
    },
    Bar {
        number: 6,
        text: "floor spheres to R = 1e7: height within 2e-6; distant spheres: no miss to 1e5 radii",
        cases: &["D1", "D2"],
        elsewhere: "the plain quadratic: 1; misses from 1e3",
    },
    Bar {
        number: 7,
        text: "no self-hit in 1e7; offsets of at most 16 ulp; a thin wall lets nothing through",
        cases: &["E2", "E3"],
        elsewhere: "fixed offsets fail at both ends",
    },
    Bar {
        number: 8,
        text: "GGX density within 2e-6; samplers follow their densities; albedos within 1e-3; no weight above 1",
        cases: &["G1", "G3", "G4"],
        elsewhere: "",
    },
    Bar {
        number: 9,
        text: "all strategies, roulette on and off, both samplers: one mean, within 2e-3",
        cases: &["H3"],
        elsewhere: "Mitsuba's z-test excuses 0.25 % of the pixels",
    },
    Bar {
        number: 10,
        text: "series of bounces exact to 1e-3 for 0 to 8 bounces",
        cases: &["H5"],
        elsewhere: "",
    },
    Bar {
        number: 11,
        text: "no sample in 1e9 is negative or not finite",
        cases: &["H6"],
        elsewhere: "pbrt logs them and makes them black",
    },
    Bar {
        number: 12,
        text: "sums of 1e6 samples: constants within 2 ulp, means 5e-6, variances 2e-4",
        cases: &["J1", "J2", "J3", "J4"],
        elsewhere: "sums in f32: 1e-2; 0.6",
    },
    Bar {
        number: 15,
        text: "slope of the error against samples: -1 ± 0.05 down to relMSE 1e-5",
        cases: &["H15"],
        elsewhere: "a plateau is a bias",
    },
    Bar {
        number: 16,
        text: "the same bits: again, by threads, by workgroups, by submissions, for crops",
        cases: &["L1", "L3"],
        elsewhere: "",
    },
    Bar {
        number: 18,
        text: "the device's arithmetic is told in every report",
        cases: &["A1"],
        elsewhere: "",
    },
];

/// Names of the letters.
pub(crate) const LETTERS: [(char, &str); 12] = [
    ('A', "Arithmetic and driver"),
    ('B', "Rays and triangles"),
    ('C', "Boxes and trees"),
    ('D', "Spheres"),
    ('E', "Spawned rays, thin gaps"),
    ('F', "Lights"),
    ('G', "Scattering"),
    ('H', "Integrator"),
    ('I', "Random numbers"),
    ('J', "Accumulation"),
    ('K', "Cameras"),
    ('L', "The same bytes"),
];
