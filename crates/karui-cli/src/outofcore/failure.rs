//! Errors of work out of core, told like those of other commands.

use crate::failure::Failure;
use karui::outofcore::Error;

/// The error that the command line knows how to tell.
pub fn told(error: Error) -> anyhow::Error {
    match error {
        Error::Block(error) => error.into(),
        Error::Source(error) | Error::Sink(error) => match error.downcast::<karui_io::Error>() {
            Ok(error) => (*error).into(),
            Err(other) => anyhow::Error::from_boxed(other),
        },
        Error::Store { path, cause } => Failure::output(&path, &cause).into(),
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
