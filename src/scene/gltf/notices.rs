//! Collects what of the file is honoured, approximated or ignored: one line for
//! each feature, however often it occurs.

use crate::scene::{Notice, Treatment};
use std::collections::BTreeMap;

/// The notices of one load, by treatment and message.
#[derive(Default)]
pub(super) struct Notices {
    occurrences: BTreeMap<(Treatment, String), Occurrences>,
}

struct Occurrences {
    count: usize,
    first: String,
}

impl Notices {
    /// Notes that a feature is rendered as specified.
    pub(super) fn honoured(&mut self, feature: &str, place: &str) {
        self.note(Treatment::Honoured, feature.into(), place);
    }

    /// Notes that a feature is rendered with a stated difference.
    pub(super) fn approximated(&mut self, message: impl Into<String>, place: &str) {
        self.note(Treatment::Approximated, message.into(), place);
    }

    /// Notes that a feature has no effect.
    pub(super) fn ignored(&mut self, message: impl Into<String>, place: &str) {
        self.note(Treatment::Ignored, message.into(), place);
    }

    /// Notes `count` occurrences in one place, of which there may be none.
    pub(super) fn note_many(
        &mut self,
        treatment: Treatment,
        message: &str,
        count: usize,
        place: &str,
    ) {
        if count > 0 {
            self.occurrences
                .entry((treatment, message.into()))
                .or_insert_with(|| Occurrences { count: 0, first: place.into() })
                .count += count;
        }
    }

    fn note(&mut self, treatment: Treatment, message: String, place: &str) {
        self.note_many(treatment, &message, 1, place);
    }

    /// The lines, honoured ones first.
    pub(super) fn into_lines(self) -> Vec<Notice> {
        self.occurrences
            .into_iter()
            .map(|((treatment, message), Occurrences { count, first })| {
                let message = match count {
                    1 => format!("{message} ({first})"),
                    _ => format!("{message} ({count} times, first in {first})"),
                };
                Notice { treatment, message }
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_line_for_each_feature_with_count_and_first_place() {
        let mut notices = Notices::default();
        notices.ignored("occlusion", "material 1");
        notices.ignored("occlusion", "material 4");
        notices.honoured("KHR_materials_ior", "material 2");
        let lines = notices.into_lines();
        assert_eq!(lines.len(), 2);
        assert_eq!(lines[0].treatment, Treatment::Honoured);
        assert_eq!(lines[0].message, "KHR_materials_ior (material 2)");
        assert_eq!(lines[1].message, "occlusion (2 times, first in material 1)");
    }
}
