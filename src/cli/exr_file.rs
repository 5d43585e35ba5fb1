//! An EXR of a render: the picture, its layers, and what made it; band by band.

use super::destination::Picture as Destination;
use super::output::Developed;
use super::report::Outcome;
use super::talk;
use std::time::{SystemTime, UNIX_EPOCH};
use steradian::Result;
use steradian::image::{
    Attribute, ChannelData, ExrHeader, Layer, Picture, Precision, write_exr_bands,
};
use steradian::layers::film_layers;
use steradian::settings::Crop;

/// Pixels that are held in the form of layers at a time.
const BAND_PIXELS: u32 = 1 << 18;

/// Writes a film's picture.
pub(super) fn write(to: &Destination, of: &Developed) -> Result<()> {
    let film = of.film;
    let (picture, errors) = (film.picture(), film.standard_error());
    let mut all = of.metadata.clone();
    all.extend(of.exr_metadata.iter().cloned());
    if to.exr.times {
        all.extend(times(of.render_seconds, SystemTime::now()));
    }
    let window = film.window();
    let header = ExrHeader {
        resolution: of.resolution,
        window,
        metadata: all.into_iter().collect(),
        precision: precision(to, &picture),
    };
    let denoised = (of.denoised)(&picture)?;
    write_exr_bands(&to.path, &header, BAND_PIXELS / window.width, |band| {
        let mut layers = vec![colors("", &picture, window, band)];
        layers.extend(denoised.iter().map(|p| colors("denoised", p, window, band)));
        layers.extend(film_layers(film, errors.as_deref(), &to.exr.layers, band));
        layers.extend((of.traced)(band)?);
        Ok(layers)
    })
}

/// What is asked for, if it can hold the picture, whose light is worth more than its form.
fn precision(to: &Destination, picture: &Picture) -> Precision {
    let asked = to.exr.precision;
    let Some(value) = picture.rgb.iter().flatten().find(|value| !asked.holds(**value)) else {
        return asked;
    };
    talk::line(&format!(
        "warning: {}: it holds {value}, more than 16 bits can: stored with 32",
        to.path.display()
    ));
    Precision::Float
}

/// Attributes of an EXR beside those of any file.
pub(super) fn metadata(outcome: &Outcome) -> Vec<(String, Attribute)> {
    let mut all = standard(outcome);
    all.extend(outcome.layers.iter().flat_map(|layers| layers.metadata()));
    all
}

/// The rows of `band` as the layer `name`.
fn colors(name: &str, picture: &Picture, window: Crop, band: Crop) -> Layer {
    let first = ((band.y - window.y) * window.width) as usize;
    let pixels = &picture.rgb[first..][..(band.width * band.height) as usize];
    let component = |k: usize| ChannelData::F32(pixels.iter().map(|pixel| pixel[k]).collect());
    let channels = ["R", "G", "B"].iter().enumerate();
    let channels = channels.map(|(k, name)| ((*name).to_owned(), component(k))).collect();
    Layer { name: name.into(), channels }
}

/// Attributes that other programs know.
fn standard(outcome: &Outcome) -> Vec<(String, Attribute)> {
    let settings = &outcome.job.settings;
    let camera = &outcome.job.scene.cameras[settings.camera];
    let samples = outcome.film.least_samples().min(i32::MAX as u32) as i32;
    let entries = [
        ("samplesPerPixel", Attribute::Integer(samples)),
        ("worldToCamera", Attribute::Matrix(camera.world_to_camera())),
        ("worldToNDC", Attribute::Matrix(camera.world_to_ndc(settings.resolution))),
        ("generatedBy", Attribute::Text("Steradian".into())),
        ("colorInteropID", Attribute::Text("lin_rec709_scene".into())),
    ];
    entries.map(|(name, value)| (name.to_owned(), value)).into()
}

/// When, in UTC, and how long.
fn times(render_seconds: f64, now: SystemTime) -> Vec<(String, Attribute)> {
    let seconds = now.duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs());
    let entries = [
        ("renderTimeSeconds", Attribute::Single(render_seconds as f32)),
        ("capDate", Attribute::Text(date(seconds))),
        ("utcOffset", Attribute::Single(0.0)),
    ];
    entries.map(|(name, value)| (name.to_owned(), value)).into()
}

/// `YYYY:MM:DD hh:mm:ss` of so many seconds after 1970 in UTC.
fn date(seconds: u64) -> String {
    let (mut day, in_day) = (seconds / 86_400, seconds % 86_400);
    let is_leap = |year: u64| {
        year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400))
    };
    let mut year = 1970;
    while day >= 365 + u64::from(is_leap(year)) {
        day -= 365 + u64::from(is_leap(year));
        year += 1;
    }
    let february = 28 + u64::from(is_leap(year));
    let mut month = 1;
    for days in [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30] {
        if day < days {
            break;
        }
        day -= days;
        month += 1;
    }
    let (hour, minute, second) = (in_day / 3600, in_day / 60 % 60, in_day % 60);
    format!("{year:04}:{month:02}:{:02} {hour:02}:{minute:02}:{second:02}", day + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By `date -u -d @N`.
    #[test]
    fn dates_are_those_of_the_calendar() {
        for (seconds, text) in [
            (0, "1970:01:01 00:00:00"),
            (951_782_399, "2000:02:28 23:59:59"),
            (951_782_400, "2000:02:29 00:00:00"),
            (1_709_251_199, "2024:02:29 23:59:59"),
            (1_798_761_599, "2026:12:31 23:59:59"),
            (4_107_542_400, "2100:03:01 00:00:00"),
        ] {
            assert_eq!(date(seconds), text);
        }
    }
}
