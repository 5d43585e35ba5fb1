//! Rays against spheres.

use crate::{Random, harness, run};
use glam::Vec4;
use steradian::bvh::{sphere_hit, sphere_hit_anchored};
use steradian::shader::Feature;

/// Units in the last place by which device and host may differ where both divide:
/// WGSL allows 2.5 for a quotient.
const ULPS: f32 = 8.0 * f32::EPSILON;

#[test]
fn spheres_as_on_the_host() {
    let mut random = Random(5);
    let inputs: Vec<[Vec4; 5]> = (0..1 << 16)
        .map(|i| {
            // From inside, from near and from far; up to a floor of 1e6.
            let radius = [0.3_f32, 1.0, 1e3, 1e6][i % 4];
            let normal = random.direction();
            let anchor = random.in_cube();
            let center = anchor - normal * radius;
            let (o, d) = (random.in_cube() * 3.0, random.in_cube());
            let anchor_normal = normal.extend(1.0 / radius);
            [o.extend(0.0), d.extend(0.0), center.extend(radius), anchor.extend(0.0), anchor_normal]
        })
        .collect();
    let features = [Feature::Spheres, Feature::AnchoredSpheres];
    let outputs: Vec<[f32; 2]> = run(harness!("sphere"), &features, &inputs, 1);
    let mut hit_count = 0;
    for (input, out) in inputs.iter().zip(outputs) {
        let [o, d, sphere, anchor, normal] = *input;
        let (o3, d3) = (o.truncate(), d.truncate());
        let hosts = [
            sphere_hit(o3, d3, sphere.truncate(), sphere.w, f32::MAX),
            sphere_hit_anchored(o3, d3, anchor.truncate(), normal.truncate(), normal.w, f32::MAX),
        ];
        for (device, host) in out.into_iter().zip(hosts) {
            assert_eq!(device < f32::MAX, host.is_some(), "{input:?}: {device} {host:?}");
            let Some(host) = host else { continue };
            hit_count += 1;
            assert!((device - host).abs() <= ULPS * host, "{input:?}: {device} {host}");
        }
    }
    assert!(hit_count > 10_000);
}
