//! The logs of all meshes of a scene in one file.

use super::CollapseLog;
use crate::error::{Error, Result};

const MAGIC: [u8; 8] = *b"KARUISCN";
const VERSION: u32 = 1;

impl CollapseLog {
    /// The logs of a scene, one a mesh, as bytes: `KARUISCN`, the version, the
    /// number of meshes (`u32`), and for every mesh the length of its log
    /// (`u64`, 0 for none) and the log as [`Self::to_bytes`] writes it; all
    /// little-endian.
    #[must_use]
    pub fn scene_to_bytes(logs: &[Option<&Self>]) -> Vec<u8> {
        let mut out = MAGIC.to_vec();
        out.extend(VERSION.to_le_bytes());
        out.extend((logs.len() as u32).to_le_bytes());
        for log in logs {
            let bytes = log.map(Self::to_bytes).unwrap_or_default();
            out.extend((bytes.len() as u64).to_le_bytes());
            out.extend(bytes);
        }
        out
    }

    /// Reads what [`Self::scene_to_bytes`] has written.
    ///
    /// # Errors
    /// [`Error::BadLog`] with the number of the byte.
    pub fn scene_from_bytes(bytes: &[u8]) -> Result<Vec<Option<Self>>> {
        let mut rest = bytes;
        let bad = |rest: &[u8], problem| Error::BadLog {
            at: bytes.len() - rest.len(),
            problem,
        };
        if take(&mut rest) != Some(MAGIC) {
            return Err(bad(bytes, "it does not begin with KARUISCN"));
        }
        let early = "it ends too early";
        let word = |rest: &mut &[u8]| {
            let at = *rest;
            let word = take(rest).ok_or_else(|| bad(at, early))?;
            Ok::<_, Error>(u32::from_le_bytes(word))
        };
        if word(&mut rest)? != VERSION {
            return Err(bad(rest, "the version is not 1, the only one known"));
        }
        let mut logs = Vec::new();
        for _ in 0..word(&mut rest)? {
            let len = take(&mut rest).map(u64::from_le_bytes);
            let len = len.and_then(|len| usize::try_from(len).ok());
            let split = len.and_then(|len| rest.split_at_checked(len));
            let (log, after) = split.ok_or_else(|| bad(rest, early))?;
            logs.push(match log {
                [] => None,
                log => Some(Self::from_bytes(log)?),
            });
            rest = after;
        }
        match rest {
            [] => Ok(logs),
            _ => Err(bad(rest, "there are bytes left over")),
        }
    }
}

fn take<const N: usize>(rest: &mut &[u8]) -> Option<[u8; N]> {
    let (taken, after) = rest.split_first_chunk()?;
    *rest = after;
    Some(*taken)
}
