// Light samples and scattered rays, weighted by the power heuristic (Veach 1997, section 9.2).
// Densities of light samples are multiplied by their number (the multi-sample model).
#import frame/frame

// Ratio form: no square of a density can overflow.
fn mis_power(pdf: f32, other_pdf: f32) -> f32 {
    if pdf <= 0.0 {
        return 0.0;
    }
    let r = other_pdf / pdf;
    return 1.0 / (1.0 + r * r);
}

// Weight of emission met by a ray of density `scatter_pdf` where light sampling has `light_pdf`.
fn strategy_emission_weight(scatter_pdf: f32, light_pdf: f32) -> f32 {
    if scatter_pdf == PDF_DELTA {
        return 1.0;
    }
    return mis_power(scatter_pdf, light_pdf * f32(frame.light_samples));
}

// Weight of a light sample where scattering has `scatter_pdf`.
fn strategy_light_weight(light_pdf: f32, scatter_pdf: f32) -> f32 {
    if light_pdf == PDF_DELTA {
        return 1.0;
    }
    return mis_power(light_pdf * f32(frame.light_samples), scatter_pdf);
}
