//! Which of a primitive's sets of texture coordinates its vertices carry.

use crate::scene::Material;
use std::collections::BTreeSet;

/// Renames the sets that the material's textures use (TEXCOORD_n) to 0 and 1. Returns n for
/// both, and whether textures of further sets had to be left out.
///
/// Set 0 stays 0, and 1 stays 1, unless two others are used.
pub(super) fn assign(material: &mut Material) -> ([u32; 2], bool) {
    let mut used: BTreeSet<u32> = material.textures().map(|t| t.uv_set).collect();
    let mut sets = [0, 1];
    if let (Some(last), true) = (used.last().copied(), used.iter().any(|&set| set > 1)) {
        // The first textures of a material matter most.
        let mut kept: Vec<u32> = Vec::new();
        for texture in material.textures() {
            if !kept.contains(&texture.uv_set) && kept.len() < 2 {
                kept.push(texture.uv_set);
            }
        }
        kept.sort_unstable();
        sets = match kept[..] {
            [a, b] => [a, b],
            _ => [0, last],
        };
    }
    used.retain(|set| !sets.contains(set));
    for slot in material.texture_slots_mut() {
        let Some(texture) = slot else { continue };
        match sets.iter().position(|&set| set == texture.uv_set) {
            Some(place) => texture.uv_set = place as u32,
            None => *slot = None,
        }
    }
    (sets, !used.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{ColorSpace, TextureRef, Wrap};

    /// The sets of a material's first textures afterwards, those of the vertices, and the flag.
    fn assigned(sets: &[u32]) -> (Vec<Option<u32>>, [u32; 2], bool) {
        let mut material = Material::default();
        for (slot, &uv_set) in material.texture_slots_mut().into_iter().zip(sets) {
            *slot = Some(TextureRef {
                image: 0,
                color_space: ColorSpace::Linear,
                uv_set,
                transform: glam::Affine2::IDENTITY,
                wrap: [Wrap::Repeat; 2],
                nearest: false,
            });
        }
        let (of_vertices, left_out) = assign(&mut material);
        let slots = material.texture_slots_mut();
        let after = slots.iter().take(sets.len()).map(|slot| slot.map(|t| t.uv_set)).collect();
        (after, of_vertices, left_out)
    }

    #[test]
    fn two_sets_of_any_numbers_are_carried() {
        assert_eq!(assigned(&[]), (vec![], [0, 1], false));
        assert_eq!(assigned(&[1]), (vec![Some(1)], [0, 1], false));
        assert_eq!(assigned(&[3, 0]), (vec![Some(1), Some(0)], [0, 3], false));
        assert_eq!(assigned(&[7]), (vec![Some(1)], [0, 7], false));
        assert_eq!(assigned(&[5, 2, 5]), (vec![Some(1), Some(0), Some(1)], [2, 5], false));
    }

    #[test]
    fn a_third_set_is_left_out() {
        let expected = (vec![Some(1), Some(0), None, Some(1)], [1, 4], true);
        assert_eq!(assigned(&[4, 1, 0, 4]), expected);
    }
}
