//! Options that are one of a few names.

use crate::errors::input_error;
use pyo3::PyResult;

/// What `name` stands for.
pub fn choice<T: Copy>(option: &str, name: &str, all: &[(&str, T)]) -> PyResult<T> {
    let found = all.iter().find(|(known, _)| *known == name);
    found.map(|f| f.1).ok_or_else(|| {
        let known: Vec<String> = all.iter().map(|(known, _)| format!("'{known}'")).collect();
        input_error(option, &format!("'{name}'"), &known.join(" or "))
    })
}
