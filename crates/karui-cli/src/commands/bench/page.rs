//! Pages of figures that several commands write a part of each.

use crate::console::Console;
use crate::failure::Failure;
use crate::output::Staged;
use anyhow::Result;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// A Markdown file that is going to be written.
pub struct Page {
    path: PathBuf,
    staged: Staged,
}

impl Page {
    /// Makes sure that `path` can be written, before any work is done for it.
    pub fn open(path: &Path) -> Result<Self> {
        Ok(Self {
            path: path.to_owned(),
            staged: Staged::beside(path)?,
        })
    }

    /// Writes `body` in place of what `command` wrote there before, else at
    /// the end. What is around it stays.
    pub fn write(self, command: &str, body: &str) -> Result<()> {
        let before = match std::fs::read_to_string(&self.path) {
            Err(error) if error.kind() == ErrorKind::NotFound => String::new(),
            text => text.map_err(|e| Failure::output(&self.path, &e))?,
        };
        let name = self.path.file_name().unwrap_or_default();
        let page = with_section(&before, command, body);
        self.staged
            .bytes(&name.to_string_lossy(), page.as_bytes())?;
        self.staged.publish()?;
        Ok(())
    }
}

/// Writes what `command` has found into the page, if there is one, else prints it.
pub fn tell(page: Option<Page>, command: &str, body: &str, console: &Console) -> Result<()> {
    match page {
        Some(page) => page.write(command, body),
        None => console.data(body),
    }
}

/// `page` with `body` as the section of `command`.
fn with_section(page: &str, command: &str, body: &str) -> String {
    let begin = format!("<!-- begin: {command} -->\n");
    let end = format!("<!-- end: {command} -->\n");
    let section = format!("{begin}{}\n{end}", body.trim_end());
    let old = page.find(&begin).and_then(|from| {
        let length = page[from..].find(&end)?;
        Some(from..from + length + end.len())
    });
    match old {
        Some(old) => format!("{}{section}{}", &page[..old.start], &page[old.end..]),
        None if page.is_empty() => section,
        None => format!("{}\n\n{section}", page.trim_end()),
    }
}

/// Where and when figures were taken.
pub fn machine() -> String {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    format!("Machine: {threads} threads. Date: {}.", date(since_1970()))
}

/// Days since 1970-01-01.
fn since_1970() -> u64 {
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    now.map_or(0, |elapsed| elapsed.as_secs() / 86_400)
}

/// The date that many days after 1970-01-01 (H. Hinnant, `civil_from_days`).
fn date(days: u64) -> String {
    let days = days + 719_468;
    let (era, of_era) = (days / 146_097, days % 146_097);
    let year = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let shifted = (5 * of_year + 2) / 153;
    let day = of_year - (153 * shifted + 2) / 5 + 1;
    let month = if shifted < 10 {
        shifted + 3
    } else {
        shifted - 9
    };
    let year = era * 400 + year + u64::from(month <= 2);
    format!("{year}-{month:02}-{day:02}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_of_known_days() {
        assert_eq!(date(0), "1970-01-01");
        assert_eq!(date(11_016), "2000-02-29");
        assert_eq!(date(20_779), "2026-11-22");
    }

    #[test]
    fn sections_are_appended_then_replaced() {
        let one = with_section("", "a", "first\n");
        assert_eq!(one, "<!-- begin: a -->\nfirst\n<!-- end: a -->\n");
        let two = with_section(&one, "b", "second");
        let expected = format!("{one}\n<!-- begin: b -->\nsecond\n<!-- end: b -->\n");
        assert_eq!(two, expected);
        let again = with_section(&two, "a", "other");
        assert_eq!(again, expected.replace("first", "other"));
    }
}
