//! SIGINT and SIGTERM: the first one asks for an end with the partial picture
//! written, the second one ends the program at once. SIGUSR1 asks for the picture so far.

use signal_hook::consts::{SIGINT, SIGTERM, SIGUSR1};
use signal_hook::flag;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use steradian::{Error, Result};

/// SIGTERM ends the program at once, with an exit code of its own.
pub(crate) struct EarlyStop(Arc<AtomicBool>);

impl EarlyStop {
    /// Begins.
    pub(crate) fn listen(exit_code: u8) -> Result<Self> {
        let is_on = Arc::new(AtomicBool::new(true));
        flag::register_conditional_shutdown(SIGTERM, exit_code.into(), is_on.clone())
            .map_err(|e| Error::io("signal handlers", e))?;
        Ok(Self(is_on))
    }

    /// From now on it does not.
    pub(crate) fn end(&self) {
        self.0.store(false, Ordering::SeqCst);
    }
}

/// Remembers a request to stop.
pub(crate) struct StopRequest {
    /// The number of the signal; 0 before any.
    signal: Arc<AtomicUsize>,
    snapshot: Arc<AtomicBool>,
}

impl StopRequest {
    /// Begins to listen. Before this, a signal ends the program at once.
    pub(crate) fn listen() -> Result<Self> {
        let is_requested = Arc::new(AtomicBool::new(false));
        let signal = Arc::new(AtomicUsize::new(0));
        for number in [SIGINT, SIGTERM] {
            // Handlers run in the order of registration: the first signal finds
            // nothing requested yet.
            flag::register_conditional_default(number, is_requested.clone())
                .and_then(|_| flag::register_usize(number, signal.clone(), number as usize))
                .and_then(|_| flag::register(number, is_requested.clone()))
                .map_err(|e| Error::io("signal handlers", e))?;
        }
        let snapshot = Arc::new(AtomicBool::new(false));
        flag::register(SIGUSR1, snapshot.clone()).map_err(|e| Error::io("signal handlers", e))?;
        Ok(Self { signal, snapshot })
    }

    /// Whether the picture so far was asked for since the last call.
    pub(crate) fn wants_snapshot(&self) -> bool {
        self.snapshot.swap(false, Ordering::SeqCst)
    }

    /// The exit code of the signal that came, if any: 128 and its number.
    pub(crate) fn exit_code(&self) -> Option<u8> {
        match self.signal.load(Ordering::SeqCst) {
            0 => None,
            number => Some(128 + number as u8),
        }
    }
}
