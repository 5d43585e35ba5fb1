// Scattering at a surface: the lobes and how they are chosen.
//
// Contract. Directions are in the frame with z = shading normal on wo's side, and
// both point away from the surface. `eval` includes |cos| of wi and covers the lobes
// that have a density, on both sides; `pdf` is per solid angle and includes the lobe's
// probability; weight = eval / pdf. pdf 0 is no sample; PDF_DELTA marks a
// direction that has no density. A Bsdf is made for one wo.
#import math/math
#import sample/warp
#import bsdf/fresnel
#import bsdf/lambert
#import bsdf/width
#if GGX
#import bsdf/ggx
#endif
#if TRANSMISSION
#import bsdf/dielectric
#endif
#if SPLIT_FRESNEL
#import bsdf/split_fresnel
#endif
#if ROUGH_TRANSMISSION
#import bsdf/rough_refraction
#endif
#if SHEEN
#import bsdf/sheen
#endif
#if CLEARCOAT
#import bsdf/clearcoat
#endif

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
    alpha: GgxWidth,
    // Index on wo's side over index on the other.
    eta: f32,
    // Light passes straight on instead of refracting.
    is_thin: bool,
#if SPLIT_FRESNEL
    // Metal and dielectric reflect as the fields from here on say, not by specular_f0 and diffuse_f0.
    is_split: bool,
    metal_f0: vec3<f32>,
    metallic: f32,
    dielectric_f0: vec3<f32>,
#if TRANSMISSION
    // The dielectric reflects by Fresnel's equations, with interface_excess.
    is_interface: bool,
    interface_excess: vec3<f32>,
#endif
#if IRIDESCENCE
    // Share of the surface under a film; its index, and its thickness in nm.
    film: f32,
    film_ior: f32,
    film_thickness: f32,
#endif
#if ENERGY_COMPENSATION
    // What GGX loses over what it keeps, for reflectance 1, at wo.
    lost: f32,
#endif
#endif
#if DIFFUSE_TRANSMISSION
    // Albedo of the Lambert lobe on the other side.
    diffuse_below: vec3<f32>,
#endif
#if SHEEN
    sheen: Sheen,
#endif
#if CLEARCOAT
    coat: Coat,
#endif
}

struct BsdfSample {
    wi: vec3<f32>,
    pdf: f32,
    weight: vec3<f32>,
    // Factor by which refraction scaled radiance: not a loss, so roulette ignores it.
    eta_scale: f32,
    // What is left of the choice that the sample was drawn with: uniform again.
    choice: f32,
}

// A direction of a lobe that has a density, or 0; and what is left of the choice.
struct SmoothDirection {
    wi: vec3<f32>,
    choice: f32,
}

// Probabilities of the lobes for a given wo; they sum to one, or to zero for a black surface.
struct Lobes {
    diffuse: f32,
    specular: f32,
    transmitted: f32,
#if DIFFUSE_TRANSMISSION
    diffuse_below: f32,
#endif
#if SHEEN
    sheen: f32,
#endif
#if CLEARCOAT
    coat: f32,
#endif
}

// Of the base's surface, for microfacets at one angle.
struct Reflectance {
    specular: vec3<f32>,
    // Share of the light that is left to what lies under the dielectric's surface.
    under: f32,
}

const SAMPLE_NONE: BsdfSample = BsdfSample(vec3<f32>(0.0), 0.0, vec3<f32>(0.0), 1.0, 0.0);

fn bsdf_reflectance(b: Bsdf, cos_h: f32) -> Reflectance {
#if SPLIT_FRESNEL
    if b.is_split {
        return split_reflectance(b, cos_h);
    }
#endif
    let under = 1.0 - fresnel_schlick(vec3<f32>(b.diffuse_f0), b.diffuse_f90, cos_h).x;
    return Reflectance(fresnel_schlick(b.specular_f0, b.specular_f90, cos_h), under);
}

fn bsdf_transmits(b: Bsdf) -> bool {
    return max_component(b.transmitted) > 0.0;
}

// Whether the microfacets of a rough surface both reflect and pass light.
fn bsdf_refracts_roughly(b: Bsdf) -> bool {
#if ROUGH_TRANSMISSION
    return b.is_interface && width_is_rough(b.alpha);
#else
    return false;
#endif
}

fn bsdf_lobes(b: Bsdf, cos_o: f32) -> Lobes {
    let r = bsdf_reflectance(b, cos_o);
    var l: Lobes;
    let under = bsdf_under_lambert(b, cos_o, r.under);
    l.diffuse = luminance(b.diffuse) * under;
    l.specular = luminance(r.specular);
    l.transmitted = 0.0;
#if TRANSMISSION
    if b.is_interface {
        l.specular = max_component(r.specular);
        l.transmitted = luminance(b.transmitted) * r.under;
    }
#endif
    var sum = l.diffuse + l.specular + l.transmitted;
#if DIFFUSE_TRANSMISSION
    l.diffuse_below = luminance(b.diffuse_below) * under;
    sum += l.diffuse_below;
#endif
    let base = bsdf_base_share(b);
    sum *= base;
#if SHEEN
    l.sheen = sheen_share(b);
    sum += l.sheen;
#endif
#if CLEARCOAT
    l.coat = b.coat.reflectance;
    sum += l.coat;
#endif
    if sum <= 0.0 {
        var none: Lobes;
        return none;
    }
    l.diffuse = l.diffuse * base / sum;
    l.specular = l.specular * base / sum;
    l.transmitted = l.transmitted * base / sum;
#if DIFFUSE_TRANSMISSION
    l.diffuse_below *= base / sum;
#endif
#if SHEEN
    l.sheen /= sum;
#endif
#if CLEARCOAT
    l.coat /= sum;
#endif
    return l;
}

// About what the surface leaves to the Lambert lobes; `under` is that of a mirror at wo. Within a
// volume that can be nothing, by total reflection, where most of the lobe is lit.
fn bsdf_under_lambert(b: Bsdf, cos_o: f32, under: f32) -> f32 {
    var is_plain = true;
#if SPLIT_FRESNEL
    is_plain = !b.is_split;
#endif
#if DIFFUSE_TRANSMISSION
    is_plain = is_plain && max_component(b.diffuse_below) <= 0.0;
#endif
    if is_plain {
        return under;
    }
    // For light from wo itself, and from along the normal.
    let middle = sqrt(0.5 + 0.5 * cos_o);
    return 0.5 * (bsdf_reflectance(b, 1.0).under + bsdf_reflectance(b, middle).under);
}

// Share of the light that the layers above the base leave to it, seen from wo.
fn bsdf_base_share(b: Bsdf) -> f32 {
    var share = 1.0;
#if SHEEN
    share *= 1.0 - b.sheen.albedo;
#endif
#if CLEARCOAT
    share *= 1.0 - b.coat.reflectance;
#endif
    return share;
}

// The same for light that is scattered into a direction of this cosine: what the base's value is
// multiplied by.
fn bsdf_base_factor(b: Bsdf, cos_i: f32) -> f32 {
    var factor = 1.0;
#if SHEEN
    factor *= sheen_leaves(b, abs(cos_i));
#endif
#if CLEARCOAT
    factor *= 1.0 - b.coat.reflectance;
#endif
    return factor;
}

// Whether any lobe has a density, so that light samples can contribute.
fn bsdf_is_smooth(b: Bsdf) -> bool {
    var is_smooth = max_component(b.diffuse) > 0.0;
    is_smooth = is_smooth || (width_is_rough(b.alpha) && bsdf_is_specular(b));
#if DIFFUSE_TRANSMISSION
    is_smooth = is_smooth || max_component(b.diffuse_below) > 0.0;
#endif
#if SHEEN
    is_smooth = is_smooth || b.sheen.albedo > 0.0;
#endif
#if CLEARCOAT
    is_smooth = is_smooth || b.coat.alpha > 0.0;
#endif
    return is_smooth;
}

// Whether what leaves the surface is the same in all directions: the Lambert lobe alone.
fn bsdf_is_matte(b: Bsdf) -> bool {
    var is_matte = b.diffuse_f90 <= 0.0 && b.diffuse_f0 <= 0.0 && !bsdf_is_specular(b) && !bsdf_transmits(b);
#if DIFFUSE_TRANSMISSION
    is_matte = is_matte && max_component(b.diffuse_below) <= 0.0;
#endif
#if SHEEN
    is_matte = is_matte && b.sheen.albedo <= 0.0;
#endif
#if CLEARCOAT
    is_matte = is_matte && b.coat.reflectance <= 0.0;
#endif
    return is_matte;
}

// Whether the base reflects at any angle.
fn bsdf_is_specular(b: Bsdf) -> bool {
#if SPLIT_FRESNEL
    if b.is_split {
        return true;
    }
#endif
    return max(max_component(b.specular_f0), b.specular_f90) > 0.0;
}

// Whether any of the lobes that have a density reaches below the surface: light samples from
// there can contribute too.
fn bsdf_reaches_below(b: Bsdf) -> bool {
    var reaches = bsdf_refracts_roughly(b) && bsdf_transmits(b);
#if DIFFUSE_TRANSMISSION
    reaches = reaches || max_component(b.diffuse_below) > 0.0;
#endif
    return reaches;
}

// Scattered radiance for unit radiance from wi, times |cos wi|.
fn bsdf_eval(b: Bsdf, wo: vec3<f32>, wi: vec3<f32>) -> vec3<f32> {
    if wo.z <= 0.0 || wi.z == 0.0 {
        return vec3<f32>(0.0);
    }
    let is_above = wi.z > 0.0;
    var f = vec3<f32>(0.0);
    if is_above {
        f = bsdf_eval_above(b, wo, wi);
    }
#if LOWER_LOBES
    if !is_above {
        f = bsdf_eval_below(b, wo, wi);
    }
#endif
    f *= bsdf_base_factor(b, wi.z);
#if SHEEN
    f += sheen_eval(b, wo, wi);
#endif
#if CLEARCOAT
    f += coat_eval(b, wo, wi);
#endif
    return f;
}

// What the base reflects.
fn bsdf_eval_above(b: Bsdf, wo: vec3<f32>, wi: vec3<f32>) -> vec3<f32> {
    // Half the sum's length is the cosine of either direction to h: the same both ways.
    let sum = wo + wi;
    let r = bsdf_reflectance(b, 0.5 * length(sum));
    var f = b.diffuse * (r.under * lambert_pdf(wi));
#if GGX
    if width_is_rough(b.alpha) {
        f += r.specular * ggx_eval(b.alpha, wo, wi, normalize(sum));
    }
#endif
    return f;
}

#if LOWER_LOBES
// What the base lets through; the diffuse lobe by the reflectance of the direction's mirror image.
fn bsdf_eval_below(b: Bsdf, wo: vec3<f32>, wi: vec3<f32>) -> vec3<f32> {
    var f = vec3<f32>(0.0);
#if DIFFUSE_TRANSMISSION
    let up = vec3<f32>(wi.xy, -wi.z);
    f += b.diffuse_below * (bsdf_reflectance(b, 0.5 * length(wo + up)).under * lambert_pdf(up));
#endif
#if ROUGH_TRANSMISSION
    if bsdf_refracts_roughly(b) {
        f += refraction_eval(b, wo, wi);
    }
#endif
    return f;
}
#endif
