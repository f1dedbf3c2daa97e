//! PLY in slices: text, little and big endian.
//!
//! Vertices carry what [`crate::read`] finds, but for lists; faces of any size become the
//! same triangles in the same order. Triangle strips cannot be read in slices.

mod locate;
mod rows;

use super::{cut::cut, failed, file::FileAt};
use crate::{
    Place,
    error::{Error, ErrorKind, Result},
    ply::{
        columns::{Column, Table},
        faces::{take_corners, to_u32},
        header::{self, Element, Encoding, Header},
        vertices,
    },
    text::Lines,
    warnings::Warnings,
};
use karui::outofcore::{self, Source, Vertices};
use locate::{Wanted, locate, size};
use rows::{Mark, Rows};
use std::ops::Range;

/// Faces of a portion at most.
const FACES: u64 = 65_536;
/// Vertices between two marks at most.
const VERTICES: u64 = 4096;
/// Bytes of the file that are searched for the end of the header at most.
const HEADER: u64 = 16 << 20;

/// A PLY file.
#[derive(Debug)]
pub(super) struct Ply {
    file: FileAt,
    vertices: Rows,
    faces: Option<Rows>,
}

/// Finds vertices and faces; what is passed over becomes a warning.
pub(super) fn open(file: FileAt, warnings: &mut Warnings) -> Result<Ply> {
    let (header, start) = read_header(&file)?;
    let (vertices, faces) = find(&file, header, start, warnings)?;
    let Some(vertices) = vertices else {
        let kind = ErrorKind::syntax("an element `vertex`", "none");
        return Err(Error::new(Place::File, kind));
    };
    let ply = Ply {
        file,
        vertices,
        faces,
    };
    ply.check(warnings)?;
    Ok(ply)
}

/// The header and where the body starts.
fn read_header(file: &FileAt) -> Result<(Header, Mark)> {
    let mut size = 1 << 16;
    loop {
        let bytes = file.read(0, file.len.min(size))?;
        let mut lines = Lines::new(&bytes);
        let header = header::read(&mut lines);
        let rest = lines.rest().len();
        // Cut off in the middle, a header may look finished or wrong.
        if (header.is_ok() && rest > 0) || bytes.len() as u64 == file.len || size > HEADER {
            let start = Mark {
                row: 0,
                offset: (bytes.len() - rest) as u64,
                line: lines.line,
            };
            return Ok((header?, start));
        }
        size *= 4;
    }
}

/// The rows of the vertices and of the faces.
fn find(
    file: &FileAt,
    header: Header,
    mut start: Mark,
    warnings: &mut Warnings,
) -> Result<(Option<Rows>, Option<Rows>)> {
    let (mut vertices, mut faces) = (None, None);
    let encoding = header.encoding;
    let mut elements = header.elements.into_iter();
    while let Some(element) = elements.next() {
        let name = element.name.clone();
        let is_vertex = name == "vertex" && vertices.is_none();
        let is_face = name == "face" && element.count > 0 && faces.is_none();
        let wanted = Wanted {
            rest: rest(elements.as_slice(), encoding),
            between: if is_vertex { VERTICES } else { FACES },
            element,
            encoding,
            start,
        };
        let rows = locate(file, wanted)?;
        start = Mark { row: 0, ..rows.end };
        match name.as_str() {
            _ if is_vertex => vertices = Some(rows),
            _ if is_face => faces = Some(rows),
            "face" if rows.count() == 0 => {}
            "tristrips" => {
                let feature = "a PLY of triangle strips in slices";
                return Err(Error::new(Place::File, ErrorKind::unsupported(feature)));
            }
            _ => warnings.push(format!("element `{name}` was passed over")),
        }
    }
    Ok((vertices, faces))
}

/// Bytes of elements, if no row has a list or is text.
fn rest(elements: &[Element], encoding: Encoding) -> Option<u64> {
    if encoding == Encoding::Ascii {
        return None;
    }
    let total = |e: &Element| size(e)?.checked_mul(e.count as u64);
    elements
        .iter()
        .try_fold(0u64, |sum, e| sum.checked_add(total(e)?))
}

impl Ply {
    /// Whether the header names what is needed.
    fn check(&self, warnings: &mut Warnings) -> Result<()> {
        self.vertices.read(&self.file, 0..0, |mut table| {
            for name in drop_lists(&mut table) {
                warnings.push(format!("lists `{name}` were passed over"));
            }
            vertices::build(table, &mut |w| warnings.push(w))
        })?;
        match &self.faces {
            None => warnings.push("the file holds points but no faces"),
            Some(faces) => faces.read(&self.file, 0..0, |mut table| {
                take_corners(&mut table, 0, false)?;
                if table.take_rest().is_empty() {
                    return Ok(());
                }
                warnings.push("properties of faces were passed over");
                Ok(())
            })?,
        }
        Ok(())
    }

    fn slice(&self, ids: Range<u64>) -> Result<Vertices> {
        let end = ids.end.min(self.vertices.count());
        let rows = ids.start.min(end)..end;
        self.vertices.read(&self.file, rows, |mut table| {
            drop_lists(&mut table);
            // Told when the file was opened.
            let (positions, attributes) = vertices::build(table, &mut |_| {})?;
            Ok(Vertices {
                positions,
                attributes,
            })
        })
    }

    fn triangles(&self, portion: u64) -> Result<Vec<[u64; 3]>> {
        let Some(faces) = &self.faces else {
            return Ok(Vec::new());
        };
        let rows = faces.portion(portion, FACES);
        let count = (rows.end - rows.start) as usize;
        let corners = faces.read(&self.file, rows, |mut table| {
            take_corners(&mut table, self.vertices.count() as usize, false)
        })?;
        let Column {
            values, lengths, ..
        } = corners;
        let indices: Vec<u64> = to_u32(values).into_iter().map(u64::from).collect();
        let lengths: Vec<usize> = (0..count).map(|row| lengths.get(row)).collect();
        cut(&indices, &lengths, |ids| Ok(self.slice(ids)?.positions))
    }
}

/// Leaves out lists, whose length could differ from slice to slice, and names them.
fn drop_lists(table: &mut Table) -> Vec<String> {
    let is_list = |c: &&Column| c.property.list.is_some() && !c.property.name.is_empty();
    let lists = table.columns.iter().filter(is_list);
    let names: Vec<String> = lists.map(|c| c.property.name.clone()).collect();
    names.iter().for_each(|name| drop(table.take(name)));
    names
}

impl Source for Ply {
    fn vertices(&self) -> u64 {
        self.vertices.count()
    }

    fn chunks(&self) -> u64 {
        self.faces.as_ref().map_or(0, |f| f.portions(FACES))
    }

    fn read_vertices(&self, ids: Range<u64>) -> outofcore::Result<Vertices> {
        self.slice(ids).map_err(|e| failed(e, &self.file))
    }

    fn read_triangles(&self, chunk: u64) -> outofcore::Result<Vec<[u64; 3]>> {
        self.triangles(chunk).map_err(|e| failed(e, &self.file))
    }
}
