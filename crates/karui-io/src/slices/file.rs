//! A file that is read from several threads, a piece here and a piece there.

use crate::{
    Place,
    error::{Error, ErrorKind, Result},
};
use std::{
    fs::{self, File},
    io,
    path::{Path, PathBuf},
};

/// Bytes a window takes in at once.
const WINDOW: usize = 1 << 20;
/// Longest line of a text file, bytes.
const LINE: usize = 64 << 20;

/// An open file and its length.
#[derive(Debug)]
pub(crate) struct FileAt {
    #[cfg(unix)]
    file: File,
    #[cfg(not(unix))]
    file: std::sync::Mutex<File>,
    /// Name for messages.
    pub path: PathBuf,
    /// Bytes, when it was opened.
    pub len: u64,
}

impl FileAt {
    /// Opens a regular file; a device or pipe cannot be read at an offset.
    ///
    /// # Errors
    /// [`ErrorKind::Io`]
    pub fn open(path: &Path) -> Result<Self> {
        let fail = |error| Error::file(path, ErrorKind::Io(error));
        let found = fs::metadata(path).map_err(fail)?;
        if found.is_dir() {
            return Err(fail(io::ErrorKind::IsADirectory.into()));
        }
        if !found.is_file() {
            return Err(fail(io::Error::other("is not a regular file")));
        }
        let file = File::open(path).map_err(fail)?;
        Ok(Self {
            len: file.metadata().map_err(fail)?.len(),
            #[cfg(unix)]
            file,
            #[cfg(not(unix))]
            file: file.into(),
            path: path.to_path_buf(),
        })
    }

    /// Bytes from `at` on. Memory is taken only for what the file holds.
    ///
    /// # Errors
    /// [`ErrorKind::Truncated`] if there are fewer.
    pub fn read(&self, at: u64, len: u64) -> Result<Vec<u8>> {
        let left = self.len.saturating_sub(at);
        if len > left {
            return Err(short(at, len, left));
        }
        let mut bytes = vec![0; len as usize];
        self.fill(at, &mut bytes).map_err(|error| {
            if error.kind() == io::ErrorKind::UnexpectedEof {
                return short(at, len, 0);
            }
            Error::new(Place::Byte(at), ErrorKind::Io(error))
        })?;
        Ok(bytes)
    }

    #[cfg(unix)]
    fn fill(&self, at: u64, bytes: &mut [u8]) -> io::Result<()> {
        std::os::unix::fs::FileExt::read_exact_at(&self.file, bytes, at)
    }

    #[cfg(not(unix))]
    fn fill(&self, at: u64, bytes: &mut [u8]) -> io::Result<()> {
        use io::{Read, Seek};
        let poisoned = |_| io::Error::other("a reader died");
        let mut file = self.file.lock().map_err(poisoned)?;
        file.seek(io::SeekFrom::Start(at))?;
        file.read_exact(bytes)
    }
}

fn short(at: u64, expected: u64, found: u64) -> Error {
    let kind = ErrorKind::truncated(format!("{expected} bytes"), format!("{found} bytes"));
    Error::new(Place::Byte(at), kind)
}

/// A piece of a file in memory that follows a scan from start to end.
pub(crate) struct Window<'a> {
    file: &'a FileAt,
    start: u64,
    bytes: Vec<u8>,
}

impl<'a> Window<'a> {
    pub fn new(file: &'a FileAt) -> Self {
        Self {
            file,
            start: 0,
            bytes: Vec::new(),
        }
    }

    /// `len` bytes from `at` on, fewer only at the end of the file.
    pub fn get(&mut self, at: u64, len: usize) -> Result<&[u8]> {
        let within = self.offset(at).filter(|o| o + len <= self.bytes.len());
        let offset = match within {
            Some(offset) => offset,
            None => {
                self.load(at, len.max(WINDOW))?;
                0
            }
        };
        let end = (offset + len).min(self.bytes.len());
        Ok(&self.bytes[offset..end])
    }

    /// The line that starts at `at`, its end cut off, and where the next one
    /// starts; `None` at the end of the file.
    pub fn line(&mut self, at: u64) -> Result<Option<(&[u8], u64)>> {
        if at >= self.file.len {
            return Ok(None);
        }
        let mut size = WINDOW;
        let mut offset = match self.offset(at) {
            Some(offset) => offset,
            None => self.load(at, size)?,
        };
        let (end, next) = loop {
            if let Some(end) = memchr::memchr(b'\n', &self.bytes[offset..]) {
                break (offset + end, at + end as u64 + 1);
            }
            if self.start + self.bytes.len() as u64 >= self.file.len {
                break (self.bytes.len(), self.file.len);
            }
            if size > LINE {
                return Err(too_long(at, size));
            }
            offset = self.load(at, size)?;
            size *= 2;
        };
        Ok(Some((&self.bytes[offset..end], next)))
    }

    /// Where in the window `at` is.
    fn offset(&self, at: u64) -> Option<usize> {
        let offset = usize::try_from(at.checked_sub(self.start)?).ok()?;
        (offset < self.bytes.len()).then_some(offset)
    }

    /// Moves the window to `at`, which is then its first byte.
    fn load(&mut self, at: u64, len: usize) -> Result<usize> {
        let left = self.file.len.saturating_sub(at);
        self.bytes = self.file.read(at, left.min(len as u64))?;
        self.start = at;
        Ok(0)
    }
}

fn too_long(at: u64, found: usize) -> Error {
    let kind = ErrorKind::TooLarge {
        what: "length of a line in bytes",
        found: found as u64,
        limit: LINE as u64,
    };
    Error::new(Place::Byte(at), kind)
}
