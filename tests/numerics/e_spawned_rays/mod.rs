//! Rays that leave surfaces: self-intersection, leaks and thin gaps.

mod contact;
mod furnaces;
mod glass;
mod naive;
mod segments;
mod self_hits;
mod walls;

use crate::common::Stage;
use glam::{Affine3A, Vec3};
use steradian::scene::{Material, Mesh};

/// A cube of this side about `center`: 12 triangles that share their corners, fronts inside.
fn cube(stage: &mut Stage, center: Vec3, side: f32, material: Material) {
    let corner = |k: u32| {
        let pick = |bit: u32| if k >> bit & 1 == 0 { -0.5 } else { 0.5 };
        center + side * Vec3::new(pick(0), pick(1), pick(2))
    };
    let faces =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let mesh = Mesh {
        positions: (0..8).map(corner).collect(),
        triangles: faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
        ..Mesh::default()
    };
    let mesh = stage.mesh(mesh, material);
    stage.place(mesh, Affine3A::IDENTITY);
}
