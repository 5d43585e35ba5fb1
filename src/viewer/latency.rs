//! How long a person waits: from input to the frame of the window that shows it was heard, and to
//! the picture that obeys it.

use serde::Serialize;
use std::collections::VecDeque;
use std::time::Instant;

/// Times since the program began, and waits of one session.
pub(super) struct Latency {
    start: Instant,
    /// When the newest input came that no frame has answered.
    input: Option<Instant>,
    /// Wishes that no picture has obeyed, with the time of their input.
    wishes: VecDeque<(u64, Instant)>,
    window: Vec<f64>,
    picture: Vec<f64>,
    first_window: Option<f64>,
    first_picture: Option<f64>,
    first_whole: Option<f64>,
}

/// Milliseconds.
#[derive(Debug, Serialize, PartialEq)]
pub(super) struct Waits {
    count: usize,
    median_ms: f64,
    p95_ms: f64,
    most_ms: f64,
}

/// What `--stats` says.
#[derive(Debug, Serialize)]
pub(super) struct LatencyReport {
    /// From the start of the program to the first frame of the window, seconds.
    first_window_seconds: Option<f64>,
    /// To the first picture in it.
    first_picture_seconds: Option<f64>,
    /// To the first picture of full resolution with a sample in every pixel.
    first_whole_picture_seconds: Option<f64>,
    /// From input to the next frame of the window.
    input_to_window: Option<Waits>,
    /// From input that changes the picture to the first picture that is changed.
    input_to_picture: Option<Waits>,
}

impl Latency {
    pub(super) fn new() -> Self {
        Self {
            start: Instant::now(),
            input: None,
            wishes: VecDeque::new(),
            window: Vec::new(),
            picture: Vec::new(),
            first_window: None,
            first_picture: None,
            first_whole: None,
        }
    }

    /// Whether no frame was on the display yet.
    pub(super) fn is_new(&self) -> bool {
        self.first_window.is_none()
    }

    /// Something was pressed, moved or turned.
    pub(super) fn input(&mut self) {
        self.input.get_or_insert_with(Instant::now);
    }

    /// A wish was sent.
    pub(super) fn asked(&mut self, serial: u64) {
        self.wishes.push_back((serial, self.input.unwrap_or_else(Instant::now)));
    }

    /// A frame is on the display; `picture`: the wish that the picture in it obeys, and whether it
    /// has every pixel.
    pub(super) fn presented(&mut self, picture: Option<(u64, bool)>) {
        let since = |start: &Instant| start.elapsed().as_secs_f64();
        self.first_window.get_or_insert_with(|| since(&self.start));
        self.window.extend(self.input.take().as_ref().map(since));
        let Some((obeyed, is_whole)) = picture else { return };
        self.first_picture.get_or_insert_with(|| since(&self.start));
        if is_whole {
            self.first_whole.get_or_insert_with(|| since(&self.start));
        }
        while let Some((serial, asked)) = self.wishes.front() {
            if *serial > obeyed {
                break;
            }
            self.picture.push(since(asked));
            self.wishes.pop_front();
        }
    }

    pub(super) fn report(&self) -> LatencyReport {
        // The first wish comes with the scene, from nobody.
        let asked = self.picture.get(1..).unwrap_or_default();
        LatencyReport {
            first_window_seconds: self.first_window,
            first_picture_seconds: self.first_picture,
            first_whole_picture_seconds: self.first_whole,
            input_to_window: waits(&self.window),
            input_to_picture: waits(asked),
        }
    }
}

fn waits(seconds: &[f64]) -> Option<Waits> {
    let mut sorted = seconds.to_vec();
    sorted.sort_by(f64::total_cmp);
    // The smallest value that the share of all does not exceed.
    let quantile = |share: f64| {
        let rank = (share * sorted.len() as f64).ceil() as usize;
        sorted.get(rank.saturating_sub(1)).map(|s| s * 1e3)
    };
    Some(Waits {
        count: sorted.len(),
        median_ms: quantile(0.5)?,
        p95_ms: quantile(0.95)?,
        most_ms: quantile(1.0)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_values_that_occurred() {
        assert_eq!(waits(&[]), None);
        let hundred: Vec<f64> = (1..=100).map(|n| f64::from(n) * 1e-3).collect();
        let w = waits(&hundred).unwrap();
        assert_eq!((w.count, w.median_ms.round(), w.p95_ms.round()), (100, 50.0, 95.0));
        assert_eq!(waits(&[0.002]).unwrap().most_ms, 2.0);
    }

    #[test]
    fn a_wait_ends_with_the_picture_that_obeys() {
        let mut latency = Latency::new();
        latency.asked(1);
        latency.presented(Some((1, false)));
        latency.input();
        latency.asked(2);
        latency.input();
        latency.asked(3);
        latency.presented(Some((1, true)));
        assert!(latency.report().input_to_picture.is_none());
        latency.presented(Some((2, true)));
        assert_eq!(latency.report().input_to_picture.unwrap().count, 1);
        latency.presented(Some((7, true)));
        let report = latency.report();
        assert_eq!(report.input_to_picture.unwrap().count, 2);
        assert_eq!(report.input_to_window.unwrap().count, 1);
        assert!(report.first_whole_picture_seconds >= report.first_picture_seconds);
    }
}
