// Reflectance of a surface that light passes: Fresnel's equations, strengthened or coloured as
// KHR_materials_specular does Schlick's form.
#import bsdf/bsdf
#import bsdf/dielectric

// Below this difference of the indices from each other a rough interface refracts like a smooth
// one: the direction does not depend on the microfacet, and the lobe's density has no bound.
const LEAST_CONTRAST: f32 = 1e-3;

// Reflectance at normal incidence; the same for both sides.
fn interface_r(eta: f32) -> f32 {
    let r = (1.0 - eta) / (1.0 + eta);
    return r * r;
}

// What the colour of f0 adds to f90 X, over 1 - X: nothing by default. X is Fresnel's reflectance.
fn interface_excess(f0: vec3<f32>, f90: f32, eta: f32) -> vec3<f32> {
    let r = interface_r(eta);
    return (f0 - vec3<f32>(r * f90)) / (1.0 - r);
}

fn interface_reflectance(b: Bsdf, cos_h: f32) -> vec3<f32> {
    let x = fresnel_dielectric(cos_h, b.eta).reflectance;
    if x >= 1.0 {
        return vec3<f32>(1.0);
    }
    return clamp(b.diffuse_f90 * x + b.interface_excess * (1.0 - x), vec3<f32>(0.0), vec3<f32>(1.0));
}
