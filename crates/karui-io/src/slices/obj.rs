//! OBJ in slices: a vertex is a position.
//!
//! Texture coordinates and normals have indices of their own, so that a vertex of what
//! [`crate::read`] makes of them is known only when every corner of the file is. They are
//! left aside here, with a warning; positions keep their numbers, and colours of vertices
//! are carried. Materials and groups are left aside as in every slice.

use super::{
    cut::cut,
    failed,
    file::{FileAt, Window},
};
use crate::{
    Place,
    error::{Error, ErrorKind, Result},
    obj::read::{at_least, joined, numbers, out_of_range, scale},
    text::{Lines, Words, integer, quote},
    warnings::Warnings,
};
use karui::{
    geom::{Vec3, Vec4},
    mesh::Attributes,
    outofcore::{self, Source, Vertices},
};
use std::{borrow::Cow, ops::Range};

/// Bytes of a portion, unless one line takes more.
const PORTION: u64 = 1 << 20;
/// Numbers of a vertex that are looked at: place and colour.
const NUMBERS: usize = 7;

/// An OBJ file.
#[derive(Debug)]
pub(super) struct Obj {
    file: FileAt,
    /// Where portions start, and the end.
    marks: Vec<Mark>,
    /// Portions that hold faces.
    faces: Vec<usize>,
    /// What the colours are divided by, if vertices have some.
    colors: Option<f32>,
}

/// The start of a portion.
#[derive(Debug, Clone, Copy, Default)]
struct Mark {
    /// Offset into the file, bytes.
    offset: u64,
    /// Lines before it.
    line: u64,
    /// Vertices before it.
    vertices: u64,
}

/// What one pass over the file finds out.
#[derive(Default)]
struct Scan {
    at: Mark,
    marks: Vec<Mark>,
    faces: Vec<usize>,
    has_colors: bool,
    /// Largest red, green or blue.
    brightest: f32,
    /// The first statement that was not understood, with its line.
    unknown: Option<(String, u64)>,
    told: Vec<&'static str>,
}

/// Passes over the file once and keeps a mark every mebibyte.
pub(super) fn open(file: FileAt, warnings: &mut Warnings) -> Result<Obj> {
    if file.len == 0 {
        let kind = ErrorKind::truncated("an OBJ model", "an empty file");
        return Err(Error::new(Place::File, kind));
    }
    let mut scan = Scan::default();
    let mut window = Window::new(&file);
    while let Some((line, next)) = window.line(scan.at.offset)? {
        let number = scan.at.line + 1;
        scan.start_portion();
        let continues = logical(line).1;
        let result = scan.statement(logical(line).0, number);
        result.map_err(|kind| Error::new(Place::Line(number), kind))?;
        (scan.at.offset, scan.at.line) = (next, number);
        if continues {
            scan.pass_over_rest(&mut window)?;
        }
    }
    scan.finish(file, warnings)
}

/// A line without its end, and whether it goes on in the next.
fn logical(line: &[u8]) -> (&[u8], bool) {
    let line = line.strip_suffix(b"\r").unwrap_or(line);
    match line.strip_suffix(b"\\") {
        Some(start) => (start, true),
        None => (line, false),
    }
}

impl Scan {
    fn start_portion(&mut self) {
        let due = |m: &Mark| self.at.offset - m.offset >= PORTION;
        if self.marks.last().is_none_or(due) {
            self.marks.push(self.at);
        }
    }

    /// The lines that a statement goes on in hold no statement of their own.
    fn pass_over_rest(&mut self, window: &mut Window<'_>) -> Result<()> {
        while let Some((line, next)) = window.line(self.at.offset)? {
            let continues = logical(line).1;
            (self.at.offset, self.at.line) = (next, self.at.line + 1);
            if !continues {
                break;
            }
        }
        Ok(())
    }

    fn tell(&mut self, message: &'static str) {
        if !self.told.contains(&message) {
            self.told.push(message);
        }
    }

    fn statement(&mut self, line: &[u8], number: u64) -> Result<(), ErrorKind> {
        let mut words = Words::new(line);
        match words.next() {
            Some(b"v") => self.vertex(words)?,
            Some(b"f" | b"fo") => {
                let portion = self.marks.len() - 1;
                if self.faces.last() != Some(&portion) {
                    self.faces.push(portion);
                }
            }
            Some(b"vt") => self.tell("texture coordinates were left aside"),
            Some(b"vn") => self.tell("normals were left aside"),
            Some(b"usemtl") => self.tell("materials were left aside"),
            Some(b"l" | b"p") => self.tell("lines and points were passed over"),
            Some(b"curv" | b"curv2" | b"surf" | b"cstype") => {
                self.tell("free-form curves and surfaces were passed over");
            }
            None | Some(b"mtllib" | b"o" | b"g" | b"s" | b"t" | b"mg" | b"lod" | b"vp") => {}
            Some(word) if word.starts_with(b"#") => {}
            Some(word) if self.unknown.is_none() => self.unknown = Some((quote(word), number)),
            Some(_) => {}
        }
        Ok(())
    }

    /// Counts a vertex, and looks at its colour if it has one.
    fn vertex(&mut self, words: Words<'_>) -> Result<(), ErrorKind> {
        self.at.vertices += 1;
        if words.clone().count() < 6 {
            return Ok(());
        }
        let mut values = [0.0; NUMBERS];
        if numbers(words, &mut values, "vertex coordinate")? >= 6 {
            self.has_colors = true;
            let color = values[3].max(values[4]).max(values[5]);
            self.brightest = self.brightest.max(color);
        }
        Ok(())
    }

    fn finish(mut self, file: FileAt, warnings: &mut Warnings) -> Result<Obj> {
        if let Some((word, line)) = self.unknown {
            if self.at.vertices == 0 {
                let kind = ErrorKind::syntax("an OBJ statement", word);
                return Err(Error::new(Place::Line(line), kind));
            }
            warnings.push(format!(
                "statements such as {word} (line {line}) were passed over"
            ));
        }
        self.told.iter().for_each(|&message| warnings.push(message));
        if self.faces.is_empty() {
            warnings.push("the file holds no faces");
        }
        self.marks.push(self.at);
        Ok(Obj {
            file,
            marks: self.marks,
            faces: self.faces,
            colors: self.has_colors.then(|| scale(self.brightest)),
        })
    }
}

impl Obj {
    fn count(&self) -> u64 {
        self.marks.last().map_or(0, |m| m.vertices)
    }

    /// Calls `each` with the statements of portion `i` and the number of vertices before
    /// each; errors get their line.
    fn statements(
        &self,
        i: usize,
        mut each: impl FnMut(Words<'_>, u64) -> Result<(), ErrorKind>,
    ) -> Result<()> {
        let Some(&[from, end]) = self.marks.get(i..i + 2).and_then(|m| m.first_chunk()) else {
            return Ok(());
        };
        let bytes = self.file.read(from.offset, end.offset - from.offset)?;
        let mut lines = Lines::new(&bytes);
        let mut vertices = from.vertices;
        while let Some(line) = lines.next() {
            let first = from.line + lines.line;
            let line: Cow<'_, [u8]> = joined(line, &mut lines);
            let words = Words::new(&line);
            let is_vertex = words.clone().next() == Some(b"v");
            each(words, vertices).map_err(|kind| Error::new(Place::Line(first), kind))?;
            vertices += u64::from(is_vertex);
        }
        Ok(())
    }

    fn slice(&self, ids: Range<u64>) -> Result<Vertices> {
        let end = ids.end.min(self.count());
        let ids = ids.start.min(end)..end;
        let mut positions = Vec::new();
        let mut colors = Vec::new();
        let first = self.marks.partition_point(|m| m.vertices <= ids.start);
        let mut portion = first.saturating_sub(1);
        while portion + 1 < self.marks.len() && self.marks[portion].vertices < ids.end {
            // A portion of faces only need not be read.
            if self.marks[portion].vertices < self.marks[portion + 1].vertices {
                self.statements(portion, |mut words, number| {
                    if words.next() == Some(b"v") && ids.contains(&number) {
                        let (position, color) = self.vertex(words)?;
                        positions.push(position);
                        colors.extend(color);
                    }
                    Ok(())
                })?;
            }
            portion += 1;
        }
        Ok(Vertices {
            positions,
            attributes: Attributes {
                colors: self.colors.map(|_| colors).into_iter().collect(),
                ..Attributes::default()
            },
        })
    }

    fn vertex(&self, words: Words<'_>) -> Result<(Vec3, Option<Vec4>), ErrorKind> {
        let mut values = [f32::NAN; NUMBERS];
        let found = numbers(words, &mut values, "vertex coordinate")?;
        at_least(3, found)?;
        let [x, y, z, r, g, b, a] = values;
        let color = |scale: f32| match found {
            6 => Vec4::new(r / scale, g / scale, b / scale, 1.0),
            7 => Vec4::new(r / scale, g / scale, b / scale, a),
            _ => Vec4::ONE,
        };
        Ok((Vec3::new(x, y, z), self.colors.map(color)))
    }

    fn triangles(&self, portion: u64) -> Result<Vec<[u64; 3]>> {
        let Some(&portion) = self.faces.get(portion as usize) else {
            return Ok(Vec::new());
        };
        let count = self.count();
        let (mut indices, mut lengths) = (Vec::new(), Vec::new());
        self.statements(portion, |mut words, before| {
            if !matches!(words.next(), Some(b"f" | b"fo")) {
                return Ok(());
            }
            let start = indices.len();
            for word in words.take_while(|w| !w.starts_with(b"#")) {
                indices.push(position_of(word, before, count)?);
            }
            if indices.len() - start < 3 {
                indices.truncate(start);
            } else {
                lengths.push(indices.len() - start);
            }
            Ok(())
        })?;
        cut(&indices, &lengths, |ids| Ok(self.slice(ids)?.positions))
    }
}

/// The position that a corner `v`, `v/vt`, `v//vn` or `v/vt/vn` names, when `before`
/// vertices of `count` have been read.
fn position_of(word: &[u8], before: u64, count: u64) -> Result<u64, ErrorKind> {
    let mut parts = word.split(|&b| b == b'/');
    let first = parts.next().unwrap_or_default();
    let bad = || ErrorKind::syntax("a vertex index", quote(word));
    let index = integer(first).ok_or_else(bad)?;
    let others = parts.clone().count();
    if others > 2 {
        return Err(ErrorKind::syntax("at most v/vt/vn", quote(word)));
    }
    if parts.any(|part| !part.is_empty() && integer(part).is_none()) {
        return Err(bad());
    }
    let absolute = if index < 0 {
        before as i64 + index
    } else {
        index - 1
    };
    let found = u64::try_from(absolute).ok().filter(|&v| v < count);
    found.ok_or_else(|| out_of_range(0, index, count as usize))
}

impl Source for Obj {
    fn vertices(&self) -> u64 {
        self.count()
    }

    fn chunks(&self) -> u64 {
        self.faces.len() as u64
    }

    fn read_vertices(&self, ids: Range<u64>) -> outofcore::Result<Vertices> {
        self.slice(ids).map_err(|e| failed(e, &self.file))
    }

    fn read_triangles(&self, chunk: u64) -> outofcore::Result<Vec<[u64; 3]>> {
        self.triangles(chunk).map_err(|e| failed(e, &self.file))
    }
}
