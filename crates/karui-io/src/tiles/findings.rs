//! What a checker has to say.

use serde::Serialize;
use std::{
    fmt,
    path::{Path, PathBuf},
};

/// Findings of a kind that are kept; a damaged tileset could cause millions.
const KEPT: usize = 1000;

/// A rule and where it is broken.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// The file.
    pub file: PathBuf,
    /// A JSON pointer into the file, or `level/x/y[/z]` of an implicit tile;
    /// empty for the file as a whole.
    pub place: String,
    /// Name of the rule, e.g. `geometric-error-grows`.
    pub rule: &'static str,
    /// What the rule asks for.
    pub expected: String,
    /// What is there.
    pub found: String,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.file.display())?;
        if !self.place.is_empty() {
            write!(f, "{}: ", self.place)?;
        }
        let (expected, found, rule) = (&self.expected, &self.found, self.rule);
        write!(f, "expected {expected}, found {found} [{rule}]")
    }
}

/// Errors and warnings in the order they were met, the first thousand of each.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Findings {
    /// Rules of the specification that are broken.
    pub errors: Vec<Finding>,
    /// What the specification allows but is likely a mistake, and what could
    /// not be checked.
    pub warnings: Vec<Finding>,
    /// Errors beyond those kept.
    pub further_errors: u64,
    /// Warnings beyond those kept.
    pub further_warnings: u64,
}

impl Findings {
    /// Number of all errors.
    #[must_use]
    pub fn error_count(&self) -> u64 {
        self.errors.len() as u64 + self.further_errors
    }

    /// Puts an error before all others, so that it is kept.
    pub(super) fn push_first(&mut self, finding: Finding) {
        self.errors.insert(0, finding);
        if self.errors.len() > KEPT {
            self.errors.pop();
            self.further_errors += 1;
        }
    }

    pub(super) fn append(&mut self, other: Self) {
        other.errors.into_iter().for_each(|f| self.push(f, true));
        other.warnings.into_iter().for_each(|f| self.push(f, false));
        self.further_errors += other.further_errors;
        self.further_warnings += other.further_warnings;
    }

    pub(super) fn push(&mut self, finding: Finding, error: bool) {
        let (list, further) = if error {
            (&mut self.errors, &mut self.further_errors)
        } else {
            (&mut self.warnings, &mut self.further_warnings)
        };
        if list.len() < KEPT {
            list.push(finding);
        } else {
            *further += 1;
        }
    }
}

/// Findings about one file.
pub(super) struct Notes<'a> {
    pub file: &'a Path,
    pub findings: &'a mut Findings,
}

impl Notes<'_> {
    pub fn error(
        &mut self,
        place: impl fmt::Display,
        rule: &'static str,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) {
        self.add(true, &place, rule, expected.into(), found.into());
    }

    pub fn warn(
        &mut self,
        place: impl fmt::Display,
        rule: &'static str,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) {
        self.add(false, &place, rule, expected.into(), found.into());
    }

    fn add(
        &mut self,
        error: bool,
        place: &dyn fmt::Display,
        rule: &'static str,
        expected: String,
        found: String,
    ) {
        let finding = Finding {
            file: self.file.to_owned(),
            place: place.to_string(),
            rule,
            expected,
            found,
        };
        self.findings.push(finding, error);
    }
}
