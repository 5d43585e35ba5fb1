// Directions for the lobes that have a density, drawn by those lobes.
#import bsdf/bsdf

// Stands for the probability of no lobe where rounding leaves it to a sample.
const LEAST_REST: f32 = 1e-30;

// Density of smooth_sample, including the lobes' probabilities.
fn smooth_pdf(b: Bsdf, lobes: Lobes, wo: vec3<f32>, wi: vec3<f32>) -> f32 {
    if wi.z <= 0.0 {
        return smooth_pdf_below(b, lobes, wo, wi);
    }
    var pdf = lobes.diffuse * lambert_pdf(wi);
#if GGX
    if width_is_rough(b.alpha) {
        let h = normalize(wo + wi);
        var probability = lobes.specular;
#if ROUGH_TRANSMISSION
        if b.is_interface {
            probability = (lobes.specular + lobes.transmitted) * refraction_reflects(b, dot(wo, h));
        }
#endif
        pdf += probability * ggx_pdf(b.alpha, wo, wi, h);
    }
#endif
#if SHEEN
    pdf += lobes.sheen * sheen_pdf(b, wo, wi);
#endif
#if CLEARCOAT
    pdf += lobes.coat * coat_pdf(b, wo, wi);
#endif
    return pdf;
}

fn smooth_pdf_below(b: Bsdf, lobes: Lobes, wo: vec3<f32>, wi: vec3<f32>) -> f32 {
    var pdf = 0.0;
#if LOWER_LOBES
    if wi.z == 0.0 {
        return 0.0;
    }
#if DIFFUSE_TRANSMISSION
    pdf += lobes.diffuse_below * lambert_pdf(vec3<f32>(wi.xy, -wi.z));
#endif
#if ROUGH_TRANSMISSION
    if bsdf_refracts_roughly(b) {
        pdf += (lobes.specular + lobes.transmitted) * refraction_pdf(b, wo, wi);
    }
#endif
#endif
    return pdf;
}

// `share` of the probability is left to these lobes; u.x is uniform over it, u.z is the choice.
fn smooth_sample(b: Bsdf, lobes: Lobes, wo: vec3<f32>, u: vec3<f32>, share: f32) -> SmoothDirection {
    var x = u.x;
    var rest = share;
#if DIFFUSE_TRANSMISSION
    let below = lobes.diffuse_below / rest;
    if x < below {
        let up = lambert_sample(vec2<f32>(min(x / below, ONE_BELOW), u.y));
        return SmoothDirection(vec3<f32>(up.xy, -up.z), u.z);
    }
    x = min((x - below) / (1.0 - below), ONE_BELOW);
    rest = max(rest - lobes.diffuse_below, LEAST_REST);
#endif
#if SHEEN
    let fibres = lobes.sheen / rest;
    if x < fibres {
        return SmoothDirection(sheen_sample(b, wo, vec2<f32>(min(x / fibres, ONE_BELOW), u.y)), u.z);
    }
    x = min((x - fibres) / (1.0 - fibres), ONE_BELOW);
    rest = max(rest - lobes.sheen, LEAST_REST);
#endif
#if CLEARCOAT
    let coat = select(0.0, lobes.coat / rest, b.coat.alpha > 0.0);
    if x < coat {
        return SmoothDirection(coat_sample(b, wo, vec2<f32>(min(x / coat, ONE_BELOW), u.y)), u.z);
    }
    x = min((x - coat) / (1.0 - coat), ONE_BELOW);
    rest = max(rest - select(0.0, lobes.coat, b.coat.alpha > 0.0), LEAST_REST);
#endif
#if GGX
    let diffuse = lobes.diffuse / rest;
    if width_is_rough(b.alpha) && x >= diffuse {
        let v = vec2<f32>(min((x - diffuse) / (1.0 - diffuse), ONE_BELOW), u.y);
#if ROUGH_TRANSMISSION
        if b.is_interface {
            return refraction_sample(b, wo, v, u.z);
        }
#endif
        return SmoothDirection(ggx_above(ggx_sample(b.alpha, wo, v)), u.z);
    }
    if width_is_rough(b.alpha) {
        return SmoothDirection(lambert_sample(vec2<f32>(min(x / diffuse, ONE_BELOW), u.y)), u.z);
    }
#endif
    return SmoothDirection(lambert_sample(vec2<f32>(x, u.y)), u.z);
}
