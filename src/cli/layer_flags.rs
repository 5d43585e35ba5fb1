//! Flags of what picture files hold beside the picture.

use super::values::{self, Parsed, Word};
use clap::Args;
use std::path::Path;
use steradian::image::{OutputFormat, Precision};
use steradian::layers::LayerKind;

/// Words of `--layers`.
pub(crate) const LAYERS: &[Word<LayerKind>] = &[
    ("albedo", LayerKind::Albedo, "base colour"),
    ("N", LayerKind::ShadingNormal, "shading normal"),
    ("Ng", LayerKind::GeometricNormal, "geometric normal"),
    ("Z", LayerKind::Depth, "distance along the camera's axis"),
    ("P", LayerKind::Position, "position"),
    ("uv", LayerKind::Uv, "texture coordinates"),
    ("coverage", LayerKind::Coverage, "share that is not background"),
    ("id", LayerKind::Id, "indices of object and material"),
    ("crypto-object", LayerKind::CryptoObject, "Cryptomatte of objects"),
    ("crypto-material", LayerKind::CryptoMaterial, "Cryptomatte of materials"),
    ("motion", LayerKind::Motion, "motion in the picture"),
    ("variance", LayerKind::Variance, "variance of the mean luminance"),
];

/// Words of `--exr-precision`.
pub(crate) const PRECISIONS: &[Word<Precision>] = &[
    ("float", Precision::Float, "32 bits: what was rendered"),
    ("half", Precision::Half, "16 bits: 11 significant ones, up to 65504"),
];

/// Words of `--format`.
const FORMATS: &[Word<OutputFormat>] = &[
    ("png", OutputFormat::Png, "what a display shows"),
    ("exr", OutputFormat::Exr, "linear radiance"),
];

/// Words of `--denoise`.
const DENOISERS: &[Word<Denoiser>] =
    &[("oidn", Denoiser::Oidn, "Intel Open Image Denoise, if its library is installed")];

/// What takes noise away.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Denoiser {
    /// Intel Open Image Denoise.
    Oidn,
}

/// Stands for standard output in place of a file.
pub(crate) const STANDARD_OUTPUT: &str = "-";

/// What goes into picture files beside the picture.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Picture files")]
pub(crate) struct LayerFlags {
    /// Layers of an EXR beside its noise: all, or some of albedo, N, Ng, Z, P, uv, coverage, id,
    /// crypto-object, crypto-material, variance; and motion, which is not among all
    #[arg(long, value_name = "LIST", value_parser = layer_list, conflicts_with = "view")]
    pub(crate) layers: Option<LayerList>,

    /// Camera rays of a pixel that layers are means of
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=256))]
    pub(crate) layer_rays: u32,

    /// Layer motion: time since which things have moved; that of a frame (--fps) by default
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub(crate) motion_step: Option<f64>,

    /// Bits of the picture's R, G and B in an EXR; all layers have 32
    #[arg(long, value_parser = values::one_of(PRECISIONS), conflicts_with = "view")]
    pub(crate) exr_precision: Option<Precision>,

    /// Write into an EXR when it was made and how long that took: no two files are equal then
    #[arg(long, conflicts_with = "view")]
    pub(crate) exr_times: bool,

    /// Format of the picture on standard output (-o -)
    #[arg(long, value_parser = values::one_of(FORMATS))]
    pub(crate) format: Option<OutputFormat>,

    /// Add a denoised picture: layer `denoised` of an EXR, the file NAME.denoised.png for a PNG
    #[arg(long, value_parser = values::one_of(DENOISERS), conflicts_with_all = ["view", "pixel", "reference"])]
    pub(crate) denoise: Option<Denoiser>,
}

/// Value of `--layers`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LayerList(pub(crate) Vec<LayerKind>);

/// What of it a picture's writer needs.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct ExrOptions {
    pub(crate) layers: Vec<LayerKind>,
    pub(crate) precision: Precision,
    pub(crate) times: bool,
}

impl LayerFlags {
    pub(crate) fn kinds(&self) -> &[LayerKind] {
        self.layers.as_ref().map_or(&[], |list| &list.0)
    }

    pub(crate) fn exr(&self) -> ExrOptions {
        ExrOptions {
            layers: self.kinds().to_vec(),
            precision: self.exr_precision.unwrap_or_default(),
            times: self.exr_times,
        }
    }

    /// Format of the picture at `path`; `is_terminal`: whether standard output is one.
    pub(crate) fn format_of(
        &self,
        path: &Path,
        is_terminal: bool,
    ) -> steradian::Result<OutputFormat> {
        let wrong = |message: &str| Err(steradian::Error::Settings(message.into()));
        match (path == Path::new(STANDARD_OUTPUT), self.format) {
            (true, None) => wrong("-o -: give --format png or --format exr"),
            (true, Some(_)) if is_terminal => {
                wrong("-o -: standard output is a terminal; redirect it to a file or a program")
            }
            (true, Some(_)) if self.denoise.is_some() && self.format == Some(OutputFormat::Png) => {
                wrong("-o - with --denoise: a PNG has one picture; take --format exr")
            }
            (true, Some(format)) => Ok(format),
            (false, Some(_)) => wrong("--format: for -o -; elsewhere the name's ending says it"),
            (false, None) => OutputFormat::from_path(path),
        }
    }
}

fn layer_list(text: &str) -> Parsed<LayerList> {
    let mut kinds = Vec::new();
    for word in text.split(',').map(str::trim) {
        let all = || LayerKind::ALL.into_iter().filter(|kind| *kind != LayerKind::Motion);
        let found: Vec<LayerKind> = match LAYERS.iter().find(|(name, _, _)| *name == word) {
            Some((_, kind, _)) => vec![*kind],
            None if word == "all" => all().collect(),
            None => {
                let names: Vec<_> = LAYERS.iter().map(|(name, _, _)| *name).collect();
                return Err(format!("{word:?} is none of all, {}", names.join(", ")));
            }
        };
        for kind in found {
            if !kinds.contains(&kind) {
                kinds.push(kind);
            }
        }
    }
    Ok(LayerList(kinds))
}

fn seconds(text: &str) -> Parsed<f64> {
    match text.parse::<f64>() {
        Ok(seconds) if seconds > 0.0 && seconds.is_finite() => Ok(seconds),
        _ => Err("expected a time in seconds above 0".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flags(format: Option<OutputFormat>) -> LayerFlags {
        LayerFlags {
            layers: None,
            layer_rays: 16,
            motion_step: None,
            exr_precision: None,
            exr_times: false,
            format,
            denoise: None,
        }
    }

    #[test]
    fn a_list_of_layers_has_each_once() {
        let kinds = |text| layer_list(text).map(|list| list.0);
        assert_eq!(kinds("N, albedo,N"), Ok(vec![LayerKind::ShadingNormal, LayerKind::Albedo]));
        let all = kinds("all,N").unwrap();
        assert_eq!(all.len(), LayerKind::ALL.len() - 1);
        assert!(!all.contains(&LayerKind::Motion) && kinds("all,motion").unwrap().len() == 12);
        assert!(kinds("n").unwrap_err().contains("\"n\" is none of all, albedo, N, Ng"));
        assert!(kinds("").is_err());
        // All have a word.
        assert_eq!(LAYERS.iter().map(|(_, kind, _)| *kind).collect::<Vec<_>>(), LayerKind::ALL);
    }

    #[test]
    fn a_terminal_gets_no_picture() {
        let png = Some(OutputFormat::Png);
        let of = |format, path: &str, is_terminal| {
            flags(format).format_of(Path::new(path), is_terminal).map_err(|e| e.to_string())
        };
        assert_eq!(of(png, "-", false), Ok(OutputFormat::Png));
        assert!(of(png, "-", true).unwrap_err().contains("terminal"));
        assert!(of(None, "-", false).unwrap_err().contains("--format"));
        assert_eq!(of(None, "a.exr", true), Ok(OutputFormat::Exr));
        assert!(of(png, "a.exr", true).unwrap_err().contains("--format"));
    }
}
