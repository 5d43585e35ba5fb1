// Light is found by light samples alone, except through delta lobes and by the camera.
#import generated

// Weight of emission met by a ray of density `scatter_pdf` where light sampling has `light_pdf`.
fn strategy_emission_weight(scatter_pdf: f32, light_pdf: f32) -> f32 {
    return select(0.0, 1.0, scatter_pdf == PDF_DELTA);
}

// Weight of a light sample where scattering has `scatter_pdf`.
fn strategy_light_weight(light_pdf: f32, scatter_pdf: f32) -> f32 {
    return 1.0;
}
