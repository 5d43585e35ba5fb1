// Scattering at a surface: the lobes and how they are chosen.
//
// Contract. Directions are in the frame with z = shading normal on wo's side, and
// both point away from the surface. `eval` includes |cos| of wi and covers the lobes
// that have a density; `pdf` is per solid angle and includes the lobe's
// probability; weight = eval / pdf. pdf 0 is no sample; PDF_DELTA marks a
// direction that has no density.
#import math/math
#import sample/warp
#import bsdf/fresnel
#import bsdf/lambert
#if GGX
#import bsdf/ggx
#endif
#if TRANSMISSION
#import bsdf/dielectric
#endif

// Below this GGX is a mirror: in f32 the half vector would be the larger error.
const LEAST_ALPHA: f32 = 1e-3;

struct Bsdf {
    // Albedo of the Lambert lobe under its dielectric coat.
    diffuse: vec3<f32>,
    // Reflectance of the coat, Schlick's form: largest component at normal and at grazing incidence.
    diffuse_f0: f32,
    // Reflectance of the specular lobe (coat and metal), Schlick's form.
    specular_f0: vec3<f32>,
    diffuse_f90: f32,
    // Share of light that passes the surface, without Fresnel's factor.
    transmitted: vec3<f32>,
    specular_f90: f32,
    // GGX width; 0 is a mirror.
    alpha: f32,
    // Index on wo's side over index on the other.
    eta: f32,
    // Light passes straight on instead of refracting.
    is_thin: bool,
}

struct BsdfSample {
    wi: vec3<f32>,
    pdf: f32,
    weight: vec3<f32>,
    // Factor by which refraction scaled radiance: not a loss, so roulette ignores it.
    eta_scale: f32,
}

// Probabilities of the lobes for a given wo; they sum to one, or to zero for a black surface.
struct Lobes {
    diffuse: f32,
    specular: f32,
    transmitted: f32,
}

const SAMPLE_NONE: BsdfSample = BsdfSample(vec3<f32>(0.0), 0.0, vec3<f32>(0.0), 1.0);

fn bsdf_specular_fresnel(b: Bsdf, cos_o: f32) -> vec3<f32> {
    return fresnel_schlick(b.specular_f0, b.specular_f90, cos_o);
}

// What the coat leaves to the Lambert lobe.
fn bsdf_below_coat(b: Bsdf, cos_h: f32) -> f32 {
    return 1.0 - fresnel_schlick(vec3<f32>(b.diffuse_f0), b.diffuse_f90, cos_h).x;
}

fn bsdf_lobes(b: Bsdf, cos_o: f32) -> Lobes {
    var diffuse = luminance(b.diffuse) * bsdf_below_coat(b, cos_o);
    var specular = luminance(bsdf_specular_fresnel(b, cos_o));
    var transmitted = 0.0;
#if TRANSMISSION
    if bsdf_transmits(b) {
        let f = fresnel_dielectric(cos_o, b.eta).reflectance;
        specular = f;
        transmitted = luminance(b.transmitted) * (1.0 - f);
    }
#endif
    let sum = diffuse + specular + transmitted;
    if sum <= 0.0 {
        return Lobes(0.0, 0.0, 0.0);
    }
    return Lobes(diffuse / sum, specular / sum, transmitted / sum);
}

fn bsdf_transmits(b: Bsdf) -> bool {
    return max_component(b.transmitted) > 0.0;
}

// Whether any lobe has a density, so that light samples can contribute.
fn bsdf_is_smooth(b: Bsdf) -> bool {
    return max_component(b.diffuse) > 0.0 || (b.alpha > 0.0 && max(max_component(b.specular_f0), b.specular_f90) > 0.0);
}

// Scattered radiance for unit radiance from wi, times |cos wi|.
fn bsdf_eval(b: Bsdf, wo: vec3<f32>, wi: vec3<f32>) -> vec3<f32> {
    if wi.z <= 0.0 || wo.z <= 0.0 {
        return vec3<f32>(0.0);
    }
    // Half the sum's length is the cosine of either direction to h: the same both ways.
    let sum = wo + wi;
    let cos_h = 0.5 * length(sum);
    let h = normalize(sum);
    var f = b.diffuse * (bsdf_below_coat(b, cos_h) * lambert_pdf(wi));
#if GGX
    if b.alpha > 0.0 {
        f += bsdf_specular_fresnel(b, cos_h) * ggx_eval(b.alpha, wo, wi, h);
    }
#endif
    return f;
}
