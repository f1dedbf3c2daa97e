//! This program again, in a process of its own.

use crate::progress::check_cancelled;
use anyhow::{Context as _, Result};
use std::ffi::OsString;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// How a process ended.
pub struct Ended {
    /// The exit code, -1 for a signal; `None` if the time ran out and the
    /// process was ended.
    pub code: Option<i32>,
    pub out: String,
    /// What follows `error: ` on standard error.
    pub error: String,
}

/// Runs this program with `args` and the environment variables `set`.
pub fn run(args: &[OsString], set: &[(&str, &str)], limit: Duration) -> Result<Ended> {
    let mut child = Command::new(std::env::current_exe()?)
        .args(args)
        .envs(set.iter().copied())
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .context("starting the process of a model")?;
    let code = wait(&mut child, limit);
    let [out, err] = [text(child.stdout.take()), text(child.stderr.take())];
    let told = err.lines().find_map(|l| l.strip_prefix("error: "));
    Ok(Ended {
        code: code?,
        out,
        error: told.unwrap_or_default().to_owned(),
    })
}

fn wait(child: &mut Child, limit: Duration) -> Result<Option<i32>> {
    let started = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(Some(status.code().unwrap_or(-1)));
        }
        let cancelled = check_cancelled();
        if cancelled.is_err() || started.elapsed() > limit {
            child.kill()?;
            child.wait()?;
            cancelled?;
            return Ok(None);
        }
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// What the process wrote; it is less than a pipe holds.
fn text(pipe: Option<impl std::io::Read>) -> String {
    let mut text = String::new();
    if let Some(mut pipe) = pipe {
        // What cannot be read is missed where it is parsed.
        let _ = pipe.read_to_string(&mut text);
    }
    text
}
