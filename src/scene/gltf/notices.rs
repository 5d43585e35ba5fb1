//! Collects what of the file is honoured, approximated or ignored: one line for
//! each feature, however often it occurs.

use crate::error::printable;
use crate::scene::{Notice, Treatment};
use std::collections::BTreeMap;

/// Most lines of one treatment: a file can have any number of unknown names in it.
const MOST_LINES: usize = 100;

/// The notices of one load, by treatment and message.
#[derive(Default)]
pub(super) struct Notices {
    occurrences: BTreeMap<(Treatment, String), Occurrences>,
    /// How many lines each treatment has, and how many notices found no room.
    lines: BTreeMap<Treatment, (usize, usize)>,
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
        if count == 0 {
            return;
        }
        let key = (treatment, message.to_owned());
        if let Some(occurrences) = self.occurrences.get_mut(&key) {
            occurrences.count += count;
            return;
        }
        let (lines, left_over) = self.lines.entry(treatment).or_default();
        if *lines == MOST_LINES {
            *left_over += 1;
            return;
        }
        *lines += 1;
        self.occurrences.insert(key, Occurrences { count, first: place.into() });
    }

    fn note(&mut self, treatment: Treatment, message: String, place: &str) {
        self.note_many(treatment, &message, 1, place);
    }

    /// The lines, honoured ones first.
    pub(super) fn into_lines(self) -> Vec<Notice> {
        let mut lines: Vec<_> = self
            .occurrences
            .into_iter()
            .map(|((treatment, message), Occurrences { count, first })| {
                let message = printable(&match count {
                    1 => format!("{message} ({first})"),
                    _ => format!("{message} ({count} times, first in {first})"),
                });
                Notice { treatment, message }
            })
            .collect();
        let left_over = self.lines.into_iter().filter(|(_, (_, left_over))| *left_over > 0);
        lines.extend(left_over.map(|(treatment, (_, count))| Notice {
            treatment,
            message: format!("and {count} notices more"),
        }));
        lines
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

    #[test]
    fn there_are_only_so_many_lines() {
        let mut notices = Notices::default();
        for i in 0..MOST_LINES + 7 {
            notices.ignored(format!("extension {i}"), "the file");
        }
        notices.approximated("other", "the\nfile");
        let lines = notices.into_lines();
        assert_eq!(lines.len(), MOST_LINES + 2);
        assert_eq!(lines[0].message, "other (the\\nfile)");
        assert_eq!(lines[MOST_LINES + 1].message, "and 7 notices more");
        assert_eq!(lines[MOST_LINES + 1].treatment, Treatment::Ignored);
    }
}
