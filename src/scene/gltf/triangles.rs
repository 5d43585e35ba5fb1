//! Triangle lists, strips and fans as indexed triangles.

use glam::{DVec3, Vec3};
use gltf::json::mesh::Mode;

/// Triangles of a primitive and how many indices were left over.
pub(super) struct Assembled {
    pub(super) triangles: Vec<[u32; 3]>,
    /// Indices at the end of a list that make no whole triangle.
    pub(super) left_over: usize,
}

/// Triangles without area, which nothing hits.
pub(super) fn count_degenerate(triangles: &[[u32; 3]], positions: &[Vec3]) -> usize {
    let is_degenerate = |triangle: &&[u32; 3]| {
        let [a, b, c] = triangle.map(|i| positions[i as usize].as_dvec3());
        (b - a).cross(c - a) == DVec3::ZERO
    };
    triangles.iter().filter(is_degenerate).count()
}

/// Assembles a primitive's triangles (glTF 2.0, 3.7.2.1). Degenerate triangles
/// are kept: nothing hits them. `None` for points and lines.
pub(super) fn assemble(mode: Mode, indices: &[u32]) -> Option<Assembled> {
    let triangles = match mode {
        Mode::Triangles => {
            let (triangles, rest) = indices.as_chunks();
            return Some(Assembled { triangles: triangles.to_vec(), left_over: rest.len() });
        }
        // Every other triangle of a strip is turned round, so that all face the same way.
        Mode::TriangleStrip => (indices.windows(3).enumerate())
            .map(|(i, w)| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[0], w[2], w[1]] })
            .collect(),
        Mode::TriangleFan => match indices {
            [center, rim @ ..] => rim.windows(2).map(|w| [w[0], w[1], *center]).collect(),
            [] => Vec::new(),
        },
        Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => return None,
    };
    let left_over = if triangles.is_empty() { indices.len() } else { 0 };
    Some(Assembled { triangles, left_over })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangles(mode: Mode, count: u32) -> Vec<[u32; 3]> {
        let indices: Vec<u32> = (0..count).collect();
        assemble(mode, &indices).unwrap().triangles
    }

    #[test]
    fn strips_and_fans_follow_the_specification() {
        let strip = triangles(Mode::TriangleStrip, 5);
        assert_eq!(strip, [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
        assert_eq!(triangles(Mode::TriangleFan, 4), [[1, 2, 0], [2, 3, 0]]);
        assert_eq!(triangles(Mode::Triangles, 7), [[0, 1, 2], [3, 4, 5]]);
    }

    #[test]
    fn what_makes_no_triangle_is_counted() {
        let left_over = |mode, indices: &[u32]| assemble(mode, indices).unwrap().left_over;
        assert_eq!(left_over(Mode::Triangles, &[0, 1, 2, 3]), 1);
        assert_eq!(left_over(Mode::TriangleStrip, &[0, 1]), 2);
        assert_eq!(left_over(Mode::TriangleFan, &[0]), 1);
        assert_eq!(left_over(Mode::TriangleFan, &[]), 0);
        assert!(assemble(Mode::Lines, &[0, 1, 2]).is_none());
    }
}
