// Light is found by scattered rays alone.

// Weight of emission met by a ray of density `scatter_pdf` where light sampling has `light_pdf`.
fn strategy_emission_weight(scatter_pdf: f32, light_pdf: f32) -> f32 {
    return 1.0;
}
