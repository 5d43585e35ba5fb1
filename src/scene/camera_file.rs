//! Cameras as JSON:
//!
//! ```json
//! {
//!   "name": "front",
//!   "position": [0.0, 1.0, 5.0],
//!   "target": [0.0, 1.0, 0.0],
//!   "projection": {"perspective": {"yfov_degrees": 45}}
//! }
//! ```
//!
//! `position` and `target` are in metres; `up` (+Y by default) is the direction that points up in
//! the picture. In place of `target` the camera's unit axes can be given as `right`, `up` and
//! `back`, the opposite of the view direction: so they are written, that nothing is rounded.
//! `projection` may be `{"orthographic": {"half_height": H}}`, metres. Optional: `aspect_ratio`,
//! width over height; `aperture_radius` (0) and `focus_distance`, metres, which a radius needs.

use super::{Camera, Projection};
use crate::{Error, Result};
use glam::{Affine3A, Vec3};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// By how much axes may differ from unit vectors at right angles.
const AXIS_ERROR: f32 = 1e-4;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraFile {
    #[serde(default)]
    name: String,
    position: [f32; 3],
    target: Option<[f32; 3]>,
    right: Option<[f32; 3]>,
    up: Option<[f32; 3]>,
    back: Option<[f32; 3]>,
    projection: ProjectionFile,
    aspect_ratio: Option<f32>,
    #[serde(default)]
    aperture_radius: f32,
    focus_distance: Option<f32>,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum ProjectionFile {
    Perspective(Perspective),
    Orthographic(Orthographic),
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Perspective {
    yfov_degrees: f64,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Orthographic {
    half_height: f32,
}

impl Camera {
    /// JSON text that [`Camera::from_json`] reads back bit for bit.
    pub fn to_json(&self) -> String {
        let m = self.world_from_camera;
        let vector = |v: glam::Vec3A| json(&v.to_array());
        let projection = match self.projection {
            Projection::Perspective { yfov } => {
                ProjectionFile::Perspective(Perspective { yfov_degrees: degrees(yfov) })
            }
            Projection::Orthographic { ymag } => {
                ProjectionFile::Orthographic(Orthographic { half_height: ymag })
            }
        };
        let mut members = vec![
            ("name", json(&self.name)),
            ("position", vector(m.translation)),
            ("right", vector(m.matrix3.x_axis)),
            ("up", vector(m.matrix3.y_axis)),
            ("back", vector(m.matrix3.z_axis)),
            ("projection", json(&projection)),
        ];
        members.extend(self.aspect_ratio.map(|ratio| ("aspect_ratio", json(&ratio))));
        members.push(("aperture_radius", json(&self.aperture_radius)));
        members.push(("focus_distance", json(&self.focus_distance)));
        let lines: Vec<_> =
            members.iter().map(|(name, value)| format!("  \"{name}\": {value}")).collect();
        format!("{{\n{}\n}}\n", lines.join(",\n"))
    }

    /// Reads what [`Camera::to_json`] writes, or a person: see the form above.
    ///
    /// # Errors
    /// One line about what is wrong.
    pub fn from_json(text: &str) -> std::result::Result<Self, String> {
        let file: CameraFile = serde_json::from_str(text).map_err(|e| e.to_string())?;
        let position = finite("position", file.position)?;
        let [x, y, z] = file.axes(position)?;
        let projection = match file.projection {
            ProjectionFile::Perspective(Perspective { yfov_degrees }) => {
                let yfov = yfov_degrees.to_radians() as f32;
                if !(yfov > 0.0 && yfov < std::f32::consts::PI) {
                    return Err("yfov_degrees must be above 0 and below 180".into());
                }
                Projection::Perspective { yfov }
            }
            ProjectionFile::Orthographic(Orthographic { half_height }) => {
                positive("half_height", half_height)?;
                Projection::Orthographic { ymag: half_height }
            }
        };
        if let Some(ratio) = file.aspect_ratio {
            positive("aspect_ratio", ratio)?;
        }
        if !(file.aperture_radius >= 0.0 && file.aperture_radius.is_finite()) {
            return Err("aperture_radius must be finite and not negative".into());
        }
        if file.aperture_radius > 0.0 && file.focus_distance.is_none() {
            return Err("an aperture_radius needs a focus_distance".into());
        }
        let focus_distance = file.focus_distance.unwrap_or(1.0);
        positive("focus_distance", focus_distance)?;
        Ok(Self {
            name: file.name,
            world_from_camera: Affine3A::from_cols(x.into(), y.into(), z.into(), position.into()),
            projection,
            aspect_ratio: file.aspect_ratio,
            aperture_radius: file.aperture_radius,
            focus_distance,
        })
    }

    /// [`Camera::from_json`] of a file.
    ///
    /// # Errors
    /// [`Error::Scene`].
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).map_err(|e| Error::scene(path, e.to_string()))?;
        Self::from_json(&text).map_err(|message| Error::scene(path, message))
    }
}

impl CameraFile {
    /// Right, up and back.
    fn axes(&self, position: Vec3) -> std::result::Result<[Vec3; 3], String> {
        let up = self.up.map(|up| finite("up", up)).transpose()?;
        match (self.target, self.right, up, self.back) {
            (Some(target), None, up, None) => {
                let back = position - finite("target", target)?;
                look_at(back, up.unwrap_or(Vec3::Y)).ok_or_else(|| {
                    "target is the position, or the view goes along the direction up".into()
                })
            }
            (None, Some(right), Some(up), Some(back)) => {
                let axes = [finite("right", right)?, up, finite("back", back)?];
                let [x, y, z] = axes;
                let is_unit = axes.iter().all(|v| (v.length() - 1.0).abs() <= AXIS_ERROR);
                if is_unit && (x - y.cross(z)).length() <= AXIS_ERROR {
                    return Ok(axes);
                }
                Err("right, up and back must be unit vectors at right angles, right = up × back"
                    .into())
            }
            _ => Err("give either target, or right, up and back".into()),
        }
    }
}

/// Right, up and back of a camera whose view goes along `-back`.
fn look_at(back: Vec3, up: Vec3) -> Option<[Vec3; 3]> {
    let z = back.try_normalize()?;
    let x = up.try_normalize()?.cross(z).try_normalize()?;
    Some([x, z.cross(x), z])
}

/// The shortest number of degrees that is this angle, radians.
fn degrees(radians: f32) -> f64 {
    let exact = f64::from(radians).to_degrees();
    let rounded = (0..=17).filter_map(|places| format!("{exact:.places$}").parse::<f64>().ok());
    rounded.into_iter().find(|d| d.to_radians() as f32 == radians).unwrap_or(exact)
}

fn finite(name: &str, v: [f32; 3]) -> std::result::Result<Vec3, String> {
    let v = Vec3::from(v);
    v.is_finite().then_some(v).ok_or_else(|| format!("{name} must be finite"))
}

fn positive(name: &str, value: f32) -> std::result::Result<(), String> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(format!("{name} must be above 0 and finite"))
}

/// Numbers and texts always have a form; a number that is not finite is `null`, which is refused
/// when it is read.
fn json<T: Serialize>(value: &T) -> String {
    serde_json::to_string(value).unwrap_or_else(|_| "null".into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3A;

    fn bits(camera: &Camera) -> Vec<u32> {
        let projection = match camera.projection {
            Projection::Perspective { yfov } => [0, yfov.to_bits()],
            Projection::Orthographic { ymag } => [1, ymag.to_bits()],
        };
        let numbers = camera.world_from_camera.to_cols_array();
        let more = [camera.aperture_radius, camera.focus_distance];
        let aspect = camera.aspect_ratio.map_or(vec![], |a| vec![a.to_bits()]);
        let all = numbers.into_iter().chain(more).map(f32::to_bits);
        all.chain(projection).chain(aspect).collect()
    }

    #[test]
    fn every_bit_comes_back() {
        let mut state = 1_u32;
        let mut unit = move || {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            (state >> 8) as f32 / 16_777_216.0
        };
        for i in 0..2000 {
            let mut spread = || (unit() - 0.5) * (40.0 * unit() - 20.0).exp2();
            let position = Vec3A::new(spread(), spread(), -0.0);
            let axes = look_at(Vec3::new(spread(), spread(), spread()), Vec3::Y).unwrap();
            let [x, y, z] = axes.map(Vec3A::from);
            let camera = Camera {
                name: "a \"quoted\"\nname, größer".into(),
                world_from_camera: Affine3A::from_cols(x, y, z, position),
                projection: match i % 2 {
                    0 => Projection::Perspective { yfov: 1e-3 + 3.0 * unit() },
                    _ => Projection::Orthographic { ymag: 1e-9 + unit() },
                },
                aspect_ratio: (i % 3 == 0).then(|| 0.1 + unit()),
                aperture_radius: if i % 5 == 0 { 0.0 } else { unit() },
                focus_distance: 1e-3 + 100.0 * unit(),
            };
            let text = camera.to_json();
            let back = Camera::from_json(&text).unwrap();
            assert_eq!(bits(&back), bits(&camera), "{text}");
            assert_eq!(back.name, camera.name);
        }
    }

    #[test]
    fn angles_are_written_shortly() {
        let camera = Camera::framing((Vec3::ZERO, Vec3::ONE));
        assert!(camera.to_json().contains("\"yfov_degrees\":45.0}"), "{}", camera.to_json());
    }

    const PROJECTION: &str = r#""projection": {"perspective": {"yfov_degrees": 45}}"#;

    #[test]
    fn a_target_makes_the_axes() {
        let text = format!(r#"{{"position": [0, 0, 5], "target": [0, 0, 1], {PROJECTION}}}"#);
        let camera = Camera::from_json(&text).unwrap();
        let m = camera.world_from_camera;
        assert_eq!(m, Affine3A::from_translation(Vec3::new(0.0, 0.0, 5.0)));
        assert_eq!((camera.aperture_radius, camera.aspect_ratio), (0.0, None));
    }

    #[test]
    fn what_is_no_camera_is_refused_in_one_line() {
        let whole = Camera::framing((Vec3::ZERO, Vec3::ONE)).to_json();
        let with = |from: &str, to: &str| {
            assert!(whole.contains(from), "{from}");
            whole.replace(from, to)
        };
        let without = |name: &str| {
            let is_other = |line: &&str| !line.contains(&format!("\"{name}\""));
            whole.lines().filter(is_other).collect::<Vec<_>>().join("\n")
        };
        let axes = r#""position": [0, 0, 0], "right": [1, 0, 0], "up": [0, 1, 0]"#;
        let cases = [
            (String::new(), "EOF"),
            ("[]".into(), "invalid"),
            (without("position"), "position"),
            (without("right"), "right, up and back"),
            (without("projection"), "projection"),
            (with("\"name\"", "\"colour\": 3, \"name\""), "unknown field `colour`"),
            (with("\"name\": \"default\"", "\"name\": 3"), "invalid type"),
            (with("\"yfov_degrees\":45.0", "\"yfov_degrees\":180"), "yfov_degrees"),
            (with("\"yfov_degrees\":45.0", "\"yfov_degrees\":1e400"), "range"),
            (with("\"yfov_degrees\":45.0", "\"fov\":45.0"), "fov"),
            (with("\"aperture_radius\": 0.0", "\"aperture_radius\": -1"), "aperture_radius"),
            (with("\"aperture_radius\": 0.0", "\"aperture_radius\": null"), "null"),
            (with("\"aperture_radius\": 0.0", "\"aperture_radius\": NaN"), "expected"),
            (with("\"aperture_radius\": 0.0", "\"aspect_ratio\": 1e39"), "aspect_ratio"),
            (with("\"focus_distance\": ", "\"focus_distance\": -"), "focus_distance"),
            (format!(r#"{{{axes}, "back": [0, 1, 0], {PROJECTION}}}"#), "right angles"),
            (format!(r#"{{{axes}, "back": [0, 0, -1], {PROJECTION}}}"#), "right angles"),
            (format!(r#"{{{axes}, "back": [0, 0, 0], {PROJECTION}}}"#), "right angles"),
            (format!(r#"{{{axes}, "back": [0, 0, 1e39], {PROJECTION}}}"#), "back"),
            (format!(r#"{{{axes}, "target": [0, 0, 1], {PROJECTION}}}"#), "either"),
            (format!(r#"{{"position": [1, 0, 0], "target": [1, 0, 0], {PROJECTION}}}"#), "target"),
            (format!(r#"{{"position": [1, 2, 0], "target": [1, 0, 0], {PROJECTION}}}"#), "up"),
            (
                format!(
                    r#"{{"position": [1, 0, 9], "target": [1, 0, 0], "aperture_radius": 1, {PROJECTION}}}"#
                ),
                "focus_distance",
            ),
        ];
        for (text, word) in cases {
            let message = Camera::from_json(&text).unwrap_err();
            assert!(message.contains(word), "{text}: {message}");
            assert_eq!(message.lines().count(), 1, "{message}");
        }
    }
}
