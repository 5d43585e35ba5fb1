// Lights without extent (KHR_lights_punctual).
#import light/light

// Windows the inverse square law to zero at the range, as the extension recommends.
fn light_range_window(distance: f32, range: f32) -> f32 {
    let r = distance / range;
    let r2 = r * r;
    return clamp(1.0 - r2 * r2, 0.0, 1.0);
}

fn light_spot_falloff(l: Light, wi: vec3<f32>) -> f32 {
    let scale = 1.0 / max(1e-3, l.c.y - l.c.z);
    let x = clamp((dot(l.b, -wi) - l.c.z) * scale, 0.0, 1.0);
    return x * x;
}

fn light_punctual_sample(l: Light, s: Surface) -> LightSample {
    let color = light_color(l) / l.pmf;
    if l.kind == LIGHT_DIRECTIONAL {
        return LightSample(-l.b, PDF_DELTA, color, vec3<f32>(0.0), true);
    }
    let toward = l.a - s.position;
    let d2 = dot(toward, toward);
    let wi = surface_unit(toward);
    var strength = light_range_window(sqrt(d2), l.c.x) / d2;
    if l.kind == LIGHT_SPOT {
        strength *= light_spot_falloff(l, wi);
    }
    return LightSample(wi, PDF_DELTA, color * strength, l.a, false);
}
