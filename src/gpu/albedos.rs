//! Directional albedos of lobes that have no closed form: the tables of
//! `bsdf/albedo_tables.wgsl`, by quadrature.

use crate::shader::generated::{ALBEDO_TABLE_LEAST, ALBEDO_TABLE_SIDE};
use crate::shader::{Feature, Features};
use std::f64::consts::PI;
use std::sync::LazyLock;

const SIDE: usize = ALBEDO_TABLE_SIDE as usize;

/// Sheen's table, then GGX's; zeros where `features` reads none.
pub(super) fn build(features: Features) -> Vec<f32> {
    static SHEEN: LazyLock<Vec<f32>> = LazyLock::new(|| table(|alpha| alpha.sqrt(), sheen));
    static GGX: LazyLock<Vec<f32>> = LazyLock::new(|| table(|alpha| alpha, ggx));
    let zeros = || vec![0.0; SIDE * SIDE];
    let mut values = if features.has(Feature::Sheen) { SHEEN.clone() } else { zeros() };
    values.extend(if features.has(Feature::EnergyCompensation) { GGX.clone() } else { zeros() });
    values
}

/// Rows by the fourth root of alpha, columns by the cube root of cos (1 + w) / (cos + w), where
/// `width` gives w of alpha.
fn table(width: impl Fn(f64) -> f64, albedo: impl Fn(f64, f64) -> f64) -> Vec<f32> {
    let place = |k: usize| k as f64 / (SIDE - 1) as f64;
    let least = f64::from(ALBEDO_TABLE_LEAST);
    let mut values = Vec::with_capacity(SIDE * SIDE);
    for row in 0..SIDE {
        let alpha = (least + place(row) * (1.0 - least)).powi(4);
        let w = width(alpha);
        for column in 0..SIDE {
            let x = place(column).powi(3);
            // At 0 the limit, which no surface point has: its cosine is 1e-4 at least.
            let cosine = (w * x / (1.0 + w - x)).clamp(1e-5, 1.0);
            values.push(albedo(cosine, alpha) as f32);
        }
    }
    values
}

/// Nodes and weights of Gauss's rule on [0, 1] of eight points, on `panels` panels.
fn rule(panels: usize) -> Vec<(f64, f64)> {
    const NODES: [(f64, f64); 4] = [
        (0.183_434_642_495_649_8, 0.362_683_783_378_362),
        (0.525_532_409_916_329, 0.313_706_645_877_887_3),
        (0.796_666_477_413_626_7, 0.222_381_034_453_374_47),
        (0.960_289_856_497_536_2, 0.101_228_536_290_376_26),
    ];
    let panel = 1.0 / panels as f64;
    let points = |p: usize| {
        NODES.into_iter().flat_map(move |(x, w)| {
            [x, -x].map(|x| ((p as f64 + 0.5 + 0.5 * x) * panel, 0.5 * w * panel))
        })
    };
    (0..panels).flat_map(points).collect()
}

/// Smith's auxiliary function of sheen: Estevez and Kulla's fit.
fn sheen_lambda(cosine: f64, alpha: f64) -> f64 {
    let p = (1.0 - alpha).powi(2);
    let mix = |rough: f64, smooth: f64| rough + (smooth - rough) * p;
    let [a, b, c] = [mix(21.5473, 25.3245), mix(3.82987, 3.32435), mix(0.19823, 0.16801)];
    let [d, e] = [mix(-1.97760, -1.27393), mix(-4.32054, -4.85967)];
    let fit = |x: f64| a / (1.0 + b * x.powf(c)) + d * x + e;
    if cosine < 0.5 { fit(cosine).exp() } else { (2.0 * fit(0.5) - fit(1.0 - cosine)).exp() }
}

/// Of white sheen, not limited to 1.
fn sheen(cos_o: f64, alpha: f64) -> f64 {
    static POINTS: LazyLock<[Vec<(f64, f64)>; 2]> = LazyLock::new(|| [rule(8), rule(6)]);
    let lambda_o = sheen_lambda(cos_o, alpha);
    let sin_o = (1.0 - cos_o * cos_o).sqrt();
    let mut sum = 0.0;
    for &(t, wt) in &POINTS[0] {
        // The fourth power gathers points at the horizon.
        let (z, wz) = (t.powi(4), wt * 4.0 * t.powi(3));
        let across = sin_o * (1.0 - z * z).sqrt();
        let masking = 4.0 * cos_o * (1.0 + lambda_o + sheen_lambda(z, alpha));
        for &(turn, wturn) in &POINTS[1] {
            let length2 = 2.0 + 2.0 * (cos_o * z + across * (PI * turn).cos());
            let sin2 = 1.0 - (cos_o + z).powi(2) / length2;
            let d = (2.0 + 1.0 / alpha) / (2.0 * PI) * sin2.max(0.0).powf(0.5 / alpha);
            sum += wz * wturn * 2.0 * PI * d / masking;
        }
    }
    sum
}

/// Of GGX with height-correlated masking, reflectance 1: the mean of G2 / G1 over visible normals
/// (Heitz 2018), whose square of random numbers is the domain.
fn ggx(cos_o: f64, alpha: f64) -> f64 {
    static POINTS: LazyLock<[Vec<(f64, f64)>; 2]> = LazyLock::new(|| [rule(12), rule(4)]);
    let sin_o = (1.0 - cos_o * cos_o).sqrt();
    let length = (alpha * sin_o).hypot(cos_o);
    let (vx, vz) = (alpha * sin_o / length, cos_o / length);
    let smith = |c: f64| (c * c + alpha * alpha * (1.0 - c * c)).sqrt();
    let so = smith(cos_o);
    let mut sum = 0.0;
    for &(t, wt) in &POINTS[0] {
        // Microfacets that reflect below the horizon are near the rim.
        let (u, wu) = (1.0 - t * t, 2.0 * t * wt);
        for &(turn, wturn) in &POINTS[1] {
            // The disk is symmetric about its second axis; the first is y.
            let (sin, cos) = (PI * (turn - 0.5)).sin_cos();
            let (t1, t2) = (u.sqrt() * cos, u.sqrt() * sin);
            let s = 0.5 * (1.0 + vz);
            let t2 = (1.0 - s) * (1.0 - t1 * t1).max(0.0).sqrt() + s * t2;
            let along = (1.0 - t1 * t1 - t2 * t2).max(0.0).sqrt();
            let n = [-vz * t2 + along * vx, t1, vx * t2 + along * vz];
            let h = [alpha * n[0], alpha * n[1], n[2].max(0.0)];
            let norm2 = h.iter().map(|c| c * c).sum::<f64>();
            let cos_i = 2.0 * (h[0] * sin_o + h[2] * cos_o) * h[2] / norm2 - cos_o;
            if cos_i > 0.0 {
                let si = smith(cos_i);
                sum += wu * wturn * cos_i * (cos_o + so) / (cos_o * si + cos_i * so);
            }
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the shader does with a table.
    fn read(table: &[f32], width: f64, cosine: f64, alpha: f64) -> f64 {
        let most = (SIDE - 1) as f64;
        let x = (cosine * (1.0 + width) / (cosine + width)).cbrt() * most;
        let least = f64::from(ALBEDO_TABLE_LEAST);
        let y = (alpha.sqrt().sqrt() - least) / (1.0 - least) * most;
        let [column, row] = [x, y].map(|c| (c.max(0.0) as usize).min(SIDE - 2));
        let [along, down] = [x - column as f64, y - row as f64];
        let at = |r: usize, c: usize| f64::from(table[r * SIDE + c]);
        let line = |r| at(r, column) * (1.0 - along) + at(r, column + 1) * along;
        line(row) * (1.0 - down) + line(row + 1) * down
    }

    fn cases() -> impl Iterator<Item = (f64, f64)> {
        let cosines = [
            1e-4, 3e-4, 1e-3, 3e-3, 0.01, 0.03, 0.06, 0.1, 0.17, 0.23, 0.31, 0.43, 0.57, 0.71,
            0.88, 1.0,
        ];
        let roughnesses = (0..40).map(|k| 0.032 + 0.968 * f64::from(k) / 39.0);
        roughnesses.flat_map(move |r| cosines.map(|c| (c, r * r)))
    }

    /// GGX's albedo at normal incidence for alpha 1 is 1 - ln 2.
    #[test]
    fn ggx_of_alpha_1_is_known() {
        assert!((ggx(1.0, 1.0) - (1.0 - 2.0_f64.ln())).abs() < 1e-4, "{}", ggx(1.0, 1.0));
    }

    #[test]
    fn tables_are_close_to_quadrature_between_their_points() {
        let features = Features::default().with(Feature::Sheen).with(Feature::EnergyCompensation);
        let both = build(features);
        let (sheen_table, ggx_table) = both.split_at(SIDE * SIDE);
        let (mut at_grazing, mut worst_sheen, mut worst_ggx) = (0.0_f64, 0.0_f64, 0.0_f64);
        for (cosine, alpha) in cases() {
            let truth = sheen(cosine, alpha);
            let error = (read(sheen_table, alpha.sqrt(), cosine, alpha) - truth).abs();
            let error = error / truth.max(1.0);
            let worst = if cosine < 0.01 { &mut at_grazing } else { &mut worst_sheen };
            *worst = worst.max(error);
            let error = (read(ggx_table, alpha, cosine, alpha) - ggx(cosine, alpha)).abs();
            worst_ggx = worst_ggx.max(error);
        }
        println!("sheen {worst_sheen:.2e}, at grazing {at_grazing:.2e}; GGX {worst_ggx:.2e}");
        // Absolute up to 1, relative above.
        assert!(worst_sheen < 0.01 && at_grazing < 0.1 && worst_ggx < 3e-3);
    }
}
