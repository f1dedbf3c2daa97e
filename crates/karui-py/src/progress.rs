//! Long work beside the interpreter: watched, told about, and stopped by Ctrl-C.

use crate::errors::{Cancelled, Raise};
use karui::Progress;
use pyo3::prelude::*;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering::SeqCst};
use std::sync::{Mutex, PoisonError};
use std::thread::{Builder, Thread, current, park_timeout, scope};
use std::time::Duration;

/// How long Python waits for a signal or a new stage.
const TICK: Duration = Duration::from_millis(50);
/// Bytes of the working thread's stack: what a main thread has.
const STACK: usize = 8 << 20;

/// What the work has last told, and whether it is to stop.
#[derive(Default)]
struct Watch {
    latest: Mutex<Option<(&'static str, f32)>>,
    cancelled: AtomicBool,
}

impl Watch {
    fn take(&self) -> Option<(&'static str, f32)> {
        let mut latest = self.latest.lock().unwrap_or_else(PoisonError::into_inner);
        latest.take()
    }
}

impl Progress for Watch {
    fn report(&self, stage: &'static str, fraction: f32) {
        let mut latest = self.latest.lock().unwrap_or_else(PoisonError::into_inner);
        *latest = Some((stage, fraction));
    }

    fn cancelled(&self) -> bool {
        self.cancelled.load(SeqCst)
    }
}

/// Wakes the thread that waits, however the work has ended.
struct Wake<'a> {
    done: &'a AtomicBool,
    waiting: Thread,
}

impl Drop for Wake<'_> {
    fn drop(&mut self) {
        self.done.store(true, SeqCst);
        self.waiting.unpark();
    }
}

/// Does `work` in a thread of its own without the GIL. This one keeps looking for signals and
/// calls `callback(stage, fraction)`, so that it does not matter from where the work tells what.
pub fn run<T: Send, E: Raise + Send>(
    py: Python<'_>,
    callback: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&dyn Progress) -> Result<T, E> + Send,
) -> PyResult<T> {
    let (watch, done) = (Watch::default(), AtomicBool::new(false));
    scope(|threads| {
        let (watch, done, waiting) = (&watch, &done, current());
        let worker = Builder::new()
            .stack_size(STACK)
            .spawn_scoped(threads, move || {
                let _wake = Wake { done, waiting };
                work(watch)
            })?;
        let watched = supervise(py, callback, watch, done);
        watch.cancelled.store(watched.is_err(), SeqCst);
        let ended = py.detach(|| worker.join());
        watched?;
        ended
            .unwrap_or_else(|panic| resume_unwind(panic))
            .map_err(Raise::raise)
    })
}

fn supervise(
    py: Python<'_>,
    callback: Option<&Bound<'_, PyAny>>,
    watch: &Watch,
    done: &AtomicBool,
) -> PyResult<()> {
    while !done.load(SeqCst) {
        py.detach(|| park_timeout(TICK));
        py.check_signals()?;
        tell(callback, watch)?;
    }
    Ok(())
}

/// Passes on what is new.
fn tell(callback: Option<&Bound<'_, PyAny>>, watch: &Watch) -> PyResult<()> {
    let (Some(callback), Some(latest)) = (callback, watch.take()) else {
        return Ok(());
    };
    let answer = callback.call1(latest)?;
    match answer.is_none() || answer.is_truthy()? {
        true => Ok(()),
        false => Err(Cancelled::new_err("cancelled by the progress callback")),
    }
}
