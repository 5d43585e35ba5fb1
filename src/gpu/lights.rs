//! The lights that can be sampled, chosen by power or with a tree.

use super::GpuLight;
use super::emission::within;
use super::environment::{cumulative, luminance};
use super::light_tree::{LightBounds, LightTree};
use super::world::{Emitter, EmitterShape};
use crate::scene::{LightKind, Material, PunctualLight, Scene};
use crate::settings::LightSelection;
use crate::shader::generated::{INVALID, light};
use glam::{Vec2, Vec3};
use std::f64::consts::PI;

/// Share of the choices that goes to all lights with power alike, so that none of little power
/// is lost to rounding.
const UNIFORM_SHARE: f64 = 1e-3;

/// `lights` and `light_tree`.
pub(super) struct Lights {
    pub(super) records: Vec<GpuLight>,
    /// Probability of choosing the environment.
    pub(super) environment_pmf: f32,
    /// Lights with a place, which come first, and the probability of choosing one of them: where
    /// there is a tree.
    pub(super) finite_count: usize,
    pub(super) finite_share: f32,
    pub(super) tree: LightTree,
}

/// How lights are chosen.
#[derive(Debug, Clone, Copy)]
pub(super) struct Choosing {
    pub(super) selection: LightSelection,
    /// As the shaders are composed.
    pub(super) has_tree: bool,
}

fn blank(kind: u32, color: Vec3) -> GpuLight {
    GpuLight {
        kind,
        red: color.x,
        green: color.y,
        blue: color.z,
        material: INVALID,
        source: INVALID,
        cell_side: 1,
        ..bytemuck::Zeroable::zeroed()
    }
}

/// Lights of `scene`: those of `emitters` first, in their order.
pub(super) fn build(
    scene: &Scene,
    emitters: &[Emitter],
    environment_integral: f64,
    choosing: Choosing,
) -> Lights {
    let radius = scene.bounds().map_or(0.0, |(a, b)| f64::from(a.distance(b)) * 0.5);
    let disk = PI * radius * radius;
    let mut records: Vec<GpuLight> = Vec::new();
    let mut powers: Vec<f64> = Vec::new();
    let mut bounds: Vec<Option<LightBounds>> = Vec::new();
    for e in emitters {
        let m = &scene.materials[e.material as usize];
        records.push(emitter_record(e, m));
        powers.push(emitter_power(e, m));
        bounds.push(emitter_bounds(e, m));
    }
    let mut punctuals: Vec<_> =
        scene.lights.iter().filter(|l| luminance(l.intensity) > 0.0).collect();
    if choosing.has_tree {
        punctuals.sort_by_key(|l| matches!(l.kind, LightKind::Directional { .. }));
    }
    for l in punctuals {
        let (record, power) = punctual(l, disk);
        records.push(record);
        powers.push(power);
        bounds.extend(punctual_bounds(l).map(Some));
    }
    let has_environment = environment_integral > 0.0;
    if has_environment {
        records.push(blank(light::ENVIRONMENT, Vec3::ZERO));
        powers.push(disk * environment_integral);
    }
    if choosing.selection == LightSelection::Uniform {
        powers.iter_mut().filter(|p| **p > 0.0).for_each(|p| *p = 1.0);
    }
    let environment_pmf = assign(&mut records, &powers, has_environment);
    let mut lights = Lights {
        finite_count: 0,
        finite_share: 0.0,
        tree: LightTree::default(),
        records,
        environment_pmf,
    };
    if choosing.has_tree {
        let has_power = bounds.iter().any(Option::is_some);
        lights.finite_count = bounds.len();
        let after = lights.records.get(bounds.len()).map_or(1.0, |r| r.cdf);
        lights.finite_share = if has_power { after } else { 0.0 };
        lights.tree = LightTree::new(&bounds);
    }
    lights
}

/// Sets cdf and pmf; gives the last light's pmf if that is the environment.
fn assign(records: &mut [GpuLight], powers: &[f64], has_environment: bool) -> f32 {
    let sum: f64 = powers.iter().sum();
    let n = powers.iter().filter(|p| **p > 0.0).count() as f64;
    let share = |p: &f64| match *p > 0.0 {
        true => UNIFORM_SHARE / n + (1.0 - UNIFORM_SHARE) * p / sum,
        false => 0.0,
    };
    let cdf = cumulative(&powers.iter().map(share).collect::<Vec<_>>());
    for (record, pair) in records.iter_mut().zip(cdf.windows(2)) {
        record.cdf = pair[0];
        record.pmf = pair[1] - pair[0];
    }
    records.last().filter(|_| has_environment).map_or(0.0, |r| r.pmf)
}

/// Nothing for what emits nothing.
fn emitter_bounds(e: &Emitter, m: &Material) -> Option<LightBounds> {
    let both = m.emits_behind();
    let bounds = match e.shape {
        EmitterShape::Triangle([a, b, c]) => {
            let [k, side] = e.cell;
            let corner = |w: Vec2| {
                let w = within(k, side, w);
                (a + (b - a) * w.x + (c - a) * w.y).as_dvec3()
            };
            let corners = [Vec2::ZERO, Vec2::X, Vec2::Y].map(corner);
            let normal = (b - a).as_dvec3().cross((c - a).as_dvec3());
            let area = 0.5 * normal.length() / f64::from(side).powi(2);
            LightBounds::flat(&corners, normal, both, e.luminance * area)
        }
        EmitterShape::Sphere { center, radius } => {
            let radius = f64::from(radius);
            LightBounds::ball(center.as_dvec3(), radius, e.luminance * PI * radius * radius)
        }
    };
    (e.luminance > 0.0).then_some(bounds)
}

/// Nothing for what is at infinity.
fn punctual_bounds(l: &PunctualLight) -> Option<LightBounds> {
    let strength = luminance(l.intensity);
    match l.kind {
        LightKind::Point { position, .. } => {
            Some(LightBounds::ball(position.as_dvec3(), 0.0, strength))
        }
        LightKind::Spot { position, direction, cos_inner, cos_outer, .. } => {
            let [inner, outer] =
                [cos_inner, cos_outer].map(|c| f64::from(c).clamp(-1.0, 1.0).acos());
            Some(LightBounds::spot(
                position.as_dvec3(),
                direction.as_dvec3(),
                inner,
                outer,
                strength,
            ))
        }
        LightKind::Directional { .. } => None,
    }
}

fn emitter_record(e: &Emitter, m: &Material) -> GpuLight {
    let mut record = blank(light::TRIANGLE, m.emitted().0);
    record.material = e.material;
    record.source = e.source;
    [record.cell, record.cell_side] = e.cell;
    record.is_double_sided = u32::from(m.emits_behind());
    match e.shape {
        EmitterShape::Triangle(v) => {
            (record.a, record.b, record.c) = (v[0].into(), v[1].into(), v[2].into());
        }
        EmitterShape::Sphere { center, radius } => {
            record.kind = light::SPHERE;
            record.a = center.into();
            record.b = [radius, 0.0, 0.0];
        }
    }
    record
}

fn emitter_power(e: &Emitter, m: &Material) -> f64 {
    let area = match e.shape {
        EmitterShape::Triangle([a, b, c]) => {
            0.5 * (b - a).as_dvec3().cross((c - a).as_dvec3()).length()
        }
        EmitterShape::Sphere { radius, .. } => 4.0 * PI * f64::from(radius).powi(2),
    };
    let sides = if m.emits_behind() { 2.0 } else { 1.0 };
    let [_, side] = e.cell;
    PI * area * sides * e.luminance / f64::from(side).powi(2)
}

fn punctual(l: &PunctualLight, disk: f64) -> (GpuLight, f64) {
    let strength = luminance(l.intensity);
    match l.kind {
        LightKind::Point { position, range } => {
            let mut record = blank(light::POINT, l.intensity);
            record.a = position.into();
            record.c = [range, 0.0, 0.0];
            (record, 4.0 * PI * strength)
        }
        LightKind::Spot { position, direction, cos_inner, cos_outer, range } => {
            let mut record = blank(light::SPOT, l.intensity);
            record.a = position.into();
            record.b = direction.into();
            record.c = [range, cos_inner, cos_outer];
            let cosine = 0.5 * f64::from(cos_inner + cos_outer);
            (record, 2.0 * PI * (1.0 - cosine).max(1e-3) * strength)
        }
        LightKind::Directional { direction } => {
            let mut record = blank(light::DIRECTIONAL, l.intensity);
            record.b = direction.into();
            (record, disk * strength)
        }
    }
}
