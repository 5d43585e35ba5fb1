//! Values of flags: text in, a value that has a meaning out.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use glam::Vec3;
use std::str::FromStr;
use std::time::Duration;
use steradian::image::ToneCurve;
use steradian::settings::{Accel, Crop, LightSelection, Sampler, Strategy};
use steradian::view::View;

/// Largest width and height of a picture.
pub(crate) const MAX_SIDE: u32 = 65535;

pub(crate) type Parsed<T> = std::result::Result<T, String>;

/// A word of the command line, what it stands for, and its help.
pub(crate) type Word<T> = (&'static str, T, &'static str);

/// Words of `--strategy`.
pub(crate) const STRATEGIES: &[Word<Strategy>] = &[
    ("hemisphere", Strategy::Hemisphere, "uniform directions; lights are found by chance"),
    ("bsdf", Strategy::Bsdf, "directions by the BSDF; lights are found by chance"),
    ("light", Strategy::Light, "lights are sampled at each path vertex"),
    ("mis", Strategy::Mis, "both, weighted by the power heuristic"),
];

/// Words of `--sampler`.
pub(crate) const SAMPLERS: &[Word<Sampler>] = &[
    ("sobol", Sampler::Sobol, "Owen-scrambled Sobol points"),
    ("independent", Sampler::Independent, "independent random numbers"),
];

/// Words of `--light-selection`.
pub(crate) const LIGHT_SELECTIONS: &[Word<LightSelection>] = &[
    ("uniform", LightSelection::Uniform, "every light alike, for comparison"),
    ("power", LightSelection::Power, "by power"),
    (
        "tree",
        LightSelection::Tree,
        "by what it may give, where there are more than 16; else by power",
    ),
];

/// Words of `--accel`.
pub(crate) const ACCELS: &[Word<Accel>] = &[
    ("bvh", Accel::Bvh, "tree by the surface area heuristic"),
    ("median", Accel::Median, "tree split at the median, for comparison"),
    ("none", Accel::None, "every ray tests every primitive, for comparison"),
];

/// Words of `--tone-map`.
pub(crate) const TONE_CURVES: &[Word<ToneCurve>] = &[
    ("none", ToneCurve::None, "clips at 1"),
    ("neutral", ToneCurve::Neutral, "Khronos PBR Neutral"),
    ("agx", ToneCurve::Agx, "AgX, base look"),
    ("aces", ToneCurve::Aces, "ACES, Hill's fit"),
];

/// Words of `--view`.
pub(crate) const VIEWS: &[Word<View>] = &[
    ("normals", View::Normals, "shading normals"),
    ("geometric-normals", View::GeometricNormals, "normals of the triangles and spheres"),
    ("albedo", View::Albedo, "base colours"),
    ("depth", View::Depth, "distance along the ray"),
    ("uv", View::Uv, "texture coordinates"),
    ("material", View::Material, "a colour for each material"),
    ("node-visits", View::NodeVisits, "nodes and primitives that a ray visits"),
    ("sample-count", View::SampleCount, "samples of each pixel"),
    ("standard-error", View::StandardError, "standard error relative to the mean"),
    ("stop-reason", View::StopReason, "why pixels have no more samples"),
    ("non-finite", View::NonFinite, "samples that are not finite or at fault otherwise"),
];

/// The word for a value.
pub(crate) fn word_for<T: PartialEq>(words: &[Word<T>], value: &T) -> &'static str {
    words.iter().find(|(_, v, _)| v == value).map_or("", |(word, _, _)| word)
}

/// Parser of a flag that takes one of `words`.
pub(crate) fn one_of<T: Copy + Send + Sync + 'static>(
    words: &'static [Word<T>],
) -> impl TypedValueParser<Value = T> {
    let values = words.iter().map(|(word, _, help)| PossibleValue::new(*word).help(*help));
    PossibleValuesParser::new(values).try_map(move |given| {
        let found = words.iter().find(|(word, _, _)| *word == given);
        found.map(|(_, value, _)| *value).ok_or("not one of the possible values")
    })
}

/// `WxH`, pixels.
pub(crate) fn resolution(text: &str) -> Parsed<(u32, u32)> {
    let sides: Option<Vec<u32>> = text.split(['x', 'X']).map(|s| s.parse().ok()).collect();
    match sides.as_deref() {
        Some(&[width, height])
            if (1..=MAX_SIDE).contains(&width) && (1..=MAX_SIDE).contains(&height) =>
        {
            Ok((width, height))
        }
        Some(&[_, _]) => Err(format!("width and height must be from 1 to {MAX_SIDE}")),
        _ => Err("expected WIDTHxHEIGHT in pixels, such as 640x480".into()),
    }
}

/// `x,y,w,h`, pixels from the upper left corner.
pub(crate) fn crop(text: &str) -> Parsed<Crop> {
    match list::<u32>(text).as_deref() {
        Some(&[x, y, width, height]) if width > 0 && height > 0 => Ok(Crop { x, y, width, height }),
        Some(&[_, _, _, _]) => Err("its width and height must be at least 1".into()),
        _ => Err("expected x,y,width,height in pixels, such as 0,0,64,64".into()),
    }
}

/// `x,y`, pixels from the upper left corner.
pub(crate) fn pixel(text: &str) -> Parsed<Crop> {
    match list::<u32>(text).as_deref() {
        Some(&[x, y]) => Ok(Crop { x, y, width: 1, height: 1 }),
        _ => Err("expected x,y in pixels from the upper left corner, such as 10,20".into()),
    }
}

/// `R` or `R,G,B`: radiance, W/(sr m²).
pub(crate) fn radiance(text: &str) -> Parsed<Vec3> {
    let values = list::<f32>(text);
    let radiance = match values.as_deref() {
        Some(&[grey]) => Vec3::splat(grey),
        Some(&[r, g, b]) => Vec3::new(r, g, b),
        _ => return Err("expected one number or three, such as 1 or 0.5,0.6,0.8".into()),
    };
    if radiance.is_finite() && radiance.min_element() >= 0.0 {
        Ok(radiance)
    } else {
        Err("radiance must be finite and not negative".into())
    }
}

/// A time: a number of seconds, or with one of the units s, m, h.
pub(crate) fn duration(text: &str) -> Parsed<Duration> {
    let (number, unit) = match text.char_indices().next_back() {
        Some((end, 's')) => (&text[..end], 1.0),
        Some((end, 'm')) => (&text[..end], 60.0),
        Some((end, 'h')) => (&text[..end], 3600.0),
        _ => (text, 1.0),
    };
    let seconds: f64 =
        number.parse().map_err(|_| "expected a time such as 30, 30s, 1.5m or 2h".to_owned())?;
    match Duration::try_from_secs_f64(seconds * unit) {
        Ok(time) if !time.is_zero() => Ok(time),
        _ => Err("a time must be more than 0 and finite".into()),
    }
}

/// Samples in a block.
pub(crate) fn block_size(text: &str) -> Parsed<u32> {
    match text.parse::<u32>() {
        Ok(size) if size.is_power_of_two() => Ok(size),
        _ => Err("must be a power of two: 1, 2, 4, 8, ...".into()),
    }
}

/// A share of a whole: a number from 0 to 1, or a percentage.
pub(crate) fn share(text: &str) -> Parsed<f32> {
    let (number, whole) = text.strip_suffix('%').map_or((text, 1.0), |number| (number, 100.0));
    match number.trim().parse::<f32>() {
        // Divided, 5% is 0.05; times 0.01 it would be off by a rounding.
        Ok(value) if (0.0..=whole).contains(&value) => Ok(value / whole),
        _ => Err("expected a share from 0 to 1, such as 0.05 or 5%".into()),
    }
}

/// A confidence.
pub(crate) fn confidence(text: &str) -> Parsed<f64> {
    match text.parse::<f64>() {
        Ok(value) if (0.5..1.0).contains(&value) => Ok(value),
        _ => Err("expected a number from 0.5 to below 1, such as 0.95".into()),
    }
}

/// Any finite number.
pub(crate) fn finite(text: &str) -> Parsed<f32> {
    match text.parse::<f32>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err("must be a finite number".into()),
    }
}

/// A finite number, 0 or more.
pub(crate) fn not_negative(text: &str) -> Parsed<f32> {
    finite(text).ok().filter(|v| *v >= 0.0).ok_or("must be finite and not negative".into())
}

/// A finite number more than 0.
pub(crate) fn positive(text: &str) -> Parsed<f32> {
    finite(text).ok().filter(|v| *v > 0.0).ok_or("must be finite and more than 0".into())
}

fn list<T: FromStr>(text: &str) -> Option<Vec<T>> {
    text.split(',').map(|item| item.trim().parse().ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resolution_is_two_sides_in_range() {
        assert_eq!(resolution("640x480"), Ok((640, 480)));
        assert_eq!(resolution("1X65535"), Ok((1, 65535)));
        for bad in ["", "640", "640x", "0x4", "4x0", "65536x1", "4x4x4", "-4x4", "4 x 4", "1e2x4"] {
            assert!(resolution(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn rectangles_have_an_area() {
        assert_eq!(crop("1,2,3,4"), Ok(Crop { x: 1, y: 2, width: 3, height: 4 }));
        assert_eq!(pixel("7,9"), Ok(Crop { x: 7, y: 9, width: 1, height: 1 }));
        for bad in ["", "1,2,3", "1,2,0,4", "1,2,3,0", "1,2,3,4,5", "-1,2,3,4", "4294967296,0,1,1"]
        {
            assert!(crop(bad).is_err(), "{bad}");
        }
        assert!(pixel("1").is_err() && pixel("-1,0").is_err());
    }

    #[test]
    fn times_have_units() {
        let seconds = |text| duration(text).map(|d| d.as_secs_f64());
        assert_eq!(seconds("30"), Ok(30.0));
        assert_eq!(seconds("0.5s"), Ok(0.5));
        assert_eq!(seconds("1.5m"), Ok(90.0));
        assert_eq!(seconds("2h"), Ok(7200.0));
        for bad in ["", "s", "0", "-1", "nan", "inf", "1e300h", "5d", "5µ"] {
            assert!(duration(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn radiance_is_grey_or_a_colour() {
        assert_eq!(radiance("0.5"), Ok(Vec3::splat(0.5)));
        assert_eq!(radiance("1, 2,3"), Ok(Vec3::new(1.0, 2.0, 3.0)));
        for bad in ["", "1,2", "-1", "nan", "1,inf,1", "1,2,3,4"] {
            assert!(radiance(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn numbers_are_checked() {
        assert_eq!(block_size("16"), Ok(16));
        assert!(["0", "3", "-2", "x", "8589934592"].iter().all(|t| block_size(t).is_err()));
        assert!(finite("-2").is_ok() && finite("nan").is_err() && finite("1e39").is_err());
        assert!(not_negative("0").is_ok() && not_negative("-0.1").is_err());
        assert_eq!([share("0.05"), share("5%"), share("0")], [Ok(0.05), Ok(0.05), Ok(0.0)]);
        assert!(["", "%", "-1", "1.5", "nan", "200%"].iter().all(|t| share(t).is_err()));
        assert!(confidence("0.95").is_ok());
        assert!(["1", "0.4", "95", "nan"].iter().all(|t| confidence(t).is_err()));
        assert!(positive("0").is_err() && positive("1e-30").is_ok());
    }

    #[test]
    fn each_word_stands_for_one_value() {
        for (word, value, _) in STRATEGIES {
            assert_eq!(word_for(STRATEGIES, value), *word);
        }
        for (word, value, _) in ACCELS {
            assert_eq!(word_for(ACCELS, value), *word);
        }
    }
}
