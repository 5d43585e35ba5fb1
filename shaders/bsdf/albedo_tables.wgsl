// Directional albedos of lobes that have no closed form, by quadrature on the host.
#import math/exponential

// Values of ALBEDO_TABLE_SIDE rows of as many, of sheen and of GGX; rows by the fourth root of
// alpha, columns by the cube root of cos (1 + w) / (cos + w), where w is how wide the lobe is.
@group(0) @binding(12) var<uniform> albedos: array<vec4<f32>, ALBEDO_TABLE_LENGTH>;

fn albedo_texel(first: u32, row: u32, column: u32) -> f32 {
    let at = first + row * ALBEDO_TABLE_SIDE + column;
    return albedos[at >> 2u][at & 3u];
}

fn albedo_of(first: u32, cosine: f32, width: f32, alpha: f32) -> f32 {
    let most = f32(ALBEDO_TABLE_SIDE - 1u);
    let c = min(cosine, 1.0);
    let x = exp_accurate(log_accurate(max(c * (1.0 + width) / (c + width), 1e-30)) / 3.0) * most;
    let y = (sqrt(sqrt(alpha)) - ALBEDO_TABLE_LEAST) / (1.0 - ALBEDO_TABLE_LEAST) * most;
    let column = min(u32(max(x, 0.0)), ALBEDO_TABLE_SIDE - 2u);
    let row = min(u32(max(y, 0.0)), ALBEDO_TABLE_SIDE - 2u);
    let along = clamp(x - f32(column), 0.0, 1.0);
    let down = clamp(y - f32(row), 0.0, 1.0);
    let upper = mix(albedo_texel(first, row, column), albedo_texel(first, row, column + 1u), along);
    let lower = mix(albedo_texel(first, row + 1u, column), albedo_texel(first, row + 1u, column + 1u), along);
    return mix(upper, lower, down);
}

// Of white sheen; may exceed 1.
fn albedo_of_sheen(cosine: f32, alpha: f32) -> f32 {
    return albedo_of(0u, cosine, sqrt(alpha), alpha);
}

// Of GGX for reflectance 1, single scattering.
fn albedo_of_ggx(cosine: f32, alpha: f32) -> f32 {
    return albedo_of(ALBEDO_TABLE_SIDE * ALBEDO_TABLE_SIDE, cosine, alpha, alpha);
}
