//! Makes normals and tangents of a file unit length.

use glam::{Vec3, Vec4, Vec4Swizzles};

/// Difference of a length from 1 that three normalised bytes, each off by half a step, can make.
const LENGTH_TOLERANCE: f32 = 0.0069;

/// What was done to normals.
pub(super) struct Normalized {
    /// Normals without direction.
    pub(super) replaced: usize,
    /// Normals of another length than 1.
    pub(super) scaled: usize,
}

/// Normalises in place. A normal without direction (zero, NaN or infinite) is
/// replaced by the average of the adjacent faces' normals, weighted by area.
pub(super) fn normalize(
    normals: &mut [Vec3],
    positions: &[Vec3],
    triangles: &[[u32; 3]],
) -> Normalized {
    let mut broken = vec![false; normals.len()];
    let mut scaled = 0;
    for (normal, is_broken) in normals.iter_mut().zip(&mut broken) {
        match unit(*normal) {
            Some(direction) => {
                let length = normal.length();
                scaled += usize::from((length - 1.0).abs() > LENGTH_TOLERANCE);
                *normal = direction;
            }
            None => *is_broken = true,
        }
    }
    let replaced = broken.iter().filter(|&&is_broken| is_broken).count();
    if replaced == 0 {
        return Normalized { replaced, scaled };
    }
    // In double precision the squares of small faces do not vanish.
    let mut sums = vec![glam::DVec3::ZERO; normals.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|i| positions[i as usize].as_dvec3());
        for &i in triangle {
            sums[i as usize] += (b - a).cross(c - a);
        }
    }
    for ((normal, is_broken), sum) in normals.iter_mut().zip(broken).zip(sums) {
        if is_broken {
            // A vertex of degenerate faces alone is never seen; any unit vector does.
            *normal = sum.try_normalize().map_or(Vec3::Y, |n| n.as_vec3());
        }
    }
    Normalized { replaced, scaled }
}

/// Normalises in place, and w to a sign. False if a tangent has no direction.
pub(super) fn normalize_tangents(tangents: &mut [Vec4]) -> bool {
    tangents.iter_mut().all(|tangent| {
        let Some(direction) = unit(tangent.xyz()).filter(|_| !tangent.w.is_nan()) else {
            return false;
        };
        *tangent = direction.extend(1.0_f32.copysign(tangent.w));
        true
    })
}

/// Unit vector, also where the squares overflow or vanish in f32.
fn unit(v: Vec3) -> Option<Vec3> {
    v.as_dvec3().try_normalize().map(|n| n.as_vec3())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn broken_normals_become_the_average_of_their_faces() {
        let positions = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let mut normals = [Vec3::ZERO, Vec3::new(f32::NAN, 0.0, 0.0), Vec3::X * 1e-30];
        let done = normalize(&mut normals, &positions, &[[0, 1, 2]]);
        assert_eq!((done.replaced, done.scaled), (2, 1));
        assert_eq!(normals, [Vec3::Z, Vec3::Z, Vec3::X]);
    }

    #[test]
    fn a_vertex_without_area_still_gets_a_unit_normal() {
        let mut normals = [Vec3::ZERO; 3];
        assert_eq!(normalize(&mut normals, &[Vec3::ONE; 3], &[[0, 1, 2]]).replaced, 3);
        assert!(normals.iter().all(|n| n.is_normalized()));
    }

    #[test]
    fn tangents_keep_their_sign_or_are_refused() {
        let mut tangents = [Vec4::new(2.0, 0.0, 0.0, -0.9)];
        assert!(normalize_tangents(&mut tangents));
        assert_eq!(tangents[0], Vec4::new(1.0, 0.0, 0.0, -1.0));
        assert!(!normalize_tangents(&mut [Vec4::W]));
    }
}
