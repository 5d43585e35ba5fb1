// Emissive spheres: the cone that they subtend from outside, their area from inside.
#import light/light
#import sample/warp

// What both the sample and its density need to know about sphere and receiver.
struct SphereView {
    is_inside: bool,
    // Unit, towards the centre.
    axis: vec3<f32>,
    distance: f32,
    // Squared sine of the cone's half angle, and 1 - cos of it without cancellation.
    sin2: f32,
    one_minus_cos: f32,
}

fn light_sphere_view(l: Light, from_point: vec3<f32>) -> SphereView {
    let toward = l.a - from_point;
    let radius = l.b.x;
    let distance = length(toward);
    var v: SphereView;
    v.axis = surface_unit(toward);
    v.distance = distance;
    // A receiver on the sphere itself counts as inside: spawned points lie off it by an offset.
    v.is_inside = distance <= radius + 2.0 * spawn_offset(max(max_component(abs(l.a)), radius));
    let ratio = radius / max(distance, radius);
    v.sin2 = ratio * ratio;
    let cosine = sqrt(max(0.0, (distance - radius) * (distance + radius))) / max(distance, radius);
    v.one_minus_cos = v.sin2 / (1.0 + cosine);
    return v;
}

// Cone: 1 / (2 π (1 - cos)). Inside: d² / (4 π R² cos) at the point of the sphere in
// direction `toward`.
fn light_sphere_density(l: Light, v: SphereView, toward: vec3<f32>, n: vec3<f32>) -> f32 {
    if !v.is_inside {
        return l.pmf / (2.0 * PI * v.one_minus_cos);
    }
    let d2 = dot(toward, toward);
    let projected = abs(dot(n, toward)) / sqrt(d2) * (4.0 * PI * l.b.x * l.b.x);
    // At no distance the quotient above is none.
    return select(l.pmf * d2 / projected, 0.0, d2 <= 0.0 || projected <= 0.0);
}

fn light_sphere_sample(l: Light, s: Surface, u: vec2<f32>) -> LightSample {
    let v = light_sphere_view(l, s.position);
    if v.is_inside && l.is_double_sided == 0u {
        return light_none();
    }
    let radius = l.b.x;
    var n: vec3<f32>;
    var from_point = s.position;
    if v.is_inside {
        n = warp_sphere(u);
        // Where scattered rays begin: the flat ones are met much farther on than they would
        // be from the surface itself, and their weights would not add up.
        from_point = ray_spawn(s.position, s.ng, s.offset, s.ng);
    } else {
        n = light_sphere_cone(v, radius, u);
    }
    let point = l.a + radius * n;
    let toward = point - from_point;
    let pdf = light_sphere_density(l, v, toward, n);
    if pdf <= 0.0 {
        return light_none();
    }
    // Beyond the error of a hit seen from the receiver, which grows with the distance.
    let extent = max(max_component(abs(l.a)), max(radius, v.distance));
    let offset = spawn_offset(extent) * select(1.0, -1.0, v.is_inside);
    return LightSample(surface_unit(toward), pdf, light_color(l) / pdf, point + offset * n, false);
}

// Normal of the sphere at the near end of a direction uniform in the cone.
fn light_sphere_cone(v: SphereView, radius: f32, u: vec2<f32>) -> vec3<f32> {
    // 1 - cos of the angle to the axis, and its squared sine.
    let h = u.x * v.one_minus_cos;
    let sin2 = h * (2.0 - h);
    let cosine = 1.0 - h;
    // Angle at the centre (pbrt 4th ed., section 6.2.4, in terms of sines).
    let k = v.distance / radius;
    let cos_center = sin2 * k + cosine * sqrt(max(0.0, 1.0 - sin2 * k * k));
    let sin_center = sqrt(max(0.0, 1.0 - cos_center * cos_center));
    let phi = 2.0 * PI * u.y;
    let f = frame_from_normal(v.axis);
    return surface_unit(f * vec3<f32>(sin_center * cos(phi), sin_center * sin(phi), -cos_center));
}

fn light_sphere_pdf(l: Light, s: Surface, from_point: vec3<f32>, ray_origin: vec3<f32>) -> f32 {
    let v = light_sphere_view(l, from_point);
    if v.is_inside && l.is_double_sided == 0u {
        return 0.0;
    }
    return light_sphere_density(l, v, s.position - select(from_point, ray_origin, v.is_inside), s.ng);
}
