//! Progress on standard error: a bar on a terminal, plain lines elsewhere.

use crate::console::to_stderr;
use indicatif::{ProgressBar, ProgressStyle};
use karui::Progress;
use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

static CANCELLED: AtomicBool = AtomicBool::new(false);
const CANCELLED_CODE: i32 = crate::failure::code::CANCELLED as i32;
const LINE_EVERY: Duration = Duration::from_secs(5);

/// Ends long work at its next step when the user asks to; asking twice ends
/// the process at once.
pub fn cancel_on_signal() -> Result<(), ctrlc::Error> {
    ctrlc::set_handler(|| {
        if CANCELLED.swap(true, Ordering::SeqCst) {
            std::process::exit(CANCELLED_CODE);
        }
    })
}

/// Whether the user asked to stop.
///
/// # Errors
/// [`karui::Error::Cancelled`] if so.
pub fn check_cancelled() -> karui::Result<()> {
    if CANCELLED.load(Ordering::SeqCst) {
        return Err(karui::Error::Cancelled);
    }
    Ok(())
}

/// The observer for the place standard error leads to.
pub fn observer(quiet: bool) -> Box<dyn Progress> {
    if quiet {
        return Box::new(Quiet);
    }
    if std::io::stderr().is_terminal() {
        return Box::new(Bar::new());
    }
    Box::new(Lines::default())
}

struct Quiet;

impl Progress for Quiet {
    fn report(&self, _: &'static str, _: f32) {}
    fn cancelled(&self) -> bool {
        CANCELLED.load(Ordering::SeqCst)
    }
}

struct Bar(ProgressBar);

impl Bar {
    fn new() -> Self {
        let bar = ProgressBar::new(1000);
        let style = ProgressStyle::with_template("{msg:>12} [{bar:40}] {percent:>3}% {elapsed}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        Self(bar)
    }
}

impl Progress for Bar {
    fn report(&self, stage: &'static str, fraction: f32) {
        if self.0.message() != stage {
            self.0.set_message(stage);
        }
        self.0
            .set_position((fraction.clamp(0.0, 1.0) * 1000.0) as u64);
    }
    fn cancelled(&self) -> bool {
        CANCELLED.load(Ordering::SeqCst)
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// One line every few seconds, none for work that is over before.
struct Lines(Mutex<Instant>);

impl Default for Lines {
    fn default() -> Self {
        Self(Mutex::new(Instant::now()))
    }
}

impl Progress for Lines {
    fn report(&self, stage: &'static str, fraction: f32) {
        let mut last = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if last.elapsed() >= LINE_EVERY {
            *last = Instant::now();
            to_stderr(&format!("{stage}: {:.0} %", fraction * 100.0));
        }
    }
    fn cancelled(&self) -> bool {
        CANCELLED.load(Ordering::SeqCst)
    }
}
