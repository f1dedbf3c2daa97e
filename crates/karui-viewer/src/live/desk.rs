//! Where a socket and the thread that works for it meet: the latest message waits here, and
//! only that.

use karui::Progress;
use serde_json::{Value, json};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tokio::sync::mpsc::Sender;

/// Time between two reports of progress.
const REPORT_EVERY: Duration = Duration::from_millis(100);

/// What goes to the page.
#[derive(Debug)]
pub enum Outgoing {
    /// JSON.
    Text(String),
    /// A frame.
    Frame(Vec<u8>),
}

/// The desk.
#[derive(Debug)]
pub struct Desk {
    letters: Mutex<Letters>,
    came: Condvar,
    out: Sender<Outgoing>,
    reported: Mutex<Option<Instant>>,
}

#[derive(Debug, Default)]
struct Letters {
    latest: Option<String>,
    closed: bool,
}

impl Desk {
    /// A desk with nothing on it.
    pub fn new(out: Sender<Outgoing>) -> Self {
        Self {
            letters: Mutex::default(),
            came: Condvar::new(),
            out,
            reported: Mutex::new(None),
        }
    }

    fn letters(&self) -> MutexGuard<'_, Letters> {
        self.letters.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Puts a message in the place of one that has not been taken.
    pub fn put(&self, message: String) {
        self.letters().latest = Some(message);
        self.came.notify_one();
    }

    /// Nobody will come any more.
    pub fn close(&self) {
        self.letters().closed = true;
        self.came.notify_one();
    }

    /// Waits for a message; none once the page has gone.
    pub fn take(&self) -> Option<String> {
        let mut letters = self.letters();
        loop {
            if letters.closed {
                return None;
            }
            if let Some(message) = letters.latest.take() {
                return Some(message);
            }
            let waited = self.came.wait(letters);
            letters = waited.unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Sends something; that the page has gone is found out by [`Desk::take`].
    pub fn send(&self, what: Outgoing) {
        let _gone = self.out.blocking_send(what);
    }

    /// Sends JSON.
    pub fn tell(&self, what: &Value) {
        self.send(Outgoing::Text(what.to_string()));
    }

    /// Sends what is wrong.
    pub fn fail(&self, error: &dyn std::error::Error) {
        self.tell(&json!({ "error": error.to_string() }));
    }
}

impl Progress for Desk {
    fn report(&self, stage: &'static str, fraction: f32) {
        let mut last = self.reported.lock().unwrap_or_else(PoisonError::into_inner);
        if last.is_some_and(|l| l.elapsed() < REPORT_EVERY) {
            return;
        }
        *last = Some(Instant::now());
        let progress = json!({ "progress": { "stage": stage, "fraction": fraction } });
        // What is lost here is told again soon.
        let _full = self.out.try_send(Outgoing::Text(progress.to_string()));
    }

    fn cancelled(&self) -> bool {
        self.letters().closed
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tokio::sync::mpsc::channel;

    #[test]
    fn the_latest_message_wins() {
        let (out, mut sent) = channel(4);
        let desk = Desk::new(out);
        desk.put("old".to_owned());
        desk.put("new".to_owned());
        assert_eq!(desk.take().as_deref(), Some("new"));
        desk.report("build", 0.5);
        desk.report("build", 0.6);
        assert!(matches!(sent.try_recv(), Ok(Outgoing::Text(t)) if t.contains("0.5")));
        assert!(sent.try_recv().is_err(), "one report at a time");
        assert!(!desk.cancelled());
        desk.put("late".to_owned());
        desk.close();
        assert_eq!(desk.take(), None);
        assert!(desk.cancelled());
    }

    #[test]
    fn who_waits_is_woken() {
        let (out, _sent) = channel(4);
        let desk = Desk::new(out);
        std::thread::scope(|scope| {
            let waits = scope.spawn(|| desk.take());
            desk.put("here".to_owned());
            assert_eq!(waits.join().unwrap().as_deref(), Some("here"));
            let waits = scope.spawn(|| desk.take());
            desk.close();
            assert_eq!(waits.join().unwrap(), None);
        });
    }
}
