//! Rules that a comparison must keep: `flip.mean<0.01`, `albedo:mse<1e-6`, `verdict`, `exact`.

use super::{LayerComparison, NoiseVerdict};
use crate::{Error, Result};
use std::fmt;
use std::str::FromStr;

/// What must hold of a comparison.
#[derive(Debug, Clone, PartialEq)]
pub enum Rule {
    /// Every value has the same bits, but for the sign of 0. Of one layer, or of all.
    Exact {
        /// Empty for the colour.
        layer: Option<String>,
    },
    /// No test finds more than noise ([`NoiseVerdict::agrees`]).
    Verdict,
    /// A metric of one layer, or of all that have it, stays below a limit.
    Limit {
        /// Empty for the colour.
        layer: Option<String>,
        /// As in [`super::Metrics`], or `visible`: the bias of the mean that the verdict could not
        /// see.
        metric: String,
        /// The metric must be less.
        below: f64,
    },
}

/// A rule that does not hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Failure {
    /// The rule as it is spelt; `finite` for the one that needs no asking.
    pub rule: String,
    /// What was found, in one line.
    pub finding: String,
}

/// The metrics that a rule may name.
const METRICS: [&str; 18] = [
    "mse",
    "rmse",
    "mae",
    "relmse",
    "relmse.trimmed",
    "smape",
    "error.max",
    "error.p50",
    "error.p95",
    "error.p99",
    "error.p99.9",
    "different",
    "flip.mean",
    "flip.p95",
    "flip.max",
    "hdrflip.mean",
    "hdrflip.p95",
    "hdrflip.max",
];

/// The metric of the verdict.
const VISIBLE: &str = "visible";

impl FromStr for Rule {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let text = text.trim();
        let (layer, rule) = match text.rsplit_once(':') {
            Some((layer, rule)) => {
                let layer = layer.trim();
                (Some(if layer == "colour" { String::new() } else { layer.to_owned() }), rule)
            }
            None => (None, text),
        };
        match (rule.trim(), rule.split_once('<')) {
            ("exact", _) => Ok(Self::Exact { layer }),
            ("verdict", _) if layer.is_none() => Ok(Self::Verdict),
            (_, Some((metric, limit))) => {
                let metric = metric.trim().to_owned();
                if !METRICS.contains(&metric.as_str()) && metric != VISIBLE {
                    let all = METRICS.join(", ");
                    return Err(format!("no metric {metric}; there are {all}, {VISIBLE}"));
                }
                let (number, scale) = match limit.trim().strip_suffix('%') {
                    Some(number) => (number, 100.0),
                    None => (limit.trim(), 1.0),
                };
                match number.parse::<f64>() {
                    Ok(limit) if limit > 0.0 && limit.is_finite() => {
                        Ok(Self::Limit { layer, metric, below: limit / scale })
                    }
                    _ => Err(format!("the limit of {metric} must be a number above 0")),
                }
            }
            _ => Err("expected METRIC<LIMIT, LAYER:METRIC<LIMIT, exact or verdict".into()),
        }
    }
}

impl fmt::Display for Rule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let prefix = |layer: &Option<String>| match layer.as_deref() {
            None => String::new(),
            Some("") => "colour:".into(),
            Some(layer) => format!("{layer}:"),
        };
        match self {
            Self::Verdict => f.write_str("verdict"),
            Self::Exact { layer } => write!(f, "{}exact", prefix(layer)),
            Self::Limit { layer, metric, below } => {
                write!(f, "{}{metric}<{below}", prefix(layer))
            }
        }
    }
}

impl Rule {
    /// Where it does not hold. `knows_noise`: the files tell of their noise, though perhaps there
    /// is no verdict because a value is not finite.
    pub(super) fn failures(
        &self,
        layers: &[LayerComparison],
        verdict: Option<&NoiseVerdict>,
        knows_noise: bool,
    ) -> Result<Vec<Failure>> {
        let failure = |finding: String| Failure { rule: self.to_string(), finding };
        let no_noise = || {
            Error::Settings(format!(
                "rule {self} needs the noise of both pictures, which EXR files of more than one block \
                 have; choose another rule"
            ))
        };
        match (self, verdict) {
            (Self::Verdict, Some(verdict)) if verdict.agrees => Ok(vec![]),
            (Self::Verdict, Some(verdict)) => Ok(vec![failure(describe(verdict))]),
            (Self::Limit { metric, below, .. }, Some(verdict)) if metric == VISIBLE => {
                let visible = verdict.visible_bias();
                let text =
                    format!("a bias of {:.2} % of the mean could stay unseen", 100.0 * visible);
                Ok(if visible < *below { vec![] } else { vec![failure(text)] })
            }
            (Self::Limit { metric, .. }, None) if metric == VISIBLE => {
                if knows_noise {
                    Ok(vec![])
                } else {
                    Err(no_noise())
                }
            }
            // A value that is not finite is a failure already.
            (Self::Verdict, None) => {
                if knows_noise {
                    Ok(vec![])
                } else {
                    Err(no_noise())
                }
            }
            (Self::Exact { layer }, _) => {
                let failing = self.select(layer.as_deref(), "different", layers)?;
                Ok(failing
                    .filter(|(_, share)| *share != 0.0)
                    .map(|(layer, share)| {
                        let worst = layer.worst.as_ref().map_or(String::new(), |w| {
                            format!(", most in {} at ({}, {})", w.channel, w.x, w.y)
                        });
                        failure(format!(
                            "{}: {:.3} % of the pixels differ{worst}",
                            layer.title(),
                            100.0 * share
                        ))
                    })
                    .collect())
            }
            (Self::Limit { layer, metric, below }, _) => {
                let failing = self.select(layer.as_deref(), metric, layers)?;
                // Not a number is not below.
                let is_over = |value: f64| value.is_nan() || value >= *below;
                Ok(failing
                    .filter(|(_, value)| is_over(*value))
                    .map(|(layer, value)| {
                        failure(format!("{}: {metric} is {value:.4e}", layer.title()))
                    })
                    .collect())
            }
        }
    }

    /// The layers that the rule is about, and their value of the metric.
    fn select<'a>(
        &self,
        layer: Option<&'a str>,
        metric: &'a str,
        layers: &'a [LayerComparison],
    ) -> Result<impl Iterator<Item = (&'a LayerComparison, f64)> + use<'a>> {
        let is_meant = move |l: &&LayerComparison| layer.is_none_or(|name| name == l.name);
        let value = move |l: &'a LayerComparison| Some((l, l.metrics.get(metric)?));
        let found = layers.iter().filter(is_meant).filter_map(value);
        if found.clone().next().is_none() {
            return Err(Error::Settings(format!(
                "no layer that is compared has what rule {self} needs"
            )));
        }
        Ok(found)
    }
}

impl Failure {
    pub(super) fn non_finite(layer: &LayerComparison) -> Self {
        let finding = match &layer.non_finite {
            Some(n) => format!(
                "{}: {} values of actual and {} of expected are not finite, the first in {} at ({}, {})",
                layer.title(),
                n.actual,
                n.expected,
                n.first.channel,
                n.first.x,
                n.first.y
            ),
            None => String::new(),
        };
        Self { rule: "finite".into(), finding }
    }
}

/// What the verdict found, in one line.
fn describe(verdict: &NoiseVerdict) -> String {
    let planes = verdict.planes.iter().filter(|plane| !plane.alarms.is_empty());
    let planes: Vec<String> = planes
        .map(|plane| {
            let (columns, side) = (verdict.tile_columns as usize, verdict.tile as usize);
            let (x, y) = (plane.worst_tile % columns * side, plane.worst_tile / columns * side);
            format!(
                "{} by {} (mean {:+.2} %, z {:+.1}; worst tile at ({x}, {y}), z {:+.1})",
                plane.name,
                plane.alarms.join(", "),
                100.0 * plane.difference / plane.reference_mean,
                plane.z,
                plane.tiles[plane.worst_tile],
            )
        })
        .collect();
    let p = match verdict.p_value {
        0.0 => "below 1e-300".into(),
        p => format!("{p:.1e}"),
    };
    format!("more than noise, p {p}: {}", planes.join("; "))
}
