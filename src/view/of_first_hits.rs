//! Views of what camera rays meet.

use super::colors::{NOTHING, along, distinct, shown};
use super::{View, ViewPicture};
use crate::gpu::GpuFirstHit;
use crate::image::{ChannelData, Layer, Picture};
use crate::shader::generated::INVALID;
use colorous::{TURBO, VIRIDIS};

/// A view of `hits`, `width` × `height` sums of [`FirstHits`](crate::passes::FirstHits), row by
/// row. `None` for a view of a film.
///
/// # Panics
/// If there are not as many hits as pixels.
pub fn of_first_hits(
    view: View,
    hits: &[GpuFirstHit],
    (width, height): (u32, u32),
) -> Option<ViewPicture> {
    let (rgb, legend, mut channels) = match view {
        View::Normals => normals(hits, |h| h.shading_normal, "shading"),
        View::GeometricNormals => normals(hits, |h| h.geometric_normal, "geometric"),
        View::Albedo => albedo(hits),
        View::Depth => depth(hits),
        View::Uv => uv(hits),
        View::Material => material(hits),
        View::NodeVisits => visits(hits),
        View::SampleCount | View::StandardError | View::StopReason | View::NonFinite => {
            return None;
        }
    };
    if !matches!(view, View::Material | View::NodeVisits) {
        let coverage = |h: &GpuFirstHit| h.hit_count as f32 / h.ray_count.max(1) as f32;
        channels.push(floats("coverage", hits, coverage));
    }
    let layer = Layer { name: view.layer_name().into(), channels };
    Some(ViewPicture { picture: Picture::new(width, height, rgb), legend, layer })
}

type Parts = (Vec<[f32; 3]>, String, Vec<(String, ChannelData)>);

fn floats(
    name: &str,
    hits: &[GpuFirstHit],
    value: impl Fn(&GpuFirstHit) -> f32,
) -> (String, ChannelData) {
    (name.into(), ChannelData::F32(hits.iter().map(value).collect()))
}

fn counts(
    name: &str,
    hits: &[GpuFirstHit],
    value: impl Fn(&GpuFirstHit) -> u32,
) -> (String, ChannelData) {
    (name.into(), ChannelData::U32(hits.iter().map(value).collect()))
}

/// Mean over the rays that hit; 0 where none did.
fn mean(sum: f32, hit: &GpuFirstHit) -> f32 {
    sum / hit.hit_count.max(1) as f32
}

/// `color` of the pixels where something was hit.
fn colored(hits: &[GpuFirstHit], color: impl Fn(&GpuFirstHit) -> [f32; 3]) -> Vec<[f32; 3]> {
    hits.iter().map(|h| if h.hit_count == 0 { NOTHING } else { color(h) }).collect()
}

fn normals(hits: &[GpuFirstHit], of: impl Fn(&GpuFirstHit) -> [f32; 3], kind: &str) -> Parts {
    let unit = |h: &GpuFirstHit| glam::Vec3::from(of(h)).normalize_or_zero().to_array();
    let rgb = colored(hits, |h| shown(unit(h).map(|n| 0.5 * n + 0.5)));
    let channels = ["X", "Y", "Z"].iter().enumerate();
    let channels = channels.map(|(k, name)| floats(name, hits, |h| mean(of(h)[k], h))).collect();
    let legend = format!("{kind} normals: red, green and blue are x, y and z from -1 to 1");
    (rgb, legend, channels)
}

fn albedo(hits: &[GpuFirstHit]) -> Parts {
    let rgb = colored(hits, |h| h.albedo.map(|c| mean(c, h)));
    let channels = ["R", "G", "B"].iter().enumerate();
    let channels = channels.map(|(k, name)| floats(name, hits, |h| mean(h.albedo[k], h))).collect();
    (rgb, "base colours".into(), channels)
}

fn depth(hits: &[GpuFirstHit]) -> Parts {
    let depth = |h: &GpuFirstHit| mean(h.depth, h);
    let met = || hits.iter().filter(|h| h.hit_count > 0).map(depth);
    let (least, most) = (met().fold(f32::INFINITY, f32::min), met().fold(0.0, f32::max));
    let range = f64::from(most - least);
    let rgb = colored(hits, |h| match range > 0.0 {
        true => along(VIRIDIS, 1.0 - f64::from(depth(h) - least) / range),
        false => along(VIRIDIS, 1.0),
    });
    let legend = match met().next() {
        Some(_) => format!("distance from {least} m (yellow) to {most} m (dark blue)"),
        None => "distance: nothing is hit".into(),
    };
    let infinite = |h: &GpuFirstHit| if h.hit_count == 0 { f32::INFINITY } else { depth(h) };
    (rgb, legend, vec![floats("Z", hits, infinite)])
}

fn uv(hits: &[GpuFirstHit]) -> Parts {
    let at = |h: &GpuFirstHit, k: usize| mean(h.uv[k], h);
    let wrapped = |v: f32| if (0.0..=1.0).contains(&v) { v } else { v.rem_euclid(1.0) };
    let rgb = colored(hits, |h| shown([wrapped(at(h, 0)), wrapped(at(h, 1)), 0.0]));
    let legend = "texture coordinates of set 0: red is u, green is v, of each their fraction";
    let channels = vec![floats("U", hits, |h| at(h, 0)), floats("V", hits, |h| at(h, 1))];
    (rgb, legend.into(), channels)
}

fn material(hits: &[GpuFirstHit]) -> Parts {
    let color = |h: &GpuFirstHit| match h.material {
        INVALID => NOTHING,
        index => distinct(index),
    };
    let mut met: Vec<u32> = hits.iter().map(|h| h.material).filter(|m| *m != INVALID).collect();
    met.sort_unstable();
    met.dedup();
    let legend = format!("a colour for each of {} materials", met.len());
    (hits.iter().map(color).collect(), legend, vec![counts("id", hits, |h| h.material)])
}

fn visits(hits: &[GpuFirstHit]) -> Parts {
    let cost = |h: &GpuFirstHit| h.node_visits + h.primitive_visits;
    let most = hits.iter().map(cost).max().unwrap_or(0);
    let share = |h: &GpuFirstHit| f64::from(cost(h)) / f64::from(most.max(1));
    let rgb = hits.iter().map(|h| along(TURBO, share(h))).collect();
    let legend = format!("nodes visited and primitives tested: from 0 (dark blue) to {most} (red)");
    let channels = vec![
        counts("nodes", hits, |h| h.node_visits),
        counts("primitives", hits, |h| h.primitive_visits),
    ];
    (rgb, legend, channels)
}
