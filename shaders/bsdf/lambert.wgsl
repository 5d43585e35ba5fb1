// The Lambert lobe.
#import sample/warp

fn lambert_sample(u: vec2<f32>) -> vec3<f32> {
    return warp_cosine_hemisphere(u);
}

// cos / π: also the lobe's value for albedo 1, cosine included.
fn lambert_pdf(wi: vec3<f32>) -> f32 {
    return max(wi.z, 0.0) * INV_PI;
}
