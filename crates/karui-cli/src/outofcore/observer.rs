//! Progress over all phases, with the time that is left.

use crate::console::to_stderr;
use crate::progress::check_cancelled;
use indicatif::{ProgressBar, ProgressStyle};
use karui::Progress;
use std::io::IsTerminal;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

const LINE_EVERY: Duration = Duration::from_secs(5);

/// The observer for the place standard error leads to.
pub fn observer(quiet: bool) -> Box<dyn Progress> {
    let bar = (!quiet && std::io::stderr().is_terminal()).then(bar);
    Box::new(Whole {
        quiet,
        bar,
        seen: Mutex::new(None),
    })
}

fn bar() -> ProgressBar {
    let bar = ProgressBar::new(1000);
    let style = ProgressStyle::with_template("[{bar:40}] {percent:>3}% {elapsed}, {msg}");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar
}

struct Whole {
    quiet: bool,
    bar: Option<ProgressBar>,
    seen: Mutex<Option<Seen>>,
}

struct Seen {
    started: Instant,
    /// Share of the work that had been done before.
    first: f32,
    told: Instant,
}

impl Progress for Whole {
    fn report(&self, stage: &'static str, fraction: f32) {
        if self.quiet {
            return;
        }
        let mut seen = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
        let now = Instant::now();
        let seen = seen.get_or_insert(Seen {
            started: now,
            first: fraction,
            told: now,
        });
        let left = left(now - seen.started, fraction - seen.first, 1.0 - fraction);
        if let Some(bar) = &self.bar {
            bar.set_message(format!("{stage}{left}"));
            bar.set_position((fraction.clamp(0.0, 1.0) * 1000.0) as u64);
        } else if now - seen.told >= LINE_EVERY {
            seen.told = now;
            to_stderr(&format!("{stage}: {:.0} % of all{left}", fraction * 100.0));
        }
    }

    fn cancelled(&self) -> bool {
        check_cancelled().is_err()
    }
}

/// How long the rest takes if it goes on like this.
fn left(elapsed: Duration, done: f32, rest: f32) -> String {
    if done < 0.01 {
        return String::new();
    }
    let seconds = f64::from(rest / done) * elapsed.as_secs_f64();
    match seconds {
        ..100.0 => format!(", about {seconds:.0} s left"),
        100.0..6000.0 => format!(", about {:.0} min left", seconds / 60.0),
        _ => format!(", about {:.1} h left", seconds / 3600.0),
    }
}

impl Drop for Whole {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
