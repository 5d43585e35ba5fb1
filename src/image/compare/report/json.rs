//! A run as JSON.

use super::super::{Case, Comparison, LayerComparison, Location, Outcome, PictureFile, Run};
use serde_json::{Map, Value, json};

/// Raised when a member changes its meaning.
const SCHEMA: u32 = 1;

/// Everything that was found, with the metadata of the files. A number that is not finite is null.
pub fn json(run: &Run) -> Value {
    json!({
        "schema": SCHEMA,
        "steradian": env!("CARGO_PKG_VERSION"),
        "status": run.status().word(),
        "passes": run.passes(),
        "cases": run.cases.iter().map(case).collect::<Vec<_>>(),
    })
}

/// One pair.
pub(super) fn case(case: &Case) -> Value {
    let metadata = |path| match PictureFile::read(path) {
        Ok(file) => json!(file.metadata),
        Err(_) => Value::Null,
    };
    let mut value = json!({
        "name": case.name,
        "actual": case.actual.display().to_string(),
        "expected": case.expected.display().to_string(),
        "status": case.status().word(),
        "reasons": case.reasons(),
        "metadata": { "actual": metadata(&case.actual), "expected": metadata(&case.expected) },
    });
    if let Outcome::Compared(comparison) = &case.outcome {
        value["comparison"] = of_comparison(comparison);
    }
    value
}

fn of_comparison(comparison: &Comparison) -> Value {
    let failure = |failure: &super::super::Failure| json!({ "rule": failure.rule, "finding": failure.finding });
    json!({
        "rules": comparison.rules.iter().map(ToString::to_string).collect::<Vec<_>>(),
        "failures": comparison.failures.iter().map(failure).collect::<Vec<_>>(),
        "notes": comparison.notes,
        "layers": comparison.layers.iter().map(layer).collect::<Vec<_>>(),
        "verdict": comparison.verdict,
    })
}

fn layer(layer: &LayerComparison) -> Value {
    let metrics: Map<String, Value> =
        layer.metrics.iter().map(|(name, value)| (name.to_owned(), json!(value))).collect();
    let names: Vec<&str> = layer.metrics.iter().map(|(name, _)| name).collect();
    let place = |w: &Location| json!({ "x": w.x, "y": w.y, "channel": w.channel });
    let exposures = layer
        .metrics
        .exposures
        .map(|e| json!({ "start": e.start, "stop": e.stop, "count": e.count }));
    let non_finite = layer
        .non_finite
        .as_ref()
        .map(|n| json!({ "actual": n.actual, "expected": n.expected, "first": place(&n.first) }));
    json!({
        "name": layer.title(),
        "metrics": metrics,
        "order": names,
        "epsilon": layer.metrics.epsilon,
        "hdrflip_exposures": exposures,
        "non_finite": non_finite,
        "worst": layer.worst.as_ref().map(place),
    })
}
