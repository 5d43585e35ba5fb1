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

// Of a direction in the cone: 1 / (2 π (1 - cos)).
fn light_sphere_cone_pdf(l: Light, v: SphereView) -> f32 {
    return l.pmf / (2.0 * PI * v.one_minus_cos);
}

// Of a point of the sphere seen from inside, `toward` away and with normal n: d² / (4 π R² cos).
fn light_sphere_area_pdf(l: Light, toward: vec3<f32>, n: vec3<f32>) -> f32 {
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
    var to: SphereDirection;
    var pdf: f32;
    if v.is_inside {
        to.n = warp_sphere(u);
        let toward = l.a + radius * to.n - s.position;
        to.wi = surface_unit(toward);
        pdf = light_sphere_area_pdf(l, toward, to.n);
    } else {
        to = light_sphere_cone(v, radius, u);
        pdf = light_sphere_cone_pdf(l, v);
    }
    if pdf <= 0.0 {
        return light_none();
    }
    // Beyond the error of a hit seen from the receiver, which grows with the distance.
    let extent = max(max_component(abs(l.a)), max(radius, v.distance));
    let offset = spawn_offset(extent) * select(1.0, -1.0, v.is_inside);
    return LightSample(to.wi, pdf, light_color(l) / pdf, l.a + radius * to.n + offset * to.n, false);
}

// A direction, and the sphere's normal where it first meets the sphere.
struct SphereDirection {
    n: vec3<f32>,
    wi: vec3<f32>,
}

// Uniform in the cone.
fn light_sphere_cone(v: SphereView, radius: f32, u: vec2<f32>) -> SphereDirection {
    // 1 - cos of the angle to the axis, and its squared sine.
    let h = u.x * v.one_minus_cos;
    let sin2 = h * (2.0 - h);
    let cosine = 1.0 - h;
    // Angle at the centre (pbrt 4th ed., section 6.2.4, in terms of sines). Its sine is the
    // distance along the direction times the direction's own sine: exact for a close sphere too,
    // where the cosine is 1 but for rounding.
    let k = v.distance / radius;
    let root = sqrt(max(0.0, 1.0 - sin2 * k * k));
    let along = (v.distance - radius) * (v.distance + radius) / (v.distance * cosine + radius * root);
    let sine = sqrt(sin2);
    let sin_center = along * sine / radius;
    let cos_center = sin2 * k + cosine * root;
    let phi = 2.0 * PI * u.y;
    let around = vec2<f32>(cos(phi), sin(phi));
    let f = frame_from_normal(v.axis);
    let n = surface_unit(f * vec3<f32>(sin_center * around, -cos_center));
    return SphereDirection(n, surface_unit(f * vec3<f32>(sine * around, cosine)));
}

// By the direction and not by the point that the ray met: rays leave from beside `from_point`, and
// light samples do not know that.
fn light_sphere_pdf(l: Light, s: Surface, from_point: vec3<f32>) -> f32 {
    let v = light_sphere_view(l, from_point);
    if !v.is_inside {
        return light_sphere_cone_pdf(l, v);
    }
    let radius = l.b.x;
    // Along the ray: to the point nearest to the centre, and from there half the chord, which
    // from within is no less.
    let middle = -dot(s.wo, v.axis) * v.distance;
    let depth = max(0.0, (radius - v.distance) * (radius + v.distance));
    let half_chord = sqrt(middle * middle + depth);
    let d = select(depth / (half_chord - middle), middle + half_chord, middle >= 0.0);
    if l.is_double_sided == 0u || half_chord <= 0.0 {
        return 0.0;
    }
    return l.pmf * d * d / (4.0 * PI * radius * half_chord);
}
