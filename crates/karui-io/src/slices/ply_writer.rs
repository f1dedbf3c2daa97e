//! A PLY file that is written slice after slice.

use crate::{
    PlyEncoding,
    atomic::{BUFFER, temporary},
    color::Layout,
    error::{Error, ErrorKind, Place, Result},
    ply::write::{Column, Row, Types, index_type, vertex_columns},
};
use karui::{
    TriMesh,
    mesh::Attributes,
    outofcore::{self, Sink, Vertices},
};
use std::{
    io::{self, BufWriter, Seek, SeekFrom, Write},
    path::{Path, PathBuf},
};
use tempfile::NamedTempFile;

/// Writes a binary (little endian) PLY of any size: all vertices, then all triangles.
///
/// The file is written aside under another name; [`PlyWriter::finish`] puts the counts
/// into its header and renames it. Dropped before, nothing is left.
///
/// The first vertices decide which attributes there are. Colours are rounded to bytes,
/// as most programs expect; all else reads back as it was.
#[derive(Debug)]
pub struct PlyWriter {
    file: BufWriter<NamedTempFile>,
    target: PathBuf,
    /// Lines of the header for the properties of a vertex, once they are known.
    properties: Option<String>,
    header: usize,
    vertices: u64,
    triangles: u64,
}

impl PlyWriter {
    /// Starts the file that is to become `target`.
    ///
    /// # Errors
    /// [`ErrorKind::Io`] if it cannot be made there.
    pub fn create(target: impl AsRef<Path>) -> Result<Self> {
        let target = target.as_ref();
        let fail = |error| Error::file(target, ErrorKind::Io(error));
        Ok(Self {
            file: BufWriter::with_capacity(BUFFER, temporary(target).map_err(fail)?),
            target: target.to_path_buf(),
            properties: None,
            header: 0,
            vertices: 0,
            triangles: 0,
        })
    }

    /// Vertices written so far.
    #[must_use]
    pub fn vertices(&self) -> u64 {
        self.vertices
    }

    /// Triangles written so far.
    #[must_use]
    pub fn triangles(&self) -> u64 {
        self.triangles
    }

    /// Appends vertices, which get the next ids.
    ///
    /// # Errors
    /// [`ErrorKind::Io`]; [`ErrorKind::Geometry`] for values that are not finite and
    /// arrays too short; [`ErrorKind::Unsupported`] for vertices after triangles or with
    /// other attributes than the first; [`ErrorKind::TooLarge`] beyond 2^32 - 1.
    pub fn write_vertices(&mut self, slice: Vertices) -> Result<()> {
        if self.triangles > 0 {
            return self.refuse(ErrorKind::unsupported("a vertex after triangles"));
        }
        let slice = TriMesh {
            positions: slice.positions,
            attributes: slice.attributes,
            ..TriMesh::default()
        };
        slice.validate().map_err(|error| self.error(error.into()))?;
        let columns = vertex_columns(&slice.positions, &slice.attributes, &fixed_types());
        let named = properties(&columns);
        if *self.start(&named)? != named {
            let kind = ErrorKind::unsupported("a vertex with other attributes than the first");
            return self.refuse(kind);
        }
        self.count_vertices(slice.positions.len() as u64)?;
        let mut row = Row {
            encoding: PlyEncoding::BinaryLittleEndian,
            bytes: Vec::new(),
        };
        for v in 0..slice.positions.len() {
            columns.iter().for_each(|c| row.push((c.value)(v)));
            if row.bytes.len() >= BUFFER {
                self.put(&row.bytes)?;
                row.bytes.clear();
            }
        }
        self.put(&row.bytes)
    }

    /// Appends triangles of vertices written before.
    ///
    /// # Errors
    /// [`ErrorKind::Io`], [`ErrorKind::IndexOutOfRange`].
    pub fn write_triangles(&mut self, triangles: &[[u64; 3]]) -> Result<()> {
        self.start(&bare())?;
        let mut bytes = Vec::with_capacity(13 * triangles.len().min(BUFFER));
        for corners in triangles {
            if let Some(&index) = corners.iter().find(|&&v| v >= self.vertices) {
                return self.refuse(ErrorKind::IndexOutOfRange {
                    what: "vertex",
                    index: i64::try_from(index).unwrap_or(i64::MAX),
                    count: self.vertices as usize,
                });
            }
            bytes.push(3);
            // Below the number of vertices, which 32 bits can count.
            let narrow = corners.map(|v| (v as u32).to_le_bytes());
            bytes.extend_from_slice(narrow.as_flattened());
            if bytes.len() >= BUFFER {
                self.put(&bytes)?;
                bytes.clear();
            }
        }
        self.triangles += triangles.len() as u64;
        self.put(&bytes)
    }

    /// Puts the counts into the header and the file in its place; returns its size in
    /// bytes.
    ///
    /// # Errors
    /// [`ErrorKind::Io`]
    pub fn finish(mut self) -> Result<u64> {
        let properties = self.start(&bare())?.clone();
        let header = self.header_text(&properties, [self.vertices, self.triangles]);
        let target = std::mem::take(&mut self.target);
        let placed = self.place(&target, &header);
        placed.map_err(|error| Error::file(target, ErrorKind::Io(error)))
    }

    fn place(self, target: &Path, header: &str) -> io::Result<u64> {
        let mut file = self
            .file
            .into_inner()
            .map_err(io::IntoInnerError::into_error)?;
        file.seek(SeekFrom::Start(0))?;
        file.write_all(header.as_bytes())?;
        let bytes = file.as_file().metadata()?.len();
        file.persist(target).map_err(|e| e.error)?;
        Ok(bytes)
    }

    /// Writes a header of the final length unless there is one, and returns the
    /// properties it names.
    fn start(&mut self, properties: &str) -> Result<&String> {
        if self.properties.is_none() {
            let header = self.header_text(properties, [u64::from(u32::MAX), u64::MAX]);
            self.header = header.len();
            self.put(header.as_bytes())?;
        }
        Ok(self.properties.get_or_insert_with(|| properties.to_owned()))
    }

    /// The header, filled up with blanks in its comment to the length it had first.
    fn header_text(&self, properties: &str, [vertices, triangles]: [u64; 2]) -> String {
        let index = index_type(vertices);
        let text = |blanks: usize| {
            format!(
                "ply\nformat binary_little_endian 1.0\ncomment written by karui{:blanks$}\n\
                 element vertex {vertices}\n{properties}element face {triangles}\n\
                 property list uchar {index} vertex_indices\nend_header\n",
                ""
            )
        };
        let shortest = text(0);
        text(self.header.saturating_sub(shortest.len()))
    }

    fn count_vertices(&mut self, added: u64) -> Result<()> {
        let (found, limit) = (self.vertices + added, u64::from(u32::MAX));
        if found > limit {
            let what = "vertices";
            return self.refuse(ErrorKind::TooLarge { what, found, limit });
        }
        self.vertices = found;
        Ok(())
    }

    fn put(&mut self, bytes: &[u8]) -> Result<()> {
        let written = self.file.write_all(bytes);
        written.map_err(|error| self.error(ErrorKind::Io(error)))
    }

    fn refuse<T>(&self, kind: ErrorKind) -> Result<T> {
        Err(self.error(kind))
    }

    fn error(&self, kind: ErrorKind) -> Error {
        Error::new(Place::File, kind).in_file(&self.target)
    }
}

impl Sink for PlyWriter {
    fn begin(&mut self, _: u64, _: u64, _: &Attributes) -> outofcore::Result<()> {
        // Counts come into the header in the end, attributes with the first vertices.
        Ok(())
    }

    fn vertices(&mut self, vertices: &Vertices) -> outofcore::Result<()> {
        self.write_vertices(vertices.clone()).map_err(sunk)
    }

    fn triangles(&mut self, triangles: &[[u64; 3]]) -> outofcore::Result<()> {
        self.write_triangles(triangles).map_err(sunk)
    }
}

fn sunk(error: Error) -> outofcore::Error {
    outofcore::Error::Sink(Box::new(error))
}

/// Types that do not depend on values, as those to come are not known.
fn fixed_types() -> Types {
    Types {
        color: |_| Layout {
            bytes: true,
            alpha: true,
        },
        double: |_| true,
    }
}

fn properties(columns: &[Column<'_>]) -> String {
    let line = |c: &Column<'_>| format!("property {} {}\n", c.scalar, c.name);
    columns.iter().map(line).collect()
}

/// The properties of vertices that have a position only.
fn bare() -> String {
    properties(&vertex_columns(&[], &Attributes::default(), &fixed_types()))
}
