//! What the window and the engine share, each in a thread of its own. Neither waits for the other's
//! work: the window leaves its newest wish, the engine its newest report.

use super::wish::{Report, Request, Wish};
use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard};
use std::time::{Duration, Instant};

/// One end of it; both are alike.
#[derive(Clone)]
pub(super) struct Link {
    shared: Arc<Shared>,
}

struct Shared {
    state: Mutex<State>,
    /// Wakes the engine.
    wake: Condvar,
    /// Wakes the window.
    notify: Box<dyn Fn() + Send + Sync>,
}

#[derive(Default)]
struct State {
    wish: Option<(u64, Arc<Wish>)>,
    serial: u64,
    requests: VecDeque<Request>,
    has_news: bool,
    is_over: bool,
    report: Report,
}

/// What the engine finds.
pub(super) struct News {
    /// The newest wish and its number.
    pub(super) wish: Option<(u64, Arc<Wish>)>,
    /// In the order of asking.
    pub(super) requests: Vec<Request>,
    /// The window is gone.
    pub(super) is_over: bool,
}

impl Link {
    /// `notify` is called, from the engine's thread, after each new report.
    pub(super) fn new(notify: impl Fn() + Send + Sync + 'static) -> Self {
        let (state, wake) = (Mutex::default(), Condvar::new());
        Self { shared: Arc::new(Shared { state, wake, notify: Box::new(notify) }) }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        // A thread that panicked has said so; its data is whole between any two statements.
        self.shared.state.lock().unwrap_or_else(|e| e.into_inner())
    }

    fn wake(&self, change: impl FnOnce(&mut State)) {
        let mut state = self.state();
        change(&mut state);
        state.has_news = true;
        self.shared.wake.notify_one();
    }

    /// Leaves a wish in place of the last one. Gives its number, from 1.
    pub(super) fn send(&self, wish: Wish) -> u64 {
        let mut serial = 0;
        self.wake(|state| {
            state.serial += 1;
            serial = state.serial;
            state.wish = Some((serial, Arc::new(wish)));
        });
        serial
    }

    /// Asks for something to be done.
    pub(super) fn ask(&self, request: Request) {
        self.wake(|state| state.requests.push_back(request));
    }

    /// Asks the engine to end.
    pub(super) fn end(&self) {
        self.wake(|state| state.is_over = true);
    }

    /// The newest report.
    pub(super) fn report(&self) -> Report {
        self.state().report.clone()
    }

    /// Changes the report and wakes the window.
    pub(super) fn tell(&self, change: impl FnOnce(&mut Report)) {
        change(&mut self.state().report);
        (self.shared.notify)();
    }

    /// Says what a person waits for, or that it is over.
    pub(super) fn busy(&self, what: Option<&'static str>) {
        self.tell(|report| report.busy = what.map(|what| (what, Instant::now())));
    }

    /// What is new; waits for it until `patience` is over.
    pub(super) fn news(&self, patience: Duration) -> News {
        let mut state = self.state();
        if !state.has_news && !patience.is_zero() {
            let waited = self.shared.wake.wait_timeout_while(state, patience, |s| !s.has_news);
            state = waited.unwrap_or_else(|e| e.into_inner()).0;
        }
        state.has_news = false;
        let requests = state.requests.drain(..).collect();
        News { wish: state.wish.clone(), requests, is_over: state.is_over }
    }
}
