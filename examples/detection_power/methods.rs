//! The methods that judge a picture.

use image::{RgbImage, imageops::grayscale};
use image_compare::{Algorithm, gray_similarity_structure};
use steradian::image::compare::{
    Comparison, ComparisonOptions, Noise, NoiseVerdict, PictureFile, Rule, VerdictSettings,
    ldr_flip,
};
use steradian::image::{Picture, srgb_from_linear};

/// False alarms of the statistical test.
pub(crate) const LEVEL: f64 = 1e-3;

/// Limit of FLIP's mean for pictures of the same seed, as vello's tests have it.
pub(crate) const FLIP_LIMIT: f64 = 0.01;

/// Least similarity of pictures of the same seed.
pub(crate) const SSIM_LIMIT: f64 = 0.99;

/// The methods, in the order of [`Rates::found`]. The first three see the same seed as the golden
/// picture has, the others other seeds.
pub(crate) const METHODS: [&str; 8] = [
    "exact",
    "FLIP < 0.01",
    "SSIM > 0.99",
    "FLIP, calibrated",
    "SSIM, calibrated",
    "RMS, calibrated",
    "verdict, runs",
    "verdict, long",
];

/// What pictures are compared with.
pub(crate) struct Evidence {
    /// One picture of the same samples.
    pub(crate) golden: PictureFile,
    /// Mean and variance of many runs.
    pub(crate) reference: PictureFile,
    /// One render of more samples.
    pub(crate) long: PictureFile,
}

/// What the methods say of a picture.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Found {
    is_exact: bool,
    flip: f64,
    /// Dissimilarity, 1 - SSIM.
    ssim: f64,
    rms: f64,
    /// P-values of the verdict against the reference and against the long render.
    p: [f64; 2],
}

/// Share of pictures that each method turns down.
#[derive(Debug, Clone)]
pub(crate) struct Rates {
    pub(crate) found: [f64; 8],
    pub(crate) count: usize,
}

impl Evidence {
    /// What every method says of `file`; of a clean one alarms are printed.
    pub(crate) fn judge(&self, file: &PictureFile, is_clean: bool) -> Found {
        let picture = file.picture().expect("colours");
        let golden = self.golden.picture().expect("colours");
        let settings = VerdictSettings { level: LEVEL, ..VerdictSettings::default() };
        let p = [&self.reference, &self.long].map(|expected| {
            let verdict = NoiseVerdict::of(file, expected, &settings).expect("noise of both");
            if is_clean && !verdict.agrees {
                eprintln!("  false alarm, {}:", verdict.basis);
                for plane in verdict.planes.iter().filter(|plane| !plane.alarms.is_empty()) {
                    let (x, z) = (plane.worst_pixel, plane.tiles[plane.worst_tile]);
                    eprintln!(
                        "  {} {:?} {:?} {x:?}, tile {z:.1}",
                        plane.name, plane.alarms, plane.p_values
                    );
                }
            }
            verdict.p_value
        });
        let rules = vec![Rule::Exact { layer: None }];
        let options = ComparisonOptions { rules, ..ComparisonOptions::default() };
        let comparison = Comparison::of(file, &self.golden, &options).expect("comparable");
        let flip = ldr_flip(&picture, &golden).map;
        let grey = |picture| grayscale(&shown(picture));
        let similarity = |algorithm| {
            let result = gray_similarity_structure(&algorithm, &grey(&picture), &grey(&golden));
            1.0 - result.expect("pictures of one size").score
        };
        Found {
            is_exact: comparison.passes(),
            flip: flip.iter().map(|&v| f64::from(v)).sum::<f64>() / flip.len() as f64,
            ssim: similarity(Algorithm::MSSIMSimple),
            rms: similarity(Algorithm::RootMeanSquared),
            p,
        }
    }

    /// The change of the mean luminance that a defect makes, and how many standard deviations of
    /// one picture it is for an observer who knows where to look: the root of the sum of
    /// (change / deviation)² over pixels, less what the noise of these pictures and the
    /// reference adds to it.
    pub(crate) fn visibility(&self, files: &[PictureFile]) -> (f64, f64) {
        let Some(Noise::Runs { luminance: Some(variance), runs, .. }) = &self.reference.noise
        else {
            return (f64::NAN, f64::NAN);
        };
        let truth = luminance(&self.reference.picture().expect("colours"));
        let pictures: Vec<Vec<f64>> =
            files.iter().map(|f| luminance(&f.picture().expect("colours"))).collect();
        let (n, runs) = (files.len() as f64, f64::from(*runs));
        let (mut sum, mut change) = (0.0, 0.0);
        for i in 0..truth.len() {
            let difference = pictures.iter().map(|p| p[i]).sum::<f64>() / n - truth[i];
            change += difference;
            let of_one = variance[i] * runs;
            if of_one > 0.0 {
                sum += difference * difference / of_one - 1.0 / n - 1.0 / runs;
            }
        }
        (change / truth.iter().sum::<f64>(), sum.max(0.0).sqrt())
    }

    /// Standard deviation of one picture's pixels over the mean, the root of the mean square.
    pub(crate) fn relative_noise(&self) -> f64 {
        let Some(Noise::Runs { luminance: Some(variance), runs, .. }) = &self.reference.noise
        else {
            return f64::NAN;
        };
        let mean = luminance(&self.reference.picture().expect("colours"));
        let n = mean.len() as f64;
        let variance = variance.iter().sum::<f64>() * f64::from(*runs) / n;
        variance.sqrt() / (mean.iter().sum::<f64>() / n)
    }
}

/// The largest FLIP, dissimilarity and RMS of clean pictures with other seeds: limits that these
/// pictures just keep.
pub(crate) fn limits(clean: &[Found]) -> [f64; 3] {
    let largest = |of: fn(&Found) -> f64| clean.iter().map(of).fold(0.0, f64::max);
    [largest(|f| f.flip), largest(|f| f.ssim), largest(|f| f.rms)]
}

/// Pictures whose p-values are below a level.
pub(crate) fn alarms(found: &[Found], level: f64) -> [usize; 2] {
    [0, 1].map(|k| found.iter().filter(|f| f.p[k] < level).count())
}

impl Rates {
    pub(crate) fn of(same_seed: &Found, found: &[Found], limits: &[f64; 3]) -> Self {
        let share = |is_found: &dyn Fn(&Found) -> bool| {
            found.iter().filter(|f| is_found(f)).count() as f64 / found.len() as f64
        };
        let once = |is_found: bool| f64::from(u8::from(is_found));
        Self {
            found: [
                once(!same_seed.is_exact),
                once(same_seed.flip >= FLIP_LIMIT),
                once(1.0 - same_seed.ssim <= SSIM_LIMIT),
                share(&|f| f.flip > limits[0]),
                share(&|f| f.ssim > limits[1]),
                share(&|f| f.rms > limits[2]),
                share(&|f| f.p[0] < LEVEL),
                share(&|f| f.p[1] < LEVEL),
            ],
            count: found.len(),
        }
    }
}

/// What a display shows.
fn shown(picture: &Picture) -> RgbImage {
    let code = |v: f32| (srgb_from_linear(v.clamp(0.0, 1.0)) * 255.0).round() as u8;
    let bytes = picture.rgb.iter().flatten().map(|&v| code(v)).collect();
    RgbImage::from_raw(picture.width, picture.height, bytes).expect("as many bytes")
}

fn luminance(picture: &Picture) -> Vec<f64> {
    let weights = [0.2126, 0.7152, 0.0722];
    let of = |p: &[f32; 3]| (0..3).map(|c| weights[c] * f64::from(p[c])).sum();
    picture.rgb.iter().map(of).collect()
}
