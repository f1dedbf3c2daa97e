//! From Rust's errors to Python's exceptions.

use karui_io::ErrorKind;
use pyo3::{PyErr, import_exception};

import_exception!(karui.errors, InputError);
import_exception!(karui.errors, FileError);
import_exception!(karui.errors, Cancelled);

/// What has a Python exception.
pub trait Raise {
    /// The exception, with the error's own words.
    fn raise(self) -> PyErr;
}

impl Raise for karui::Error {
    fn raise(self) -> PyErr {
        match self {
            Self::Cancelled => Cancelled::new_err(self.to_string()),
            _ => InputError::new_err(self.to_string()),
        }
    }
}

impl Raise for karui_io::Error {
    fn raise(self) -> PyErr {
        let hint = self.hint().map_or(String::new(), |h| format!(" ({h})"));
        let said = format!("{self}{hint}");
        match *self.kind {
            ErrorKind::Io(_) => FileError::new_err(said),
            _ => InputError::new_err(said),
        }
    }
}

/// `what` is `found`, but must be `expected`.
pub fn input_error(what: &str, found: &str, expected: &str) -> PyErr {
    InputError::new_err(format!("`{what}` is {found}; it must be {expected}"))
}
