//! How long a person waits: from input to the frame of the window that shows it was heard, and to
//! the picture that obeys it.

use super::wish::Frame;
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
    compiled: Vec<f64>,
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
    /// The same where a kernel had to be compiled first; the window says so meanwhile.
    input_to_picture_with_compilation: Option<Waits>,
}

impl Latency {
    pub(super) fn new() -> Self {
        Self {
            start: Instant::now(),
            input: None,
            wishes: VecDeque::new(),
            window: Vec::new(),
            picture: Vec::new(),
            compiled: Vec::new(),
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
        // The first wish comes with the scene, from nobody.
        if self.input.is_none() && serial == 1 {
            return;
        }
        self.wishes.push_back((serial, self.input.unwrap_or_else(Instant::now)));
    }

    /// A frame of the window is on the display, with this picture.
    pub(super) fn presented(&mut self, picture: Option<&Frame>) {
        let since = |start: &Instant| start.elapsed().as_secs_f64();
        self.first_window.get_or_insert_with(|| since(&self.start));
        self.window.extend(self.input.take().as_ref().map(since));
        let Some(frame) = picture else { return };
        self.first_picture.get_or_insert_with(|| since(&self.start));
        if frame.scale == 1 && frame.is_whole {
            self.first_whole.get_or_insert_with(|| since(&self.start));
        }
        while let Some((serial, asked)) = self.wishes.front() {
            if *serial > frame.wish {
                break;
            }
            match frame.has_compiled {
                true => self.compiled.push(since(asked)),
                false => self.picture.push(since(asked)),
            }
            self.wishes.pop_front();
        }
    }

    pub(super) fn report(&self) -> LatencyReport {
        LatencyReport {
            first_window_seconds: self.first_window,
            first_picture_seconds: self.first_picture,
            first_whole_picture_seconds: self.first_whole,
            input_to_window: waits(&self.window),
            input_to_picture: waits(&self.picture),
            input_to_picture_with_compilation: waits(&self.compiled),
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
    use std::sync::Arc;
    use steradian::scene::Camera;
    use steradian::settings::Crop;

    #[test]
    fn quantiles_are_values_that_occurred() {
        assert_eq!(waits(&[]), None);
        let hundred: Vec<f64> = (1..=100).map(|n| f64::from(n) * 1e-3).collect();
        let w = waits(&hundred).unwrap();
        assert_eq!((w.count, w.median_ms.round(), w.p95_ms.round()), (100, 50.0, 95.0));
        assert_eq!(waits(&[0.002]).unwrap().most_ms, 2.0);
    }

    fn frame(wish: u64, has_compiled: bool) -> Frame {
        Frame {
            size: [1, 1],
            rgba: Arc::new(vec![[0; 4]]),
            serial: wish,
            camera: Camera::framing(Default::default()),
            wish,
            scale: 1,
            window: Crop { x: 0, y: 0, width: 1, height: 1 },
            resolution: (1, 1),
            is_whole: true,
            has_compiled,
        }
    }

    #[test]
    fn a_wait_ends_with_the_picture_that_obeys() {
        let mut latency = Latency::new();
        latency.asked(1);
        latency.presented(Some(&frame(1, true)));
        latency.input();
        latency.asked(2);
        latency.input();
        latency.asked(3);
        latency.presented(Some(&frame(1, false)));
        assert!(latency.report().input_to_picture.is_none());
        latency.presented(Some(&frame(2, true)));
        assert_eq!(latency.report().input_to_picture_with_compilation.unwrap().count, 1);
        latency.presented(Some(&frame(7, false)));
        let report = latency.report();
        assert_eq!(report.input_to_picture.unwrap().count, 1);
        assert_eq!(report.input_to_window.unwrap().count, 1);
        assert!(report.first_whole_picture_seconds >= report.first_picture_seconds);
    }
}
