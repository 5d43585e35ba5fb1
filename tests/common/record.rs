//! Figures of the catalogue of hard cases. Each is judged here and, where the variable
//! `STERADIAN_FIGURES` names a file, added to it as a line of JSON for docs/numerics.md.

use serde_json::json;
use std::fs::OpenOptions;
use std::io::Write;

/// Asserts that the figure is at most `limit`. `what` says what was measured: method, size, count
/// and unit.
#[track_caller]
pub(crate) fn assert_at_most(case: &str, what: &str, figure: f64, limit: f64) {
    record(case, what, "product", figure, Some(("at most", limit)));
    assert!(figure <= limit, "{case} {what}: {figure:e} is more than {limit:e}");
}

/// Asserts that the figure is at least `limit`.
#[track_caller]
pub(crate) fn assert_at_least(case: &str, what: &str, figure: f64, limit: f64) {
    record(case, what, "product", figure, Some(("at least", limit)));
    assert!(figure >= limit, "{case} {what}: {figure:e} is less than {limit:e}");
}

/// A figure that is known to miss its bar of at least `bar`, and why; asserts that it still does,
/// so that a renderer that has become better is held to it.
#[track_caller]
pub(crate) fn report_below(case: &str, what: &str, figure: f64, bar: f64, why: &str) {
    record(case, &format!("{what} ({why})"), "product", figure, Some(("at least", bar)));
    assert!(figure < bar, "{case} {what}: {figure:e} now keeps {bar:e}: hold the renderer to it");
}

/// As [`report_below`], for a bar of at most `bar`.
#[track_caller]
pub(crate) fn report_above(case: &str, what: &str, figure: f64, bar: f64, why: &str) {
    record(case, &format!("{what} ({why})"), "product", figure, Some(("at most", bar)));
    assert!(figure > bar, "{case} {what}: {figure:e} now keeps {bar:e}: hold the renderer to it");
}

/// Asserts that the usual technique, kept in the test for comparison, fails by `least` or more:
/// the case is hard.
#[track_caller]
pub(crate) fn assert_naive_fails(case: &str, what: &str, figure: f64, least: f64) {
    record(case, what, "naive", figure, Some(("at least", least)));
    assert!(figure >= least, "{case} {what}: the naive form does no worse than {figure:e}");
}

/// A figure that is told and not judged.
pub(crate) fn report(case: &str, what: &str, figure: f64) {
    record(case, what, "report", figure, None);
}

fn record(case: &str, what: &str, kind: &str, figure: f64, limit: Option<(&str, f64)>) {
    println!("{case} {what}: {figure:e} ({kind}, limit {limit:?})");
    let Some(path) = std::env::var_os("STERADIAN_FIGURES") else { return };
    // JSON has no infinities.
    let number = |x: f64| if x.is_finite() { json!(x) } else { json!(x.to_string()) };
    let line = json!({
        "case": case,
        "what": what,
        "kind": kind,
        "figure": number(figure),
        "bound": limit.map(|(bound, _)| bound),
        "limit": limit.map(|(_, value)| number(value)),
    });
    let mut file = OpenOptions::new().create(true).append(true).open(path).unwrap();
    // One write: tests run side by side.
    file.write_all(format!("{line}\n").as_bytes()).unwrap();
}
