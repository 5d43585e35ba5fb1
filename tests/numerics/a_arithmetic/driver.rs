//! What the device's compiler makes of arithmetic.

use crate::common::{Call, Stage, assert_at_most, emitter, harness, report, settings, with_device};
use glam::{Vec3, Vec4};
use steradian::passes::FloatEnvironment;
use steradian::settings::Accel;
use steradian::shader::library;

/// Two words of `tests/shaders/arithmetic.wgsl` for each input.
fn arithmetic(inputs: &[Vec4]) -> Vec<[Vec4; 2]> {
    let mut padded = inputs.to_vec();
    padded.resize(inputs.len().next_multiple_of(64), Vec4::ZERO);
    let mut outputs: Vec<[Vec4; 2]> = Call::new(harness!("arithmetic"), &[]).run(&padded, 1);
    outputs.truncate(inputs.len());
    outputs
}

/// The classification is the one that the arithmetic harness sees for itself.
#[test]
fn a1_the_float_environment_is_what_the_device_does() {
    let environment = with_device(|device| FloatEnvironment::of(&device).unwrap());
    println!("float environment {environment}");
    let [sums, classes] = arithmetic(&[Vec4::new(1e10, 1e-10, 0.0, 0.0)])[0];
    let [nan, _] = [f32::NAN, 0.0].map(|x| arithmetic(&[Vec4::new(x, 0.0, 0.0, 0.0)])[0][1].y);
    assert_eq!(classes.y, 0.0);
    assert_eq!(environment.compares_nan, nan == 1.0);
    if sums.x != 1e-10 {
        assert!(environment.reassociates);
    }
    report("A1", "sums are reordered (1: yes)", f64::from(u8::from(environment.reassociates)));
    report("A1", "products are contracted (1: yes)", f64::from(u8::from(environment.contracts)));
}

/// Behind a barrier that no compiler sees through, error-free sums are what they should be.
#[test]
fn a2_compensated_sums_survive_behind_a_barrier_alone() {
    let two_sum = arithmetic(&[Vec4::new(1e10, 1e-10, 0.0, 0.0)])[0][0];
    let kahan = arithmetic(&[Vec4::new(16_777_216.0, 1.0, 0.0, 100.0)])[0][0];
    assert_at_most(
        "A2",
        "error of TwoSum's error term, barrier",
        f64::from((two_sum.y - 1e-10).abs()),
        0.0,
    );
    assert_at_most(
        "A2",
        "error of Kahan's sum of 2^24 + 100, barrier",
        f64::from((kahan.w - 16_777_316.0).abs()),
        0.0,
    );
    // A device may keep the order: then the plain sums are right too.
    report(
        "A2",
        "error of Kahan's sum of 2^24 + 100, plain",
        f64::from((kahan.z - 16_777_316.0).abs()),
    );
}

/// Whether a line holds `x != x` or `x == x`, for some name x.
fn compares_with_itself(code: &str) -> bool {
    ["!=", "=="].iter().any(|operator| {
        let mut sides = code.split(operator).map(str::trim);
        let left = sides.next().and_then(|s| s.rsplit([' ', '(']).next());
        let right = sides.next().and_then(|s| s.split([' ', ')', ';']).next());
        left.is_some_and(|l| !l.is_empty()) && left == right
    })
}

/// No module does what the language does not promise: compensated sums, comparisons that are
/// there for NaN, and functions of thousands of units in the last place.
#[test]
fn a1_the_shaders_rely_on_nothing_that_may_be_missing() {
    let forbidden = [
        ("fma(", "may be two roundings"),
        ("acos(", "is coarse on some devices"),
        ("asin(", "is coarse on some devices"),
        ("atan(", "is coarse on some devices"),
        ("atan2(", "is coarse on some devices"),
        ("exp(", "is coarse on some devices"),
        ("log(", "is coarse on some devices"),
        ("isNan", "is not in the language"),
        ("f32(0xffffffff", "rounds to 2^32"),
    ];
    // Decoding sRGB is no part of an estimator: its error is a texel's, below 2^-8 of a step.
    let allowed = [("material/texture", "pow("), ("float_environment", "fma(")];
    let mut found = Vec::new();
    for (path, text) in &library() {
        for (number, line) in text.lines().enumerate() {
            let code = line.split("//").next().unwrap_or_default();
            let calls = |name: &str| {
                code.match_indices(name)
                    .any(|(at, _)| !code[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_'))
            };
            for (name, reason) in forbidden.iter().chain(&[("pow(", "is exp2 of a product")]) {
                if calls(name) && !allowed.contains(&(*path, name)) {
                    found.push(format!("{path}.wgsl:{}: {name} {reason}", number + 1));
                }
            }
            if *path != "float_environment" && compares_with_itself(code) {
                found.push(format!("{path}.wgsl:{}: compares with itself", number + 1));
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
    assert!(compares_with_itself("    if x != x {") && !compares_with_itself("if x != y {"));
}

#[test]
fn a3_finiteness_is_told_by_bits() {
    let values = [
        (f32::NAN, false),
        (-f32::NAN, false),
        (f32::INFINITY, false),
        (f32::NEG_INFINITY, false),
        (f32::MAX, true),
        (1e-40, true),
        (-0.0, true),
        (1.0, true),
    ];
    let outputs = arithmetic(&values.map(|(x, _)| Vec4::new(x, 0.0, 0.0, 0.0)));
    let right = values.iter().zip(&outputs).filter(|((_, finite), o)| (o[1].x == 1.0) == *finite);
    assert_at_most(
        "A3",
        "values of 8 classified wrongly, by bits",
        (8 - right.count()) as f64,
        0.0,
    );
    let seen = outputs.iter().filter(|o| o[1].y == 1.0).count();
    report("A3", "NaN of 2 seen by comparison", seen as f64);
    // Clamping turns NaN into a number on some devices: it must not be what keeps NaN out.
    report("A3", "what clamp(NaN, 0, 1) gives", f64::from(outputs[0][1].z));
}

/// Rays with components that are not finite come back, as misses, from tree and list.
#[test]
fn a7_broken_rays_miss() {
    let mut stage = Stage::perspective(Vec3::Z * 3.0, Vec3::ZERO, 1.0);
    stage.sphere(Vec3::ZERO, 1.0, emitter(1.0));
    for i in 0..40 {
        let at = Vec3::new((i % 7) as f32 - 3.0, (i % 5) as f32 - 2.0, -(i as f32));
        stage.quad(at, Vec3::X, Vec3::Y, emitter(1.0));
    }
    let broken = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    let mut inputs: Vec<[Vec4; 2]> = Vec::new();
    for i in 0..1 << 17_u32 {
        let mut ray = [0.1, 0.2, 5.0, 0.01, -0.02, -1.0_f32];
        // Each way to have one, two or all six components broken, in turn.
        for (k, component) in ray.iter_mut().enumerate() {
            if (i % 63 + 1) >> k & 1 == 1 {
                *component = broken[(i / 63 + k as u32) as usize % 3];
            }
        }
        inputs
            .push([Vec4::new(ray[0], ray[1], ray[2], 0.0), Vec4::new(ray[3], ray[4], ray[5], 0.0)]);
    }
    for accel in [Accel::Bvh, Accel::None] {
        let settings = steradian::RenderSettings { accel, ..settings(8, 8, 1) };
        let call = Call::new(harness!("stray_rays"), &[]).on(&stage.scene, &settings);
        let outputs: Vec<[u32; 4]> = call.run(&inputs, 1);
        let hits = outputs.iter().filter(|o| o[0] != u32::MAX || o[1] != 0).count();
        let faults = outputs.iter().filter(|o| o[2] != 0).count();
        let what = format!("of 131,072 broken rays, accel {accel:?}: hits");
        assert_at_most("A7", &what, hits as f64, 0.0);
        assert_eq!(faults, 0);
        // The same rays unbroken do hit.
        let whole = [Vec4::new(0.1, 0.2, 5.0, 0.0), Vec4::new(0.01, -0.02, -1.0, 0.0)];
        let outputs: Vec<[u32; 4]> = call.run(&[whole; 64], 1);
        assert!(outputs.iter().all(|o| o[0] != u32::MAX && o[1] == 1));
    }
}
