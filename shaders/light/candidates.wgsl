// One light sample of several, kept with a probability in proportion to what it would give if nothing
// were in the way: resampled importance sampling (J. Talbot, D. Cline and P. Egbert 2005). The weights of
// strategies are those of a single candidate: any that add up to one leave the mean as it is.
#import light/light
#import bsdf/scatter

struct KeptCandidate {
    light: LightSample,
    radiance: vec3<f32>,
}

// Candidate k takes the part k of the range of `choice` and a shifted `u`: each is uniform over all, which
// is all that the mean asks for. `keep` decides.
fn candidates_sample(s: Surface, b: Bsdf, frame_s: mat3x3<f32>, u: vec2<f32>, choice: f32, keep: f32) -> KeptCandidate {
    var kept = KeptCandidate(light_none(), vec3<f32>(0.0));
    var kept_weight = 1.0;
    var sum = 0.0;
    var x = keep;
    let count = frame.light_candidates;
    for (var k = 0u; k < count; k++) {
        // Roberts' sequence: the shifts are far from each other.
        let v = min(fract(u + f32(k) * vec2<f32>(0.7548776662, 0.5698402910)), vec2<f32>(ONE_BELOW));
        let l = light_sample(s, v, min((f32(k) + choice) / f32(count), ONE_BELOW));
        let radiance = direct_radiance(s, b, frame_s, l);
        let weight = luminance(radiance);
        if weight > 0.0 {
            sum += weight;
            let share = weight / sum;
            let is_kept = x < share;
            x = min(select((x - share) / (1.0 - share), x / share, is_kept), ONE_BELOW);
            if is_kept {
                kept = KeptCandidate(l, radiance);
                kept_weight = weight;
            }
        }
    }
    kept.radiance *= sum / (f32(count) * kept_weight);
    return kept;
}
