//! What is printed where: data on standard output, logs on standard error.

use crate::args::Global;
use crate::failure::{Failure, PipeClosed};
use crate::progress;
use anyhow::Result;
use karui::Progress;
use serde::Serialize;
use std::io::{self, Write as _};
use std::time::{Duration, Instant};

/// Where a command's words go, decided once from the global options.
#[derive(Debug)]
pub struct Console {
    /// One JSON document instead of text.
    pub json: bool,
    /// Nothing but results and errors.
    pub quiet: bool,
    started: Instant,
}

impl Console {
    /// Decides from the options.
    pub fn new(global: &Global) -> Self {
        Self {
            json: global.json,
            quiet: global.quiet,
            started: Instant::now(),
        }
    }

    /// Sets up what is one for the whole process: threads and signals.
    pub fn prepare(&self, global: &Global) -> Result<()> {
        if let Some(threads) = global.threads {
            rayon::ThreadPoolBuilder::new()
                .num_threads(threads.into())
                .build_global()?;
        }
        Ok(progress::cancel_on_signal()?)
    }

    /// Prints a result: always, unless JSON was asked for.
    pub fn data(&self, text: &str) -> Result<()> {
        if self.json { Ok(()) } else { to_stdout(text) }
    }

    /// Prints how the work went, unless JSON or silence was asked for.
    pub fn summary(&self, text: &str) -> Result<()> {
        if self.quiet { Ok(()) } else { self.data(text) }
    }

    /// Prints the result as JSON if that was asked for.
    pub fn document(&self, value: &impl Serialize) -> Result<()> {
        if self.json {
            to_stdout(&serde_json::to_string_pretty(value)?)?;
        }
        Ok(())
    }

    /// Says what the user should know but need not act on.
    pub fn warn(&self, text: &str) {
        if !self.quiet {
            to_stderr(&format!("warning: {text}"));
        }
    }

    /// An observer for one piece of long work.
    pub fn progress(&self) -> Box<dyn Progress> {
        progress::observer(self.quiet)
    }

    /// Time since the program started.
    pub fn elapsed(&self) -> Duration {
        self.started.elapsed()
    }
}

/// Prints `text` and a line end.
pub fn to_stdout(text: &str) -> Result<()> {
    bytes_to_stdout(format!("{text}\n").as_bytes())
}

/// Prints bytes as they are.
pub fn bytes_to_stdout(bytes: &[u8]) -> Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Ok(()) => Ok(()),
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Err(PipeClosed.into()),
        Err(error) => Err(Failure::output("standard output".as_ref(), &error).into()),
    }
}

/// Prints a line on standard error; nobody is left to tell if that fails.
pub fn to_stderr(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{text}");
}
