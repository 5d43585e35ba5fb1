//! Frames of an animation: which, and at what times.

use super::values::Parsed;
use clap::Args;
use std::collections::HashSet;

/// Frames of one call at most: more than an hour at 24 a second.
const MOST_FRAMES: usize = 100_000;
/// Largest number of a frame.
const LARGEST: u32 = 999_999_999;

/// Which frames of an animation.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Frames")]
pub(crate) struct FrameFlags {
    /// Frames of the animation, such as 1-10,20,30-50:2, each once; a file for each
    #[arg(long, value_name = "LIST", value_parser = frame_numbers, conflicts_with_all = ["frame_time", "pixel"])]
    pub(crate) frames: Option<FrameNumbers>,

    /// Frames in a second, such as 24 or 30000/1001: frame N is at N / F seconds
    #[arg(long, value_name = "F", value_parser = rate, default_value = "24", requires = "frames")]
    pub(crate) fps: f64,

    /// Add the frame's number to the seed, so that noise moves
    #[arg(long, requires = "frames")]
    pub(crate) animate_seed: bool,

    /// Leave frames out whose files are there, whole, and of this scene and these settings
    #[arg(long, conflicts_with = "pixel")]
    pub(crate) skip_existing: bool,
}

/// Numbers of frames, each once, in the order given.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct FrameNumbers(pub(crate) Vec<u32>);

/// One picture of a call.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Frame {
    /// `None` where no frames were asked for.
    pub(crate) number: Option<u32>,
    /// At which animations are sampled, seconds; the rest pose without.
    pub(crate) time: Option<f64>,
}

impl FrameFlags {
    /// What to render, in order; without `--frames` the one picture at `frame_time`.
    pub(crate) fn list(&self, frame_time: Option<f64>) -> Vec<Frame> {
        match &self.frames {
            None => vec![Frame { number: None, time: frame_time }],
            Some(FrameNumbers(numbers)) => {
                let at = |n: u32| Some(f64::from(n) / self.fps);
                numbers.iter().map(|&n| Frame { number: Some(n), time: at(n) }).collect()
            }
        }
    }
}

/// `1-10,20,30-50:2`: numbers, ranges with both ends, ranges with a step.
fn frame_numbers(text: &str) -> Parsed<FrameNumbers> {
    let mut numbers = Vec::new();
    let mut known = HashSet::new();
    for part in text.split(',') {
        let (first, last, step) = range(part)?;
        for number in (first..=last).step_by(step as usize) {
            if known.insert(number) {
                numbers.push(number);
            }
            if numbers.len() > MOST_FRAMES {
                return Err(format!("one call can have {MOST_FRAMES} frames; give each a part"));
            }
        }
    }
    Ok(FrameNumbers(numbers))
}

/// First and last number, and the step.
fn range(part: &str) -> Parsed<(u32, u32, u32)> {
    let part = part.trim();
    let form = || format!("{part:?}: expected a number or a range, as in 1-10,20,30-50:2");
    let (ends, step) = match part.split_once(':') {
        Some((ends, step)) => (ends, number(step, form)?),
        None => (part, 1),
    };
    let (first, last) = match ends.split_once('-') {
        Some((first, last)) => (number(first, form)?, number(last, form)?),
        None if ends.len() < part.len() => return Err(form()),
        None => (number(ends, form)?, number(ends, form)?),
    };
    match (first, last, step) {
        (_, _, 0) => Err(format!("{part:?}: a step is at least 1")),
        (first, last, _) if last < first => Err(format!("{part:?} ends before it begins")),
        range => Ok(range),
    }
}

fn number(text: &str, form: impl Fn() -> String) -> Parsed<u32> {
    let is_number = !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    match text.parse::<u32>() {
        Ok(number) if is_number && number <= LARGEST => Ok(number),
        _ if is_number => Err(format!("{text}: the largest number of a frame is {LARGEST}")),
        _ => Err(form()),
    }
}

/// Frames in a second: a number or a quotient of two.
fn rate(text: &str) -> Parsed<f64> {
    let parts: Option<Vec<f64>> = text.split('/').map(|part| part.trim().parse().ok()).collect();
    let rate = match parts.as_deref() {
        Some(&[rate]) => rate,
        Some(&[frames, seconds]) => frames / seconds,
        _ => return Err("expected a number or a quotient, such as 24 or 30000/1001".into()),
    };
    // Times of all frames stay finite, and different.
    match (1e-6..=1e9).contains(&rate) {
        true => Ok(rate),
        false => Err("frames in a second must be from 1e-6 to 1e9".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(text: &str) -> Parsed<Vec<u32>> {
        frame_numbers(text).map(|list| list.0)
    }

    #[test]
    fn ranges_have_both_ends_and_steps_begin_at_the_first() {
        assert_eq!(numbers("0"), Ok(vec![0]));
        assert_eq!(numbers("1-3,20,30-35:2"), Ok(vec![1, 2, 3, 20, 30, 32, 34]));
        assert_eq!(numbers("7-7, 5"), Ok(vec![7, 5]));
        assert_eq!(numbers("007"), Ok(vec![7]));
        assert_eq!(numbers("1-4,3-5,4"), Ok(vec![1, 2, 3, 4, 5]), "each once");
        assert_eq!(numbers("1-1000000:1000000"), Ok(vec![1]));
        assert_eq!(numbers("1-100000").map(|n| n.len()), Ok(MOST_FRAMES));
    }

    #[test]
    fn what_is_no_list_is_told_in_words() {
        let cases = [
            ("", "expected a number"),
            ("1,,2", "expected a number"),
            ("1-", "expected a number"),
            ("-1", "expected a number"),
            ("1-2-3", "expected a number"),
            ("+1", "expected a number"),
            ("1.5", "expected a number"),
            ("5:2", "expected a number"),
            ("1-5:", "expected a number"),
            ("1-5:0", "a step is at least 1"),
            ("9-3", "ends before it begins"),
            ("1-999999999999", "the largest number"),
            ("99999999999999999999999", "the largest number"),
            ("1-999999999", "100000 frames"),
            ("0-99999,200000", "100000 frames"),
        ];
        for (text, message) in cases {
            let error = numbers(text).unwrap_err();
            assert!(error.contains(message), "{text}: {error}");
        }
    }

    #[test]
    fn the_time_of_a_frame_is_its_number_by_the_rate() {
        let flags = |list: &str, fps: &str| FrameFlags {
            frames: Some(frame_numbers(list).unwrap()),
            fps: rate(fps).unwrap(),
            animate_seed: false,
            skip_existing: false,
        };
        let frames = flags("0,12", "24").list(None);
        assert_eq!(frames[0], Frame { number: Some(0), time: Some(0.0) });
        assert_eq!(frames[1], Frame { number: Some(12), time: Some(0.5) });
        let time = flags("30", "30000/1001").list(None)[0].time.unwrap();
        assert!((time - 1.001).abs() < 4.0 * f64::EPSILON, "{time}");
        let still = FrameFlags { frames: None, ..flags("1", "24") };
        assert_eq!(still.list(Some(0.25)), [Frame { number: None, time: Some(0.25) }]);
        for bad in ["", "0", "-1", "nan", "inf", "1/0", "1/2/3", "1e-7"] {
            assert!(rate(bad).is_err(), "{bad}");
        }
    }
}
