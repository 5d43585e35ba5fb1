//! Normal, Student and chi-square distributions, under our names.

use statrs::distribution::{Binomial, ChiSquared, ContinuousCDF, DiscreteCDF, Normal, StudentsT};

/// Degrees of freedom from which a Student variable is mapped to a normal one; below,
/// the continued fraction of the incomplete beta function converges.
const LARGE_DEGREES: f64 = 1000.0;

/// Probability that a standard normal variable is at most `z`.
pub fn normal_cdf(z: f64) -> f64 {
    Normal::standard().cdf(z)
}

/// Probability that a standard normal variable exceeds `z`; exact in the far tail too.
pub fn normal_survival(z: f64) -> f64 {
    Normal::standard().sf(z)
}

/// The value that a standard normal variable is at most with probability `p` in [0, 1].
pub fn normal_quantile(p: f64) -> f64 {
    Normal::standard().inverse_cdf(p)
}

/// Probability that a Student variable of `degrees` > 0 degrees of freedom (not
/// necessarily a whole number; infinite is normal) is at most `t`.
pub fn student_t_cdf(t: f64, degrees: f64) -> f64 {
    student_t_survival(-t, degrees)
}

/// Probability that a Student variable of `degrees` degrees of freedom exceeds `t`.
pub fn student_t_survival(t: f64, degrees: f64) -> f64 {
    if degrees >= LARGE_DEGREES {
        return normal_survival(normal_equivalent(t, degrees));
    }
    student(degrees).sf(t)
}

/// The value that a Student variable of `degrees` degrees of freedom is at most with
/// probability `p` in (0, 1).
pub fn student_t_quantile(p: f64, degrees: f64) -> f64 {
    if degrees >= LARGE_DEGREES {
        // Newton from the normal value; the slope is that of the normal distribution
        // within O(1/degrees), so each step gains three digits.
        let z = normal_quantile(p);
        return (0..4).fold(z, |t, _| t + z - normal_equivalent(t, degrees));
    }
    student(degrees).inverse_cdf(p)
}

/// Probability that the sum of squares of `degrees` standard normal variables exceeds `x`.
pub fn chi_square_survival(x: f64, degrees: f64) -> f64 {
    let distribution = ChiSquared::new(degrees).expect("degrees of freedom above 0");
    distribution.sf(x)
}

/// Probability of `count` or more successes in `trials` of probability `p` in [0, 1].
pub fn binomial_survival(count: usize, trials: usize, p: f64) -> f64 {
    match count.checked_sub(1) {
        None => 1.0,
        Some(less) => {
            let distribution = Binomial::new(p, trials as u64).expect("a probability");
            distribution.sf(less as u64)
        }
    }
}

fn student(degrees: f64) -> StudentsT {
    StudentsT::new(0.0, 1.0, degrees).expect("degrees of freedom above 0")
}

/// The normal value with the tail of the Student value `t` (Hill 1970, "Algorithm 395:
/// Student's t-distribution", the expansion in 1/a with b = 48 a²).
fn normal_equivalent(t: f64, degrees: f64) -> f64 {
    if degrees.is_infinite() {
        return t;
    }
    let a = degrees - 0.5;
    let b = 48.0 * a * a;
    let w = a * (t * t / degrees).ln_1p();
    let inner = ((-0.4 * w - 3.3) * w - 24.0) * w - 85.5;
    let correction = inner / (0.8 * w * w + 100.0 + b) + w + 3.0;
    (correction / b + 1.0) * w.sqrt() * t.signum()
}
