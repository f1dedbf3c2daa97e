//! Errors of work out of core, told like those of other commands.

use super::place::cloudy;
use crate::failure::Failure;
use karui::outofcore::Error;
use karui_io::ErrorKind;
use std::{io, path::Path};

/// The error that the command line knows how to tell.
pub fn told(error: Error) -> anyhow::Error {
    match error {
        Error::Block(error) => error.into(),
        Error::Source(error) | Error::Sink(error) => match error.downcast::<karui_io::Error>() {
            Ok(error) => (*error).into(),
            Err(other) => anyhow::Error::from_boxed(other),
        },
        Error::Store { path, cause } => unwritten(&path, &cause).into(),
        Error::Damaged { .. } => {
            let hint =
                "`karui plan verify` tells what is damaged; `karui plan resume` makes it anew";
            Failure::check(error.to_string()).hint(hint).into()
        }
        Error::OtherPlan { .. } => {
            let hint = "remove that folder, or name another one with --work";
            Failure::input(error.to_string()).hint(hint).into()
        }
        other => other.into(),
    }
}

/// The same of what is made out of blocks.
pub fn told_of_files(error: karui_io::Error) -> anyhow::Error {
    match *error.kind {
        ErrorKind::Blocks(error) => told(error),
        _ => error.into(),
    }
}

/// A bucket is no folder.
fn unwritten(path: &Path, cause: &io::Error) -> Failure {
    let failure = Failure::output(path, cause);
    if cloudy(path).is_none() {
        return failure;
    }
    match cause.kind() {
        io::ErrorKind::NotFound => failure.hint("create the bucket first, or check its name"),
        io::ErrorKind::PermissionDenied => failure.hint(
            "check what the environment says of who asks: AWS_*, GOOGLE_* or AZURE_* variables",
        ),
        _ => failure,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::failure::hint_of;

    #[test]
    fn hints_speak_of_buckets_where_there_are_some() {
        let hint = |path: &str, kind: io::ErrorKind| {
            let (path, cause) = (path.into(), kind.into());
            hint_of(&told(Error::Store { path, cause })).expect("a hint")
        };
        let missing = io::ErrorKind::NotFound;
        assert!(hint("s3://bucket/work/a.block", missing).contains("bucket"));
        assert!(hint("work/a.block", missing).contains("folder"));
        let denied = io::ErrorKind::PermissionDenied;
        assert!(hint("az://container/work", denied).contains("AZURE_"));
        assert!(!hint("work", denied).contains("AZURE_"));
    }
}
