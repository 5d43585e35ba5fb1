//! Rules: how they are spelt, and what they decide.

use crate::{linear, picture, ramp};
use steradian::image::Picture;
use steradian::image::compare::{Comparison, ComparisonOptions, Rule};

fn rule(text: &str) -> Rule {
    text.parse().unwrap_or_else(|error| panic!("{text}: {error}"))
}

fn options(rules: &[&str]) -> ComparisonOptions {
    let rules = rules.iter().map(|text| rule(text)).collect();
    ComparisonOptions { rules, ..ComparisonOptions::default() }
}

#[test]
fn rules_are_spelt_as_they_are_printed() {
    for text in
        ["exact", "verdict", "flip.mean<0.01", "depth:exact", "albedo:mse<0.000001", "colour:mse<1"]
    {
        assert_eq!(rule(text).to_string(), text);
    }
    assert_eq!(rule(" mse < 1e-3 "), rule("mse<0.001"));
    assert_eq!(rule("visible<2%"), rule("visible<0.02"));
    for bad in
        ["", "mse", "mse<", "mse<x", "mse<0", "mse<-1", "mse<nan", "mse>1", "psnr<1", "a:verdict"]
    {
        assert!(bad.parse::<Rule>().is_err(), "{bad:?}");
    }
}

/// A limit holds just below it, and not at it.
#[test]
fn limits_decide() {
    let expected = picture(8, 8, |_, _| [1.0; 3]);
    let actual = picture(8, 8, |_, _| [1.25; 3]);
    let passes = |text: &str| {
        Comparison::of(&linear(&actual), &linear(&expected), &options(&[text])).unwrap().passes()
    };
    assert!(passes("mae<0.2501") && !passes("mae<0.25") && !passes("mae<0.1"));
    assert!(!passes("exact") && !passes("colour:exact"));
    assert!(passes("error.max<1") && !passes("different<1") && passes("different<1.01"));
}

/// Without rules a picture without noise must be exact.
#[test]
fn every_bit_counts_by_default() {
    let expected = ramp(8, 8);
    let mut actual = expected.clone();
    let compare = |actual: &Picture| {
        Comparison::of(&linear(actual), &linear(&expected), &ComparisonOptions::default()).unwrap()
    };
    assert!(compare(&actual).passes());
    let value = &mut actual.rgb[10][2];
    *value = f32::from_bits(value.to_bits() + 1);
    let found = compare(&actual);
    assert_eq!(found.rules, [rule("exact")]);
    assert_eq!(found.failures.len(), 1);
    assert!(found.failures[0].finding.contains("B at (2, 1)"), "{:?}", found.failures);
}

/// A rule that nothing can be asked of is an error, never a pass.
#[test]
fn rules_about_nothing_are_refused() {
    let file = linear(&ramp(8, 8));
    for text in ["verdict", "visible<0.1", "depth:exact", "albedo:mse<1"] {
        assert!(Comparison::of(&file, &file, &options(&[text])).is_err(), "{text}");
    }
}
