//! E5: segments between surfaces and light samples are met by what is between, and by nothing else.

use crate::common::{Random, Stage, assert_at_most, emitter, lambert, settings};
use crate::probe::segments;
use glam::{Quat, Vec3};
use steradian::scene::Scene;

/// Side of the lamp.
const SIDE: f32 = 1e-3;

/// A square lamp about the origin that faces a floor at `distance`, in a random pose; and
/// rays at the floor.
struct Pair {
    scene: Scene,
    rays: Vec<((Vec3, Vec3), [f32; 2])>,
}

fn pair(random: &mut Random, distance: f32, is_blocked: bool, rays: usize) -> Pair {
    let turn = Quat::from_axis_angle(random.direction(), 6.0 * random.unit());
    let (u, v, down) = (turn * Vec3::X, turn * Vec3::Y, turn * Vec3::Z);
    let mut stage = Stage::perspective(3.0 * distance * down, Vec3::ZERO, 1.0);
    stage.quad(Vec3::ZERO, 0.5 * SIDE * u, 0.5 * SIDE * v, emitter(1.0));
    let half = 0.5 * distance;
    stage.quad(distance * down, half * v, half * u, lambert(0.5));
    if is_blocked {
        // Wider than all segments are there.
        let half = SIDE + 1e-3 * distance;
        stage.quad(1e-3 * distance * down, half * u, half * v, lambert(0.5));
    }
    let ray = |_| {
        let target =
            distance * down + 0.9 * half * (random.in_cube().x * u + random.in_cube().x * v);
        // From the lamp's side, below a blocker.
        let o = target - 0.3 * distance * down + 0.1 * distance * random.in_cube();
        ((o, (target - o).normalize()), [random.unit(), random.unit()])
    };
    let rays = (0..rays).map(ray).collect();
    Pair { scene: stage.scene, rays }
}

/// Of `per_distance` segments for each of nine distances, clear ones that count as blocked and
/// blocked ones that count as clear.
fn check(per_distance: usize) {
    let mut random = Random(30);
    let (mut hidden, mut seen, mut total) = (0.0, 0.0, 0.0);
    for exponent in -4..=4 {
        let distance = 10f32.powi(exponent);
        for is_blocked in [false, true] {
            // Several poses.
            for _ in 0..2 {
                let pair = pair(&mut random, distance, is_blocked, per_distance / 2);
                for f in segments(&pair.scene, &settings(8, 8, 1), &pair.rays) {
                    let Some(is_visible) = f.is_visible() else { continue };
                    total += 1.0;
                    hidden += f64::from(u8::from(!is_visible && !is_blocked));
                    seen += f64::from(u8::from(is_visible && is_blocked));
                }
            }
        }
    }
    assert!(total > 17.0 * per_distance as f64, "only {total} segments");
    let what = |kind: &str| format!("{kind} of {total:e} segments to a lamp of 1e-3 at 1e-4..1e4");
    assert_at_most("E5", &what("clear ones blocked"), hidden, 0.0);
    assert_at_most("E5", &what("blocked ones clear"), seen, 0.0);
}

#[test]
fn e5_segments_to_a_lamp_are_exact() {
    check(1 << 16);
}

#[test]
#[ignore = "tier N: about 1 minute"]
fn e5_ten_million_segments_to_a_lamp_are_exact() {
    check(600_000);
}
