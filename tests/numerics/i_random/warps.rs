//! Uniform numbers and the shapes that they are warped to, against twins in Rust.

use crate::common::{Call, Estimate, Random, assert_at_most, assert_naive_fails, harness};
use glam::{UVec4, Vec3, Vec4};
use steradian::shader::Feature;

const COUNT: usize = 1 << 16;

/// What `numbers.wgsl` writes for an input.
const OUTPUTS: usize = 13;

/// Random bits with a random unit vector; the first ones are poles, axes and their neighbours.
fn inputs() -> Vec<[UVec4; 2]> {
    let mut random = Random(1);
    let mut special = Vec::new();
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        for sign in [1.0, -1.0] {
            for tilt in [0.0, 1e-30, 1e-10, 1e-4, -1e-4, 3e-4] {
                special.push((axis * sign + Vec3::new(tilt, -tilt, tilt)).normalize());
                special.push((axis * sign + Vec3::new(0.0, tilt, -0.0)).normalize());
            }
        }
    }
    // The negative z axis with a zero of either sign, where bases change over.
    special.push(Vec3::new(0.0, 0.0, -1.0));
    special.push(Vec3::new(0.6, -0.8, -0.0));
    let mut word = || random.bits() as u32;
    let bits: Vec<UVec4> = (0..COUNT).map(|_| UVec4::new(word(), word(), word(), word())).collect();
    let normal = |i: usize, random: &mut Random| match special.get(i) {
        Some(n) => *n,
        None => random.direction(),
    };
    let mut random = Random(2);
    let normals: Vec<Vec3> = (0..COUNT).map(|i| normal(i, &mut random)).collect();
    let as_bits = |n: Vec3| UVec4::new(n.x.to_bits(), n.y.to_bits(), n.z.to_bits(), 0);
    bits.into_iter().zip(normals).map(|(b, n)| [b, as_bits(n)]).collect()
}

fn floats(words: UVec4) -> Vec4 {
    Vec4::from(words.to_array().map(f32::from_bits))
}

fn pcg4d(key: UVec4) -> UVec4 {
    let [mut x, mut y, mut z, mut w] =
        key.to_array().map(|k| k.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    for round in 0..2 {
        x = x.wrapping_add(y.wrapping_mul(w));
        y = y.wrapping_add(z.wrapping_mul(x));
        z = z.wrapping_add(x.wrapping_mul(y));
        w = w.wrapping_add(y.wrapping_mul(z));
        if round == 0 {
            [x, y, z, w] = [x, y, z, w].map(|v| v ^ (v >> 16));
        }
    }
    UVec4::new(x, y, z, w)
}

fn owen_hash(reversed: u32, seed: u32) -> u32 {
    let mut x = reversed;
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed).wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

/// Degree, inner coefficients and initial numbers (Joe and Kuo 2008, new-joe-kuo-6).
const POLYNOMIALS: [(usize, u32, &[u32]); 7] = [
    (1, 0, &[1]),
    (2, 1, &[1, 3]),
    (3, 1, &[1, 3, 1]),
    (3, 2, &[1, 1, 1]),
    (4, 1, &[1, 1, 3, 3]),
    (4, 4, &[1, 3, 5, 13]),
    (5, 2, &[1, 1, 5, 5, 17]),
];

/// Coordinate of the point `index`, as a fraction of 2^32, by the recurrence for the odd
/// numbers m: m_k = 2 a_1 m_(k-1) ^ 4 a_2 m_(k-2) ^ ... ^ 2^s m_(k-s) ^ m_(k-s).
fn sobol(dimension: usize, index: u32) -> u32 {
    if dimension == 0 {
        return index.reverse_bits();
    }
    let (s, coefficients, initial) = POLYNOMIALS[dimension - 1];
    let mut m: Vec<u64> = initial.iter().map(|&m| u64::from(m)).collect();
    for k in s..32 {
        let mut next = m[k - s] ^ (m[k - s] << s);
        for j in 1..s {
            if coefficients >> (s - 1 - j) & 1 == 1 {
                next ^= m[k - j] << j;
            }
        }
        m.push(next);
    }
    (0..32).filter(|k| index >> k & 1 == 1).fold(0, |x, k| x ^ (m[k] << (31 - k)) as u32)
}

/// Coordinates of dimensions from `first` on, scrambled with one seed each.
pub(super) fn scrambled(first: usize, index: u32, seeds: &[u32]) -> Vec<f32> {
    let one = |(k, seed): (usize, &u32)| {
        let bits = owen_hash(sobol(first + k, index).reverse_bits(), *seed).reverse_bits();
        (bits >> 8) as f32 / 16_777_216.0
    };
    seeds.iter().enumerate().map(one).collect()
}

fn length_error(v: Vec3) -> f64 {
    (v.as_dvec3().length() - 1.0).abs()
}

#[test]
fn i4_numbers_and_shapes_are_those_of_their_twins() {
    let inputs = inputs();
    let outputs: Vec<UVec4> =
        Call::new(harness!("numbers"), &[Feature::Sobol]).run(&inputs, OUTPUTS);
    for ([bits, normal], out) in inputs.iter().zip(outputs.chunks_exact(OUTPUTS)) {
        // Integers and their scaling are exact.
        assert_eq!(out[0], pcg4d(*bits));
        let u = bits.to_array().map(|b| (b >> 8) as f32 / 16_777_216.0);
        assert_eq!(floats(out[1]).to_array(), u);
        assert!(u.iter().all(|u| (0.0..1.0).contains(u)));
        let seeds = bits.to_array();
        assert_eq!(floats(out[9]).to_array().to_vec(), scrambled(0, bits.x, &seeds));
        assert_eq!(floats(out[10]).to_array().to_vec(), scrambled(4, bits.x, &seeds));
        assert_eq!(floats(out[11]).to_array()[..2].to_vec(), scrambled(0, bits.x, &seeds[2..]));
        let shuffled = owen_hash(bits.x.reverse_bits(), bits.y).reverse_bits();
        assert_eq!([out[12].x, out[12].y], [owen_hash(bits.x, bits.y), shuffled]);

        // Rounding of a few operations of size 1, and the 8e-8 of sin and cos.
        const ROUNDING: f64 = 1e-6;
        let [x, y, b, c] = floats(out[2]).to_array();
        assert!(f64::from(x).hypot(f64::from(y)) <= 1.0 + ROUNDING, "disk {x} {y}");
        assert!(b >= 0.0 && c >= 0.0 && b + c <= 1.0 + ROUNDING as f32, "triangle {b} {c}");
        for (slot, is_hemisphere) in [(3, true), (4, true), (5, false)] {
            let v = floats(out[slot]).truncate();
            assert!(length_error(v) <= ROUNDING, "warp {slot}: {v} of {u:?}");
            assert!(!is_hemisphere || v.z >= 0.0, "warp {slot}: {v}");
        }

        let n = floats(*normal).truncate();
        let [t, b, z] = [6, 7, 8].map(|k| floats(out[k]).truncate());
        assert_eq!(z, n);
        let (td, bd, nd) = (t.as_dvec3(), b.as_dvec3(), n.as_dvec3());
        for error in [length_error(t), length_error(b), td.dot(bd), td.dot(nd), bd.dot(nd)] {
            assert!(error.abs() <= ROUNDING, "frame of {n}: {t} {b}");
        }
        assert!(td.cross(bd).dot(nd) > 0.0, "left-handed frame of {n}");

        // On the negative x axis a zero may lose its sign on the way: π and -π are one angle.
        let angle = f64::from(floats(out[6]).w);
        let error = (angle - f64::from(n.y).atan2(f64::from(n.x))).abs();
        let error = error.min((error - std::f64::consts::TAU).abs());
        assert!(n.x == 0.0 && n.y == 0.0 || error <= ROUNDING, "atan2 of {n}: {angle}");
    }
}

/// Means of the warps over many inputs: of z for the hemispheres 2/3 and 1/2, of x² + y² for the
/// disk 1/2, of the sphere's coordinates 0.
#[test]
fn i4_warps_have_the_densities_that_they_claim() {
    let inputs = inputs();
    let outputs: Vec<UVec4> =
        Call::new(harness!("numbers"), &[Feature::Sobol]).run(&inputs, OUTPUTS);
    let check = |what: &str, of: &dyn Fn(&[UVec4]) -> f32, expected: f64| {
        let values: Vec<f64> = outputs.chunks_exact(OUTPUTS).map(|o| f64::from(of(o))).collect();
        let e = Estimate::of(&values);
        assert!((e.mean - expected).abs() <= 3.9 * e.standard_error, "{what}: {e:?}");
    };
    check("cosine", &|o| floats(o[3]).z, 2.0 / 3.0);
    check("cosine, z²", &|o| floats(o[3]).z.powi(2), 0.5);
    check("uniform", &|o| floats(o[4]).z, 0.5);
    check("uniform, z²", &|o| floats(o[4]).z.powi(2), 1.0 / 3.0);
    check("disk", &|o| floats(o[2]).truncate().truncate().length_squared(), 0.5);
    check("disk, x", &|o| floats(o[2]).x, 0.0);
    check("disk, x²", &|o| floats(o[2]).x.powi(2), 0.25);
    check("triangle", &|o| floats(o[2]).z, 1.0 / 3.0);
    check("triangle, square", &|o| floats(o[2]).w.powi(2), 1.0 / 6.0);
    for k in 0..3 {
        check("sphere", &|o| floats(o[5])[k], 0.0);
        check("sphere, square", &|o| floats(o[5])[k].powi(2), 1.0 / 3.0);
    }
}

/// The words that become 1 when all their bits are converted, through every warp: both numbers of
/// a pair at the end of the interval, and one of them at its beginning.
#[test]
fn i4_no_uniform_number_is_one() {
    let words = || (0..256).map(|i| 0xFFFF_FF00 + i);
    let pair = |x: u32, y: u32| [UVec4::new(x, y, x, y), UVec4::new(0, 0, 1.0_f32.to_bits(), 0)];
    let mut inputs: Vec<_> = words().flat_map(|x| words().map(move |y| pair(x, y))).collect();
    inputs.extend(words().map(|x| pair(x, 0)));
    inputs.extend(words().map(|y| pair(0, y)));
    let outputs: Vec<UVec4> =
        Call::new(harness!("numbers"), &[Feature::Sobol]).run(&inputs, OUTPUTS);
    let (mut ones, mut broken, mut outside) = (0, 0, 0);
    for out in outputs.chunks_exact(OUTPUTS) {
        let uniforms = [1, 9, 10, 11].map(|slot| floats(out[slot]).to_array());
        ones += uniforms.iter().flatten().filter(|u| !(0.0..1.0).contains(*u)).count();
        let shapes = || (2..6).map(|slot| floats(out[slot]));
        broken += shapes().filter(|v| !v.is_finite()).count();
        // The disk, the second and third weights in the triangle, the hemispheres.
        let [x, y, b, c] = floats(out[2]).to_array();
        let is_inside = x.hypot(y) <= 1.0 + 1e-6 && b >= 0.0 && c >= 0.0 && b + c <= 1.0 + 1e-6;
        outside += usize::from(!is_inside || floats(out[3]).z < 0.0 || floats(out[4]).z < 0.0);
    }
    let what = "256 top words in pairs";
    assert_at_most("I4", &format!("{what}: uniform numbers not below 1"), ones as f64, 0.0);
    assert_at_most("I4", &format!("{what}: warps not finite"), broken as f64, 0.0);
    assert_at_most("I4", &format!("{what}: warps outside their shape"), outside as f64, 0.0);
    let naive = words().filter(|&w| w as f32 * 2.0_f32.powi(-32) >= 1.0).count() as f64;
    assert_naive_fails("I4", "f32(word) / 2^32: top words that give 1", naive, 128.0);
}
