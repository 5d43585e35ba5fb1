//! Values between keyframes (glTF 2.0, appendix C).

/// How a value goes from one keyframe to the next.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Interpolation {
    Step,
    /// Of rotations: spherical, by the shorter way.
    Linear,
    /// Each keyframe has an in-tangent, a value and an out-tangent.
    CubicSpline,
}

/// A value over time.
pub(super) struct Track {
    /// Rising, at least one.
    times: Vec<f64>,
    /// `width` numbers for each keyframe, or three times as many.
    values: Vec<f64>,
    width: usize,
    interpolation: Interpolation,
    is_rotation: bool,
}

impl Track {
    /// `width` is found from the number of values where it is not given. The error says
    /// which number does not fit.
    pub(super) fn new(
        times: Vec<f64>,
        values: Vec<f64>,
        width: Option<usize>,
        interpolation: Interpolation,
        is_rotation: bool,
    ) -> Result<Self, String> {
        let parts = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        let slots = times.len() * parts;
        let found = values.len() / slots;
        let width = width.unwrap_or(found);
        if width == 0 || width != found || !values.len().is_multiple_of(slots) {
            return Err(format!(
                "{} numbers of output do not fit {} keyframes of {interpolation:?}",
                values.len(),
                times.len()
            ));
        }
        let track = Self { times, values, width, interpolation, is_rotation };
        let is_zero = |key: usize| track.part(key, parts / 2).iter().all(|c| *c == 0.0);
        match (0..track.times.len()).find(|&key| is_rotation && is_zero(key)) {
            Some(key) => Err(format!("keyframe {key} is not a rotation: its length is 0")),
            None => Ok(track),
        }
    }

    /// The value at `time`; before the first and after the last keyframe, theirs.
    pub(super) fn at(&self, time: f64) -> Vec<f64> {
        let after = self.times.partition_point(|&t| t <= time);
        let Some(key) = after.checked_sub(1) else { return self.value(0).to_vec() };
        if after == self.times.len() || self.interpolation == Interpolation::Step {
            return self.value(key).to_vec();
        }
        let span = self.times[after] - self.times[key];
        let t = (time - self.times[key]) / span;
        let (a, b) = (self.value(key), self.value(after));
        match self.interpolation {
            Interpolation::CubicSpline => {
                let (leaving, arriving) = (self.part(key, 2), self.part(after, 0));
                let (t2, t3) = (t * t, t * t * t);
                let hermite = |k: usize| {
                    (2.0 * t3 - 3.0 * t2 + 1.0) * a[k]
                        + span * (t3 - 2.0 * t2 + t) * leaving[k]
                        + (3.0 * t2 - 2.0 * t3) * b[k]
                        + span * (t3 - t2) * arriving[k]
                };
                (0..self.width).map(hermite).collect()
            }
            _ if self.is_rotation => slerp(a, b, t),
            _ => a.iter().zip(b).map(|(a, b)| a + (b - a) * t).collect(),
        }
    }

    fn value(&self, key: usize) -> &[f64] {
        self.part(key, usize::from(self.interpolation == Interpolation::CubicSpline))
    }

    /// Of CubicSpline: 0 is the in-tangent, 1 the value, 2 the out-tangent.
    fn part(&self, key: usize, part: usize) -> &[f64] {
        let parts = if self.interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        &self.values[(key * parts + part) * self.width..][..self.width]
    }
}

/// Between two quaternions of positive length.
fn slerp(a: &[f64], b: &[f64], t: f64) -> Vec<f64> {
    let unit = |q: &[f64]| -> Vec<f64> {
        let length = q.iter().map(|c| c * c).sum::<f64>().sqrt();
        q.iter().map(|c| c / length).collect()
    };
    let (a, b) = (unit(a), unit(b));
    let dot: f64 = a.iter().zip(&b).map(|(a, b)| a * b).sum();
    let sign = 1.0_f64.copysign(dot);
    let angle = dot.abs().min(1.0).acos();
    // Sines of angles this small are the angles themselves.
    let (wa, wb) = match angle < 1e-8 {
        true => (1.0 - t, t),
        false => (((1.0 - t) * angle).sin() / angle.sin(), (t * angle).sin() / angle.sin()),
    };
    a.iter().zip(&b).map(|(a, b)| wa * a + sign * wb * b).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(values: &[f64], interpolation: Interpolation) -> Track {
        Track::new(vec![1.0, 3.0], values.into(), None, interpolation, false).unwrap()
    }

    #[test]
    fn each_interpolation_by_its_formula() {
        let step = track(&[10.0, 20.0], Interpolation::Step);
        assert_eq!(
            [0.0, 1.0, 2.9, 3.0, 9.0].map(|t| step.at(t)[0]),
            [10.0, 10.0, 10.0, 20.0, 20.0]
        );
        let linear = track(&[10.0, 20.0], Interpolation::Linear);
        assert_eq!([0.0, 1.5, 3.0, 9.0].map(|t| linear.at(t)[0]), [10.0, 12.5, 20.0, 20.0]);
        // A cubic is its own spline: x³ with tangents 3 x².
        let cubic = track(&[9.0, 1.0, 3.0, 27.0, 27.0, 9.0], Interpolation::CubicSpline);
        for t in [1.0, 1.5, 2.0, 2.75, 3.0_f64] {
            assert!((cubic.at(t)[0] - t.powi(3)).abs() < 1e-12, "{t}: {:?}", cubic.at(t));
        }
        assert_eq!((cubic.at(0.0)[0], cubic.at(9.0)[0]), (1.0, 27.0));
    }

    #[test]
    fn rotations_go_the_shorter_way_at_one_speed() {
        let about_y = |angle: f64| [0.0, (angle / 2.0).sin(), 0.0, (angle / 2.0).cos()];
        let turn = |a: [f64; 4], b: [f64; 4]| {
            let values = [a, b].concat();
            Track::new(vec![0.0, 1.0], values, Some(4), Interpolation::Linear, true).unwrap()
        };
        let is_near = |found: Vec<f64>, expected: [f64; 4]| {
            let dot: f64 = found.iter().zip(expected).map(|(a, b)| a * b).sum();
            (dot.abs() - 1.0).abs() < 1e-12
        };
        assert!(is_near(turn(about_y(0.2), about_y(1.4)).at(0.25), about_y(0.5)));
        // The same rotation, with the other sign.
        let negated = about_y(1.4).map(|c| -c);
        assert!(is_near(turn(about_y(0.2), negated).at(0.25), about_y(0.5)));
        assert!(is_near(turn(about_y(0.2), about_y(0.2)).at(0.5), about_y(0.2)));
    }

    #[test]
    fn numbers_that_do_not_fit() {
        let refused = |values: usize, width, interpolation| {
            Track::new(vec![0.0, 1.0], vec![0.0; values], width, interpolation, width == Some(4))
                .is_err()
        };
        assert!(refused(5, Some(3), Interpolation::Linear));
        assert!(refused(6, Some(3), Interpolation::CubicSpline));
        assert!(refused(3, None, Interpolation::Linear));
        assert!(refused(0, None, Interpolation::Step));
        assert!(refused(8, Some(4), Interpolation::Linear), "quaternions of no length");
        assert!(!refused(18, Some(3), Interpolation::CubicSpline));
    }
}
