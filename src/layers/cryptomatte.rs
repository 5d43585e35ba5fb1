//! Cryptomatte 1.2 (Friedman and Jones 2015, and their specification): for each pixel the names
//! that cover most of it, as hashes, each with its share.

use crate::image::{Attribute, ChannelData, Layer};
use std::collections::BTreeMap;

/// Pairs of a name and its share in a layer of four channels.
const PAIRS: usize = 2;
/// Layers: six names a pixel. What covers less than the six first is in none.
const LEVELS: usize = 3;

/// Names of one kind of thing, and the shares of the pixels so far.
pub(super) struct Cryptomatte {
    /// Without its number: `CryptoObject`.
    name: &'static str,
    /// Of each thing's name; several things may have one.
    hashes: Vec<u32>,
    manifest: BTreeMap<String, String>,
    /// Id and share of the first name, then of the second, and so on; one value for each pixel.
    ranks: [Vec<f32>; 2 * PAIRS * LEVELS],
    /// Hashes of the pixel in hand with their rays.
    of_pixel: Vec<(u32, u32)>,
}

impl Cryptomatte {
    pub(super) fn new<'a>(name: &'static str, things: impl Iterator<Item = &'a str>) -> Self {
        let mut manifest = BTreeMap::new();
        let hashes = things.map(|thing| {
            let hash = float_of_hash(murmur3(thing.as_bytes())).to_bits();
            manifest.insert(thing.to_owned(), format!("{hash:08x}"));
            hash
        });
        let hashes = hashes.collect();
        let ranks = std::array::from_fn(|_| Vec::new());
        Self { name, hashes, manifest, ranks, of_pixel: Vec::new() }
    }

    /// Adds the next pixel, by the things that its rays met.
    pub(super) fn add(&mut self, things: impl ExactSizeIterator<Item = Option<u32>>) {
        let share = 1.0 / things.len() as f32;
        self.of_pixel.clear();
        for hash in things.flatten().map(|thing| self.hashes[thing as usize]) {
            match self.of_pixel.iter_mut().find(|(met, _)| *met == hash) {
                Some((_, rays)) => *rays += 1,
                None => self.of_pixel.push((hash, 1)),
            }
        }
        self.of_pixel.sort_unstable_by_key(|&(hash, rays)| (std::cmp::Reverse(rays), hash));
        for (k, pair) in self.ranks.chunks_exact_mut(2).enumerate() {
            let (hash, rays) = self.of_pixel.get(k).copied().unwrap_or_default();
            pair[0].push(f32::from_bits(hash));
            pair[1].push(rays as f32 * share);
        }
    }

    /// The layers of the pixels that were added, and none of them left.
    pub(super) fn take_layers(&mut self) -> Vec<Layer> {
        let mut ranks = std::mem::replace(&mut self.ranks, std::array::from_fn(|_| Vec::new()));
        let of_level = |(level, ranks): (usize, &mut [Vec<f32>])| {
            let channels = ["r", "g", "b", "a"].into_iter().zip(ranks);
            let channels = channels
                .map(|(name, values)| (name.to_owned(), ChannelData::F32(std::mem::take(values))));
            Layer { name: format!("{}{level:02}", self.name), channels: channels.collect() }
        };
        ranks.chunks_exact_mut(2 * PAIRS).enumerate().map(of_level).collect()
    }

    /// What tells readers of the layers.
    pub(super) fn metadata(&self) -> Vec<(String, Attribute)> {
        let key = &format!("{:08x}", murmur3(self.name.as_bytes()))[..7];
        // A map of strings has a JSON form.
        let manifest = serde_json::to_string(&self.manifest).unwrap_or_default();
        let entries = [
            ("name", self.name),
            ("hash", "MurmurHash3_32"),
            ("conversion", "uint32_to_float32"),
            ("manifest", &manifest),
        ];
        let entry = |(name, value): (&str, &str)| {
            (format!("cryptomatte/{key}/{name}"), Attribute::Text(value.into()))
        };
        entries.map(entry).into()
    }
}

/// The number whose bits are the hash; where they would be an infinity, no number, zero or a
/// subnormal one, with the lowest bit of the exponent turned (`uint32_to_float32`).
pub fn float_of_hash(hash: u32) -> f32 {
    const EXPONENT: u32 = 0xFF;
    const MANTISSA_BITS: u32 = 23;
    let is_special = matches!(hash >> MANTISSA_BITS & EXPONENT, 0 | EXPONENT);
    f32::from_bits(if is_special { hash ^ 1 << MANTISSA_BITS } else { hash })
}

/// MurmurHash3_x86_32 with a seed of 0 (A. Appleby).
pub fn murmur3(bytes: &[u8]) -> u32 {
    let scramble = |k: u32| k.wrapping_mul(0xCC9E_2D51).rotate_left(15).wrapping_mul(0x1B87_3593);
    let words = bytes.chunks_exact(4);
    // The bytes that fill no word, lowest first.
    let rest = words.remainder().iter().rev().fold(0, |k, &byte| k << 8 | u32::from(byte));
    let hash = words.fold(0_u32, |hash, word| {
        let word = word.iter().rev().fold(0, |k, &byte| k << 8 | u32::from(byte));
        (hash ^ scramble(word)).rotate_left(13).wrapping_mul(5).wrapping_add(0xE654_6B64)
    });
    let h = hash ^ scramble(rest) ^ bytes.len() as u32;
    let h = (h ^ h >> 16).wrapping_mul(0x85EB_CA6B);
    let h = (h ^ h >> 13).wrapping_mul(0xC2B2_AE35);
    h ^ h >> 16
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By the Python package mmh3, which wraps the reference implementation.
    #[test]
    fn hashes_are_those_of_the_reference() {
        let cases: [(&str, u32); 5] = [
            ("", 0),
            ("aaaa", 0x7eee_d987),
            ("abc", 0xb3dd_93fa),
            ("Hello, world!", 0xc036_3e43),
            ("The quick brown fox jumps over the lazy dog", 0x2e4f_f723),
        ];
        for (text, hash) in &cases {
            assert_eq!(murmur3(text.as_bytes()), *hash, "{text}");
        }
    }

    #[test]
    fn every_hash_is_a_normal_number() {
        assert_eq!(float_of_hash(0x3f80_0000), 1.0);
        assert_eq!(float_of_hash(0).to_bits(), 1 << 23);
        assert_eq!(float_of_hash(0x7f80_0001).to_bits(), 0x7f00_0001);
        assert_eq!(float_of_hash(0x8000_0005).to_bits(), 0x8080_0005);
        for high in 0..512_u32 {
            assert!(float_of_hash(high << 23 | 0x12_3456).is_normal(), "{high}");
        }
    }

    fn floats(layers: &[Layer], layer: usize, channel: usize) -> Vec<f32> {
        let ChannelData::F32(values) = &layers[layer].channels[channel].1 else { panic!() };
        values.clone()
    }

    #[test]
    fn names_are_ranked_by_their_share() {
        let names = ["a", "b", "a", "c", "d", "e", "f", "g"];
        let mut matte = Cryptomatte::new("CryptoObject", names.into_iter());
        let id = |name: &str| float_of_hash(murmur3(name.as_bytes()));
        // Two things of the name a cover half; b a quarter; nothing the rest.
        matte.add([0, 2, 1, u32::MAX].map(|k| (k != u32::MAX).then_some(k)).into_iter());
        matte.add([None; 4].into_iter());
        matte.add([7, 6, 5, 4, 3, 1, 0, 0].map(Some).into_iter());
        let layers = matte.take_layers();
        assert_eq!(
            layers.iter().map(|l| &l.name[..]).collect::<Vec<_>>(),
            ["CryptoObject00", "CryptoObject01", "CryptoObject02"]
        );
        assert_eq!(floats(&layers, 0, 0), [id("a"), 0.0, id("a")]);
        assert_eq!(floats(&layers, 0, 1), [0.5, 0.0, 0.25]);
        assert_eq!(floats(&layers, 0, 2)[..2], [id("b"), 0.0]);
        assert_eq!(floats(&layers, 0, 3), [0.25, 0.0, 0.125]);
        // Seven names: the last is in no rank.
        assert_eq!(floats(&layers, 2, 3), [0.0, 0.0, 0.125]);
        assert!(floats(&matte.take_layers(), 0, 0).is_empty());
    }

    #[test]
    fn the_key_and_the_manifest_are_those_of_the_specification() {
        // The key of this name in the specification's own examples.
        let metadata = Cryptomatte::new("uCryptoObject", ["box \"1\""].into_iter()).metadata();
        assert_eq!(metadata[0].0, "cryptomatte/ae93ba3/name");
        let manifest = r#"{"box \"1\"":"f049d8d0"}"#;
        assert_eq!(metadata[3].1, Attribute::Text(manifest.into()));
    }
}
