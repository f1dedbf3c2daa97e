//! Land to measure with, made by a process of its own.

use super::super::child;
use anyhow::{Result, ensure};
use std::ffi::OsString;
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Duration;

/// Nothing here takes longer.
pub(super) const LIMIT: Duration = Duration::from_secs(24 * 3600);

/// Vertices along x and z.
#[derive(Debug, Clone, Copy)]
pub struct Size {
    columns: u32,
    rows: u32,
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let sides = text.split_once('x');
        let sides = sides.and_then(|(c, r)| Some((c.parse().ok()?, r.parse().ok()?)));
        match sides {
            Some((columns, rows)) if columns >= 2 && rows >= 2 => Ok(Self { columns, rows }),
            _ => Err("expected COLUMNSxROWS, for instance 4097x2049".into()),
        }
    }
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{}", self.columns, self.rows)
    }
}

impl Size {
    /// Triangles of land of this size.
    pub fn triangles(self) -> u64 {
        2 * u64::from(self.columns - 1) * u64::from(self.rows - 1)
    }

    /// Writes the land into `folder`.
    pub fn make(self, folder: &Path, half_flat: bool) -> Result<PathBuf> {
        let path = folder.join(format!("land-{self}.ply"));
        let mut words = words(["scene", "terrain", "--quiet", "--size"]);
        words.extend([
            self.to_string().into(),
            "--output".into(),
            path.clone().into(),
        ]);
        words.extend(half_flat.then(|| "--half-flat".into()));
        let ended = child::run(&words, &[], LIMIT)?;
        ensure!(ended.code == Some(0), "making land: {}", ended.error);
        Ok(path)
    }
}

/// Words of a command line.
pub fn words<const N: usize>(words: [&str; N]) -> Vec<OsString> {
    words.map(OsString::from).to_vec()
}

#[cfg(test)]
mod tests {
    use super::Size;

    #[test]
    fn sizes_are_read_and_counted() {
        let size: Size = "4097x2049".parse().expect("a size");
        assert_eq!(size.triangles(), 16_777_216);
        assert_eq!(size.to_string(), "4097x2049");
        for bad in ["1x2", "x", "3", "3x-1"] {
            assert!(bad.parse::<Size>().is_err(), "{bad}");
        }
    }
}
