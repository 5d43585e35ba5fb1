//! From flags and files to a scene and settings that fit each other.

use super::flags::{CameraFlags, EnvironmentFlags, JobFlags, PictureFlags};
use super::values::MAX_SIDE;
use glam::Mat3;
use std::path::Path;
use std::time::Instant;
use steradian::scene::gltf::load_with;
use steradian::scene::{Camera, Environment, Notice, Scene, Treatment};
use steradian::{Error, RenderSettings, Result};

/// Rows of a picture for which no resolution is given.
const DEFAULT_ROWS: u32 = 512;
/// Samples of a block where there are enough of them.
const LARGEST_DEFAULT_BLOCK: u32 = 16;

/// Most pixels of one render, whose film alone takes 46 GiB or more.
const MAX_PIXELS: u64 = 1 << 28;

/// What to render, checked.
pub(crate) struct Job {
    /// With the flags' camera lens and environment in place.
    pub(crate) scene: Scene,
    /// Valid for the scene.
    pub(crate) settings: RenderSettings,
    /// Samples per pixel that were asked for; `None` if only the time is limited.
    pub(crate) requested_spp: Option<u32>,
    /// Whether the reference renders it, and no device.
    pub(crate) is_reference: bool,
    /// Reading and decoding files.
    pub(crate) load_seconds: f64,
}

impl Job {
    /// Loads the scene and settles all settings.
    pub(crate) fn new(scene: &Path, flags: &JobFlags) -> Result<Self> {
        let begin = Instant::now();
        let scene = load_with(scene, &flags.scene.options())?;
        Self::of(scene, flags, begin)
    }

    /// The same of a scene that was read since `begin`.
    pub(crate) fn of(mut scene: Scene, flags: &JobFlags, begin: Instant) -> Result<Self> {
        set_environment(&mut scene, &flags.environment)?;
        let load_seconds = begin.elapsed().as_secs_f64();

        let camera = choose_camera(&mut scene.cameras, flags.camera.camera.as_deref())?;
        set_lens(&mut scene.cameras[camera], &flags.camera);
        let requested_spp = flags.stopping.requested_spp();
        let settings = RenderSettings {
            resolution: resolution(&flags.picture, &scene.cameras[camera])?,
            crop: flags.picture.region(),
            spp: flags.stopping.spp_limit(),
            part: None,
            time: flags.stopping.time,
            stopping: flags.stopping.rule(),
            seed: flags.sampling.seed,
            strategy: flags.sampling.strategy,
            light_samples: flags.sampling.light_samples,
            light_selection: flags.sampling.light_selection,
            light_candidates: flags.sampling.light_candidates,
            max_bounces: flags.sampling.max_bounces,
            only_bounce: flags.sampling.only_bounce,
            roulette: !flags.sampling.no_roulette,
            path_reuse: flags.sampling.path_reuse,
            sampler: flags.sampling.sampler,
            camera,
            block_size: flags.sampling.block.unwrap_or(default_block_size(requested_spp)),
            accel: flags.sampling.accel,
            energy_compensation: flags.sampling.energy_compensation,
            all_features: flags.sampling.features.as_deref() == Some("all"),
        };
        check_pixel(flags, &settings)?;
        check_bounces(&settings)?;
        settings.validate(&scene)?;
        check_size(&settings)?;
        let is_reference = flags.sampling.reference;
        let camera = &scene.cameras[settings.camera];
        scene.notices.extend(camera.precision_notice(settings.resolution));
        Ok(Self { scene, settings, requested_spp, is_reference, load_seconds })
    }
}

/// Four blocks or more, so that the picture's error can be estimated from their
/// spread; larger blocks cost fewer transfers from the device.
pub(crate) fn default_block_size(requested_spp: Option<u32>) -> u32 {
    let quarter = requested_spp.map_or(LARGEST_DEFAULT_BLOCK, |spp| spp / 4);
    1 << quarter.clamp(1, LARGEST_DEFAULT_BLOCK).ilog2()
}

fn resolution(flags: &PictureFlags, camera: &Camera) -> Result<(u32, u32)> {
    let (width, height) = flags.resolution.unwrap_or_else(|| {
        let aspect_ratio = f64::from(camera.aspect_ratio.unwrap_or(1.0));
        let width = (f64::from(DEFAULT_ROWS) * aspect_ratio).round();
        (width.clamp(1.0, f64::from(MAX_SIDE)) as u32, DEFAULT_ROWS)
    });
    let Some(scale) = flags.scale.map(f64::from) else { return Ok((width, height)) };
    let scaled = [width, height].map(|side| (f64::from(side) * scale).round().max(1.0));
    if scaled.iter().any(|side| *side > f64::from(MAX_SIDE)) {
        return Err(Error::Settings(format!(
            "--scale {scale}: {width}x{height} becomes {}x{}; each side can have {MAX_SIDE} pixels",
            scaled[0], scaled[1]
        )));
    }
    Ok((scaled[0] as u32, scaled[1] as u32))
}

/// Index of the camera, which is added to the scene's where it is a file's. The scene's own win.
fn choose_camera(cameras: &mut Vec<Camera>, selector: Option<&str>) -> Result<usize> {
    if let Some(json) = selector.filter(|s| s.trim_start().starts_with('{')) {
        let wrong = |message| Error::Settings(format!("--camera: {message}"));
        cameras.push(Camera::from_json(json).map_err(wrong)?);
        return Ok(cameras.len() - 1);
    }
    let found = find_camera(cameras, "--camera", selector);
    match (found, selector.map(Path::new)) {
        (Err(_), Some(path)) if path.is_file() || path.extension() == Some("json".as_ref()) => {
            cameras.push(Camera::read(path)?);
            Ok(cameras.len() - 1)
        }
        (found, _) => found,
    }
}

/// A name wins over an index, so that a camera named "2" can be had.
pub(super) fn find_camera(cameras: &[Camera], flag: &str, selector: Option<&str>) -> Result<usize> {
    let Some(selector) = selector else { return Ok(0) };
    let by_name = cameras.iter().position(|camera| camera.name == selector);
    let by_index = || selector.parse().ok().filter(|index| *index < cameras.len());
    by_name.or_else(by_index).ok_or_else(|| {
        let names = cameras.iter().enumerate().map(|(i, camera)| format!("{i} {:?}", camera.name));
        let names: Vec<_> = names.collect();
        Error::Settings(format!("{flag} {selector}: the scene has {}", names.join(", ")))
    })
}

fn set_lens(camera: &mut Camera, flags: &CameraFlags) {
    if let Some(radius) = flags.aperture {
        camera.aperture_radius = radius;
    }
    if let Some(distance) = flags.focus {
        camera.focus_distance = distance;
    }
}

/// Puts the environment of the flags in place of, or turns and scales, the one that `scene` has.
pub(crate) fn set_environment(scene: &mut Scene, flags: &EnvironmentFlags) -> Result<()> {
    if let Some(path) = &flags.environment {
        scene.environment = Some(load_environment(path, &mut scene.notices)?);
    }
    if let Some(radiance) = flags.environment_radiance {
        scene.environment = Some(Environment::constant(radiance));
    }
    let (rotation, intensity) = (flags.environment_rotation, flags.environment_intensity);
    match &mut scene.environment {
        Some(environment) => {
            if let Some(degrees) = rotation {
                // Turning the map one way looks it up turned the other way.
                environment.environment_from_world = Mat3::from_rotation_y(-degrees.to_radians());
            }
            environment.intensity = intensity.unwrap_or(environment.intensity);
            let size = (environment.width, environment.height);
            if flags.max_environment_size.is_some_and(|width| environment.reduce(width)) {
                let Environment { name, width, height, .. } = &*environment;
                let message =
                    format!("{name}: {}x{} texels averaged to {width}x{height}", size.0, size.1);
                let treatment = Treatment::Approximated;
                scene.notices.push(Notice { treatment, message });
            }
            Ok(())
        }
        None if rotation.is_some() || intensity.is_some() => Err(Error::Settings(
            "--environment-rotation and --environment-intensity: the scene has no environment; \
             give one with --environment or --environment-radiance"
                .into(),
        )),
        None => Ok(()),
    }
}

fn load_environment(path: &Path, notices: &mut Vec<Notice>) -> Result<Environment> {
    let (environment, clamped) = Environment::load_counting_negatives(path)?;
    if clamped > 0 {
        notices.push(Notice {
            treatment: Treatment::Approximated,
            message: format!(
                "{clamped} pixels of {} with negative radiance clamped to 0",
                path.display()
            ),
        });
    }
    Ok(environment)
}

/// The library would call it a crop.
fn check_pixel(flags: &JobFlags, settings: &RenderSettings) -> Result<()> {
    let (width, height) = settings.resolution;
    match flags.picture.pixel {
        Some(pixel) if pixel.x >= width || pixel.y >= height => Err(Error::Settings(format!(
            "--pixel {},{}: outside the picture of {width}x{height}",
            pixel.x, pixel.y
        ))),
        _ => Ok(()),
    }
}

fn check_size(settings: &RenderSettings) -> Result<()> {
    let window = settings.window();
    let pixels = u64::from(window.width) * u64::from(window.height);
    if pixels <= MAX_PIXELS {
        return Ok(());
    }
    Err(Error::Settings(format!(
        "{}x{} pixels: one render can have {MAX_PIXELS} in all; render parts with --crop",
        window.width, window.height
    )))
}

fn check_bounces(settings: &RenderSettings) -> Result<()> {
    match (settings.only_bounce, settings.max_bounces) {
        (Some(only), Some(max)) if only > max => Err(Error::Settings(format!(
            "--only-bounce {only}: --max-bounces {max} ends paths before it"
        ))),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn camera(name: &str, aspect_ratio: Option<f32>) -> Camera {
        Camera { name: name.into(), aspect_ratio, ..Camera::framing((Vec3::ZERO, Vec3::ONE)) }
    }

    fn picture_flags(resolution: Option<(u32, u32)>, scale: Option<f32>) -> PictureFlags {
        PictureFlags {
            resolution,
            scale,
            crop: None,
            pixel: None,
            png: crate::cli::destination::PngFlags::default(),
            view: None,
        }
    }

    #[test]
    fn the_default_block_is_at_most_a_quarter_of_the_samples() {
        let cases =
            [(1, 1), (4, 1), (7, 1), (8, 2), (31, 4), (32, 8), (63, 8), (64, 16), (4096, 16)];
        for (spp, block) in cases {
            assert_eq!(default_block_size(Some(spp)), block, "{spp}");
        }
        assert_eq!(default_block_size(None), 16);
    }

    #[test]
    fn the_resolution_follows_the_camera_and_the_scale() {
        let wide = camera("", Some(16.0 / 9.0));
        let of = |r, s, camera: &Camera| resolution(&picture_flags(r, s), camera).ok();
        assert_eq!(of(None, None, &wide), Some((910, 512)));
        assert_eq!(of(None, None, &camera("", None)), Some((512, 512)));
        assert_eq!(of(None, None, &camera("", Some(1e30))), Some((65535, 512)));
        assert_eq!(of(Some((640, 480)), Some(0.5), &wide), Some((320, 240)));
        assert_eq!(of(Some((640, 480)), Some(1e-6), &wide), Some((1, 1)));
        assert_eq!(of(Some((640, 480)), Some(1e9), &wide), None);
    }

    #[test]
    fn a_camera_has_a_name_and_an_index() {
        let cameras = [camera("front", None), camera("0", None), camera("top", None)];
        let find =
            |selector| find_camera(&cameras, "--camera", Some(selector)).map_err(|e| e.to_string());
        assert_eq!(find("top"), Ok(2));
        assert_eq!(find("2"), Ok(2));
        assert_eq!(find("0"), Ok(1));
        assert_eq!(find_camera(&cameras, "--camera", None).ok(), Some(0));
        let message = find("side").unwrap_err();
        assert!(message.contains("front") && message.contains("top"), "{message}");
        assert!(find("3").is_err() && find("-1").is_err());
    }
}
