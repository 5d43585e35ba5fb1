//! What is known of a set of lights: where they are, where they shine, how strongly.

use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// Directions within `angle` radians of `axis`, a unit vector.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cone {
    pub(super) axis: DVec3,
    pub(super) angle: f64,
}

impl Cone {
    pub(super) const ALL: Cone = Cone { axis: DVec3::Z, angle: PI };

    /// A cone that holds both: the narrowest about the great circle through the axes.
    fn union(self, other: Cone) -> Cone {
        let between = self.axis.angle_between(other.axis);
        let (wide, narrow) = if self.angle >= other.angle { (self, other) } else { (other, self) };
        if (between + narrow.angle).min(PI) <= wide.angle {
            return wide;
        }
        let angle = 0.5 * (wide.angle + between + narrow.angle);
        let side = wide.axis.cross(narrow.axis).cross(wide.axis);
        if angle >= PI || side == DVec3::ZERO {
            return Cone::ALL;
        }
        let (sin, cos) = (angle - wide.angle).sin_cos();
        Cone { axis: (wide.axis * cos + side.normalize() * sin).normalize(), angle }
    }
}

/// Bounds of one light or of several.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LightBounds {
    pub(super) min: DVec3,
    pub(super) max: DVec3,
    /// Of the normals of the surfaces.
    pub(super) cone: Cone,
    /// How far from their normals they shine, radians.
    pub(super) emission_angle: f64,
    /// They shine against their normals too.
    pub(super) is_double_sided: bool,
    /// Sum of the greatest radiant intensities, as luminance, W/sr.
    pub(super) intensity: f64,
}

impl LightBounds {
    /// A flat surface that spans `points` and shines along `normal`, or both ways.
    pub(crate) fn flat(points: &[DVec3], normal: DVec3, both: bool, intensity: f64) -> Self {
        let fold = |pick: fn(DVec3, DVec3) -> DVec3| points.iter().copied().reduce(pick);
        Self {
            min: fold(DVec3::min).unwrap_or_default(),
            max: fold(DVec3::max).unwrap_or_default(),
            cone: normal.try_normalize().map_or(Cone::ALL, |axis| Cone { axis, angle: 0.0 }),
            emission_angle: FRAC_PI_2,
            is_double_sided: both,
            intensity,
        }
    }

    /// A ball, or a point, that shines in all directions.
    pub(crate) fn ball(center: DVec3, radius: f64, intensity: f64) -> Self {
        Self {
            min: center - radius,
            max: center + radius,
            cone: Cone::ALL,
            emission_angle: FRAC_PI_2,
            is_double_sided: false,
            intensity,
        }
    }

    /// A point that shines fully within `inner` radians of `axis` and not beyond `outer`.
    pub(crate) fn spot(at: DVec3, axis: DVec3, inner: f64, outer: f64, intensity: f64) -> Self {
        Self {
            cone: Cone { axis: axis.normalize(), angle: inner },
            emission_angle: (outer - inner).clamp(0.0, FRAC_PI_2),
            ..Self::ball(at, 0.0, intensity)
        }
    }

    pub(super) fn union(self, other: Self) -> Self {
        let both = self.is_double_sided && other.is_double_sided;
        // A normal and its opposite are the same where both sides shine.
        let flip = both && self.cone.axis.dot(other.cone.axis) < 0.0;
        let axis = if flip { -other.cone.axis } else { other.cone.axis };
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
            cone: self.cone.union(Cone { axis, ..other.cone }),
            emission_angle: self.emission_angle.max(other.emission_angle),
            is_double_sided: self.is_double_sided || other.is_double_sided,
            intensity: self.intensity + other.intensity,
        }
    }

    pub(super) fn center(&self) -> DVec3 {
        0.5 * (self.min + self.max)
    }

    /// Of the sphere about the box.
    pub(super) fn radius(&self) -> f64 {
        0.5 * self.min.distance(self.max)
    }

    /// Intensity, times the solid angle that the lights shine into, times the box's surface area
    /// (Conty Estevez and Kulla 2018, section 4.4). `thinness` counts boxes the more, the
    /// narrower they are along the axis of a split.
    pub(super) fn cost(&self, thinness: f64) -> f64 {
        let (o, e) = (self.cone.angle, self.emission_angle);
        let w = (o + e).min(PI);
        // Around the cone the emission falls by the cosine.
        let around = 2.0 * w * o.sin() - (o - 2.0 * w).cos() - 2.0 * o * o.sin() + o.cos();
        let solid_angle = 2.0 * PI * (1.0 - o.cos()) + FRAC_PI_2 * around;
        let d = self.max - self.min;
        let area = 2.0 * (d.x * d.y + d.y * d.z + d.z * d.x);
        self.intensity * solid_angle * area * thinness
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn directions() -> impl Iterator<Item = DVec3> {
        // A spiral over the sphere (Vogel 1979).
        (0..200).map(|i| {
            let z = 1.0 - (f64::from(i) + 0.5) / 100.0;
            let (s, c) = (f64::from(i) * 2.399_963).sin_cos();
            let r = (1.0 - z * z).sqrt();
            DVec3::new(r * c, r * s, z)
        })
    }

    #[test]
    fn a_union_of_cones_holds_both() {
        let angles = [0.0, 0.1, 1.0, 2.0, PI];
        for a in directions().step_by(7) {
            for b in directions().step_by(11).chain([a, -a]) {
                for (p, q) in angles.iter().flat_map(|&p| angles.map(|q| (p, q))) {
                    let (x, y) = (Cone { axis: a, angle: p }, Cone { axis: b, angle: q });
                    let both = x.union(y);
                    assert!((both.axis.length() - 1.0).abs() < 1e-12);
                    for d in directions().chain([a, b]) {
                        let inside =
                            |c: Cone, margin: f64| d.angle_between(c.axis) <= c.angle + margin;
                        let is_in_one = inside(x, -1e-7) || inside(y, -1e-7) || d == a || d == b;
                        assert!(!is_in_one || inside(both, 1e-7), "{x:?} {y:?} {both:?} {d}");
                    }
                }
            }
        }
    }

    /// Of a flat light: the cosine's integral over the hemisphere, π.
    #[test]
    fn the_solid_angle_of_a_lambertian_light_is_pi() {
        let points = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let light = LightBounds::flat(&points, DVec3::Z, false, 1.0);
        assert!((light.cost(1.0) / 2.0 - PI).abs() < 1e-12, "{}", light.cost(1.0));
        let ball = LightBounds::ball(DVec3::ZERO, 0.5, 1.0);
        assert!((ball.cost(1.0) / 6.0 - 4.0 * PI).abs() < 1e-12);
    }

    #[test]
    fn opposite_double_sided_lights_share_an_axis() {
        let flat = |n, both| LightBounds::flat(&[DVec3::ZERO], n, both, 1.0);
        let both = flat(DVec3::Z, true).union(flat(DVec3::NEG_Z, true));
        assert_eq!(both.cone.angle, 0.0);
        let one = flat(DVec3::Z, true).union(flat(DVec3::NEG_Z, false));
        assert_eq!(one.cone.angle, PI);
        assert!(one.is_double_sided);
    }
}
