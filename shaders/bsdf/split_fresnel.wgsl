// What the base reflects where metal and dielectric are not one Schlick form.
#import bsdf/bsdf
#if TRANSMISSION
#import bsdf/interface
#endif
#if IRIDESCENCE
#import bsdf/thin_film
#endif

fn split_reflectance(b: Bsdf, cos_h: f32) -> Reflectance {
    var metal = fresnel_schlick(b.metal_f0, 1.0, cos_h);
    var dielectric = fresnel_schlick(b.dielectric_f0, b.diffuse_f90, cos_h);
#if TRANSMISSION
    if b.is_interface {
        dielectric = interface_reflectance(b, cos_h);
    }
#endif
#if IRIDESCENCE
    if b.film > 0.0 && b.metallic > 0.0 {
        metal = mix(metal, film_reflectance(cos_h, b.film_ior, b.film_thickness, b.metal_f0), b.film);
    }
    if b.film > 0.0 && b.metallic < 1.0 {
        dielectric = mix(dielectric, film_reflectance(cos_h, b.film_ior, b.film_thickness, b.dielectric_f0), b.film);
    }
#endif
    let under = 1.0 - max_component(dielectric);
#if ENERGY_COMPENSATION
    metal *= 1.0 + b.metal_f0 * b.lost;
    dielectric *= 1.0 + b.dielectric_f0 * b.lost;
#endif
    return Reflectance(b.metallic * metal + (1.0 - b.metallic) * dielectric, under);
}
