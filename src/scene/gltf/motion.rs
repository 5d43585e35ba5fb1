//! Animations: which there are, and the pose of the nodes at a time.

use super::LoadOptions;
use super::accessor::Accessors;
use super::document::Document;
use super::keyframes::{Interpolation, Track};
use super::notices::Notices;
use crate::scene::Animation;
use crate::{Error, Result};
use gltf::json::accessor::Type;
use gltf::json::{self, Index};
use serde::Deserialize;
use std::collections::BTreeMap;

/// An animation as the file has it. The `gltf` crate's type refuses targets of extensions.
#[derive(Deserialize)]
pub(super) struct RawAnimation {
    name: Option<String>,
    channels: Vec<Channel>,
    samplers: Vec<Sampler>,
}

#[derive(Deserialize)]
struct Channel {
    sampler: usize,
    target: Target,
}

#[derive(Deserialize)]
struct Target {
    node: Option<u32>,
    path: String,
}

#[derive(Deserialize)]
struct Sampler {
    input: u32,
    interpolation: Option<String>,
    output: u32,
}

/// What animations set of a node, in place of its own members.
#[derive(Clone, Default)]
pub(super) struct NodePose {
    pub(super) translation: Option<[f64; 3]>,
    /// x, y, z, w; any length.
    pub(super) rotation: Option<[f64; 4]>,
    pub(super) scale: Option<[f64; 3]>,
    /// Of morph targets.
    pub(super) weights: Option<Vec<f64>>,
}

/// By the node's index.
pub(super) type Pose = BTreeMap<usize, NodePose>;

/// The file's animations and the pose that the options ask for.
pub(super) fn read(
    accessors: &Accessors,
    options: &LoadOptions,
    notices: &mut Notices,
) -> Result<(Vec<Animation>, Pose)> {
    let document = accessors.document;
    let raw = &document.animations;
    let mut animations = Vec::new();
    for (index, animation) in raw.iter().enumerate() {
        let label = label(index, animation);
        let duration = match duration(accessors, animation, &label) {
            Ok(duration) => duration,
            Err(error) if options.frame_time.is_some() => return Err(error),
            Err(error) => {
                notices.ignored(format!("animation that cannot be read: {error}"), &label);
                f64::NAN
            }
        };
        let name = animation.name.clone().unwrap_or_default();
        animations.push(Animation { name, duration });
    }

    let mut pose = Pose::new();
    let Some(time) = options.frame_time else {
        if let Some(selector) = &options.animation {
            return Err(Error::Settings(format!(
                "animation {selector}: without a time the scene is in its rest pose"
            )));
        }
        for (index, animation) in raw.iter().enumerate() {
            let message = "animations: drawn in rest pose without a time (--frame-time)";
            notices.ignored(message, &label(index, animation));
        }
        return Ok((animations, pose));
    };
    if !time.is_finite() {
        return Err(Error::Settings(format!("the time of the frame is {time}; it must be finite")));
    }
    for index in chosen(&animations, options.animation.as_deref())? {
        let animation = &raw[index];
        let label = label(index, animation);
        apply(accessors, animation, &label, time, &mut pose, notices)?;
        notices.honoured(&format!("animation at {time} s"), &label);
    }
    for (index, animation) in raw.iter().enumerate() {
        if options.animation.is_none() && index > 0 {
            let message = "animations but the first: not applied (--animation)";
            notices.ignored(message, &label(index, animation));
        }
    }
    Ok((animations, pose))
}

fn label(index: usize, animation: &RawAnimation) -> String {
    match &animation.name {
        Some(name) => format!("animation {index} {name:?}"),
        None => format!("animation {index}"),
    }
}

/// Indices of the animations that `selector` means; the first by default.
fn chosen(animations: &[Animation], selector: Option<&str>) -> Result<Vec<usize>> {
    let Some(selector) = selector else { return Ok((0..animations.len().min(1)).collect()) };
    let by_name = animations.iter().position(|animation| animation.name == selector);
    let by_index = || selector.parse().ok().filter(|&index| index < animations.len());
    match by_name.or_else(by_index) {
        Some(index) => Ok(vec![index]),
        None if selector == "all" => Ok((0..animations.len()).collect()),
        None => {
            let names = animations.iter().enumerate().map(|(i, a)| format!("{i} {:?}", a.name));
            let names = match animations.len() {
                0 => "no animations".to_owned(),
                _ => names.collect::<Vec<_>>().join(", "),
            };
            Err(Error::Settings(format!("animation {selector}: the scene has {names}")))
        }
    }
}

/// Time of the last keyframe of all samplers, seconds.
fn duration(accessors: &Accessors, animation: &RawAnimation, label: &str) -> Result<f64> {
    let mut duration = 0.0_f64;
    let mut inputs: Vec<u32> = animation.samplers.iter().map(|sampler| sampler.input).collect();
    inputs.sort_unstable();
    inputs.dedup();
    for input in inputs {
        let times = times(accessors, input, label)?;
        duration = duration.max(times.last().copied().unwrap_or_default());
    }
    Ok(duration)
}

/// Keyframe times: at least one, rising.
fn times(accessors: &Accessors, input: u32, label: &str) -> Result<Vec<f64>> {
    let what = format!("{label}, input");
    let times = accessors.floats::<1>(Index::new(input), &[Type::Scalar], 0.0, &what)?;
    let times: Vec<f64> = times.into_iter().map(|[t]| t.into()).collect();
    let error = |message: String| accessors.document.error(format!("{what}: {message}"));
    if times.is_empty() {
        return Err(error("it has no keyframes".into()));
    }
    match times.windows(2).find(|pair| pair[0] >= pair[1]) {
        Some(pair) => Err(error(format!("{} s follows {} s; times must rise", pair[1], pair[0]))),
        None => Ok(times),
    }
}

/// Sets what the animation's channels say at `time`.
fn apply(
    accessors: &Accessors,
    animation: &RawAnimation,
    label: &str,
    time: f64,
    pose: &mut Pose,
    notices: &mut Notices,
) -> Result<()> {
    let document = accessors.document;
    for (i, channel) in animation.channels.iter().enumerate() {
        let what = format!("{label}, channel {i}");
        let path = channel.target.path.as_str();
        if !["translation", "rotation", "scale", "weights"].contains(&path) {
            let message = format!("animated {}: stays as it is", path.escape_debug());
            notices.ignored(message, &what);
            continue;
        }
        // Without a node, an extension defines the target (glTF 2.0, 3.11).
        let Some(node) = channel.target.node else {
            notices.ignored("animation channel without a node", &what);
            continue;
        };
        check_node(document, Index::new(node), path, &what)?;
        let sampler = animation.samplers.get(channel.sampler).ok_or_else(|| {
            document.error(format!(
                "{what} refers to sampler {}, which does not exist",
                channel.sampler
            ))
        })?;
        let value = track(accessors, sampler, path, &what)?.at(time);
        let node = pose.entry(node as usize).or_default();
        let is_second = match path {
            "translation" => node.translation.replace([value[0], value[1], value[2]]).is_some(),
            "scale" => node.scale.replace([value[0], value[1], value[2]]).is_some(),
            "rotation" => node.rotation.replace([value[0], value[1], value[2], value[3]]).is_some(),
            _ => node.weights.replace(value).is_some(),
        };
        if is_second {
            notices.approximated("node member animated twice: the later taken", &what);
        }
    }
    Ok(())
}

fn check_node(document: &Document, node: Index<json::Node>, path: &str, what: &str) -> Result<()> {
    if document.get(node, what)?.matrix.is_some() && path != "weights" {
        let label = document.label(node);
        return Err(
            document.error(format!("{what}: {label} has a matrix, which cannot be animated"))
        );
    }
    Ok(())
}

fn track(accessors: &Accessors, sampler: &Sampler, path: &str, what: &str) -> Result<Track> {
    let error = |message: String| accessors.document.error(format!("{what}: {message}"));
    let interpolation = match sampler.interpolation.as_deref() {
        None | Some("LINEAR") => Interpolation::Linear,
        Some("STEP") => Interpolation::Step,
        Some("CUBICSPLINE") => Interpolation::CubicSpline,
        Some(other) => return Err(error(format!("unknown interpolation {other:?}"))),
    };
    let times = times(accessors, sampler.input, what)?;
    let output = Index::new(sampler.output);
    let what = format!("{what}, output");
    let flat = |elements: Vec<[f32; 3]>| elements.into_iter().flatten().map(f64::from).collect();
    let (values, width): (Vec<f64>, _) = match path {
        "rotation" => {
            let values = accessors.floats::<4>(output, &[Type::Vec4], 0.0, &what)?;
            (values.into_iter().flatten().map(f64::from).collect(), Some(4))
        }
        "weights" => {
            let values = accessors.floats::<1>(output, &[Type::Scalar], 0.0, &what)?;
            (values.into_iter().flatten().map(f64::from).collect(), None)
        }
        _ => (flat(accessors.floats::<3>(output, &[Type::Vec3], 0.0, &what)?), Some(3)),
    };
    Track::new(times, values, width, interpolation, path == "rotation").map_err(error)
}
