//! Errors of the command line: exit code, message, hint.

use std::{error::Error, fmt, io, io::Write as _, path::Path, process::ExitCode};

/// Exit codes, as `karui --help` documents them.
pub mod code {
    /// A check that was asked for failed.
    pub const CHECK: u8 = 1;
    /// Bad usage or bad input.
    pub const INPUT: u8 = 2;
    /// Output cannot be written.
    pub const OUTPUT: u8 = 3;
    /// Interrupted by the user.
    pub const CANCELLED: u8 = 130;
}

/// An error that knows its exit code and what to do about it.
#[derive(Debug)]
pub struct Failure {
    code: u8,
    message: String,
    hint: Option<String>,
}

impl Failure {
    /// Bad usage or bad input.
    pub fn input(message: impl Into<String>) -> Self {
        Self::new(code::INPUT, message.into())
    }

    /// A check that was asked for failed.
    pub fn check(message: impl Into<String>) -> Self {
        Self::new(code::CHECK, message.into())
    }

    /// The user asked to stop.
    pub fn cancelled(message: impl Into<String>) -> Self {
        Self::new(code::CANCELLED, message.into())
    }

    /// `path` cannot be written.
    pub fn output(path: &Path, error: &io::Error) -> Self {
        let message = format!("cannot write {}: {error}", path.display());
        let failure = Self::new(code::OUTPUT, message);
        match error.kind() {
            io::ErrorKind::NotFound => failure.hint("create the folder first"),
            io::ErrorKind::NotADirectory => failure.hint("part of the path is a file"),
            io::ErrorKind::IsADirectory => failure.hint("it is a folder; name a file"),
            io::ErrorKind::PermissionDenied => failure.hint("check who may write there"),
            io::ErrorKind::StorageFull => failure.hint("free some space and try again"),
            _ => failure,
        }
    }

    /// Adds what the user can do.
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }

    fn new(code: u8, message: String) -> Self {
        Self {
            code,
            message,
            hint: None,
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl Error for Failure {}

/// Standard output was closed by its reader, which is no failure.
#[derive(Debug)]
pub struct PipeClosed;

impl fmt::Display for PipeClosed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("standard output was closed")
    }
}

impl Error for PipeClosed {}

/// Tells the user about `error` and returns the exit code it stands for.
pub fn report(error: &anyhow::Error) -> ExitCode {
    if error.is::<PipeClosed>() {
        return ExitCode::SUCCESS;
    }
    let mut text = format!("error: {}\n", message_of(error));
    if let Some(hint) = hint_of(error) {
        text += &format!("hint: {hint}\n");
    }
    // Nobody is left to tell if this fails.
    let _ = io::stderr().write_all(text.as_bytes());
    ExitCode::from(code_of(error))
}

/// What went wrong and why, without causes whose words have been said.
fn message_of(error: &anyhow::Error) -> String {
    error.chain().fold(String::new(), |said, cause| {
        let cause = cause.to_string();
        match said.as_str() {
            "" => cause,
            known if known.contains(&cause) => said,
            known => format!("{known}: {cause}"),
        }
    })
}

/// The exit code an error stands for.
pub fn code_of(error: &anyhow::Error) -> u8 {
    error.chain().find_map(code_of_cause).unwrap_or(code::INPUT)
}

fn code_of_cause(cause: &(dyn Error + 'static)) -> Option<u8> {
    if let Some(failure) = cause.downcast_ref::<Failure>() {
        return Some(failure.code);
    }
    let cancelled = matches!(cause.downcast_ref(), Some(karui::Error::Cancelled));
    cancelled.then_some(code::CANCELLED)
}

/// What the user can do about an error.
pub fn hint_of(error: &anyhow::Error) -> Option<String> {
    error.chain().find_map(|cause| {
        if let Some(failure) = cause.downcast_ref::<Failure>() {
            return failure.hint.clone();
        }
        let io = cause.downcast_ref::<karui_io::Error>()?;
        io.hint().map(str::to_owned)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_said_twice() {
        let cause = io::Error::other("the folder is full");
        let error = karui_io::Error::file("a.glb", karui_io::ErrorKind::Io(cause));
        assert_eq!(message_of(&error.into()), "a.glb: the folder is full");
        let error = anyhow::anyhow!("deep").context("high");
        assert_eq!(message_of(&error), "high: deep");
    }
}
