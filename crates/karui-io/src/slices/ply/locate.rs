//! Finding the rows of the elements of a PLY file.

use super::{
    super::file::{FileAt, Window},
    rows::{KnownList, Layout, Mark, Rows},
};
use crate::{
    Place,
    error::{Error, ErrorKind, Result},
    ply::{
        columns::list_length,
        header::{Element, Encoding, too_short},
    },
    text::Words,
};

/// Most bytes between two marks, unless one row takes more.
const BETWEEN: u64 = 1 << 20;
/// Most bytes of one row.
const ROW: u64 = 256 << 20;

/// What is looked for.
pub(super) struct Wanted {
    pub element: Element,
    pub encoding: Encoding,
    /// Where the first row starts.
    pub start: Mark,
    /// Most rows between two marks.
    pub between: u64,
    /// Bytes of all that follows the element, if the header tells.
    pub rest: Option<u64>,
}

/// Finds the rows: by arithmetic if they are all of one size, else in one pass
/// that keeps a mark now and then.
pub(super) fn locate(file: &FileAt, wanted: Wanted) -> Result<Rows> {
    let Wanted {
        element,
        encoding,
        start,
        ..
    } = &wanted;
    let left = file.len.saturating_sub(start.offset);
    let least = match encoding {
        Encoding::Ascii if element.properties.is_empty() => 0,
        // A value and the end of the line, which the last may lack.
        Encoding::Ascii => (element.count as u64).saturating_mul(2).saturating_sub(1),
        _ => (element.count as u64).saturating_mul(element.least_stride() as u64),
    };
    if least > left {
        let kind = too_short(element, left as usize);
        return Err(Error::new(place(*start, *encoding), kind));
    }
    match fixed(file, &wanted)? {
        Some((stride, list)) => Ok(wanted.fixed(stride, list)),
        None => scan(file, wanted),
    }
}

impl Wanted {
    fn fixed(self, stride: u64, list: Option<KnownList>) -> Rows {
        let rows = self.element.count as u64;
        let start = self.start.offset;
        let end = Mark {
            row: rows,
            offset: start + stride * rows,
            ..self.start
        };
        Rows {
            element: self.element,
            encoding: self.encoding,
            layout: Layout::Fixed {
                start,
                stride,
                list,
            },
            end,
        }
    }
}

/// The size of a row if it is the same for all.
fn fixed(file: &FileAt, wanted: &Wanted) -> Result<Option<(u64, Option<KnownList>)>> {
    let element = &wanted.element;
    if element.properties.is_empty() || element.count == 0 {
        return Ok(Some((0, None)));
    }
    if wanted.encoding == Encoding::Ascii {
        return Ok(None);
    }
    match size(element) {
        Some(stride) => Ok(Some((stride, None))),
        None => triangles(file, wanted),
    }
}

/// Bytes of a row without lists.
pub(super) fn size(element: &Element) -> Option<u64> {
    let lists = element.properties.iter().any(|p| p.list.is_some());
    (!lists).then(|| element.least_stride() as u64)
}

/// The size of a row if it has one list, which is of three values in the first
/// row, and the file has just the size that follows if it is so in all others.
/// It would have that size, too, if every list that is longer were made up for by
/// one of fewer than three corners; reading then ends with an error.
fn triangles(file: &FileAt, wanted: &Wanted) -> Result<Option<(u64, Option<KnownList>)>> {
    let properties = &wanted.element.properties;
    let mut lists = properties.iter().filter(|p| p.list.is_some());
    let (Some(list), None, Some(rest)) = (lists.next(), lists.next(), wanted.rest) else {
        return Ok(None);
    };
    let Some(length) = list.list else {
        return Ok(None);
    };
    let before = properties.iter().take_while(|p| p.list.is_none());
    let offset: usize = before.map(|p| p.scalar.size()).sum();
    let known = KnownList {
        offset,
        size: length.size(),
    };
    let at = wanted.start.offset + offset as u64;
    let mut window = Window::new(file);
    let first = window.get(at, length.size())?;
    let is_big = wanted.encoding == Encoding::BigEndian;
    let stride = wanted.element.least_stride() + 3 * list.scalar.size();
    let total = (wanted.element.count as u64).saturating_mul(stride as u64);
    let end = wanted.start.offset.saturating_add(total);
    let proven =
        list_length(length, first, is_big) == Some(3) && end.saturating_add(rest) == file.len;
    Ok(proven.then_some((stride as u64, Some(known))))
}

/// Passes over all rows.
fn scan(file: &FileAt, wanted: Wanted) -> Result<Rows> {
    let mut window = Window::new(file);
    let mut at = wanted.start;
    let mut marks: Vec<Mark> = Vec::new();
    while at.row < wanted.element.count as u64 {
        let due = |m: &Mark| at.row - m.row >= wanted.between || at.offset - m.offset >= BETWEEN;
        if marks.last().is_none_or(due) {
            marks.push(at);
        }
        let next = match wanted.encoding {
            Encoding::Ascii => after_line(&mut window, at, &wanted.element)?,
            _ => after_row(&mut window, at, &wanted, file.len)?,
        };
        if next.offset - at.offset > ROW {
            return Err(too_large(at, &wanted, next.offset - at.offset));
        }
        at = next;
    }
    Ok(Rows {
        element: wanted.element,
        encoding: wanted.encoding,
        layout: Layout::Marked(marks),
        end: at,
    })
}

/// Where the row after the one at `at` starts in a text file.
fn after_line(window: &mut Window<'_>, mut at: Mark, element: &Element) -> Result<Mark> {
    loop {
        let Some((line, next)) = window.line(at.offset)? else {
            let expected = format!("{} elements `{}`", element.count, element.name);
            let kind = ErrorKind::truncated(expected, at.row.to_string());
            return Err(Error::new(Place::Line(at.line), kind));
        };
        let blank = Words::new(line).rest().is_empty();
        (at.offset, at.line) = (next, at.line + 1);
        if !blank {
            at.row += 1;
            return Ok(at);
        }
    }
}

/// Where the row after the one at `at` starts in a binary file.
fn after_row(window: &mut Window<'_>, at: Mark, wanted: &Wanted, len: u64) -> Result<Mark> {
    let is_big = wanted.encoding == Encoding::BigEndian;
    let mut offset = at.offset;
    for property in &wanted.element.properties {
        let mut values = 1;
        if let Some(scalar) = property.list {
            let head = window.get(offset, scalar.size())?;
            let Some(found) = list_length(scalar, head, is_big) else {
                let kind = if head.len() < scalar.size() {
                    ErrorKind::truncated("the length of a list", "the end of the file")
                } else {
                    ErrorKind::syntax("the length of a list", "a negative number")
                };
                return Err(Error::new(Place::Byte(offset), kind));
            };
            offset += scalar.size() as u64;
            values = found as u64;
        }
        let size = values.saturating_mul(property.scalar.size() as u64);
        if size > len.saturating_sub(offset) {
            let expected = format!("{values} values of `{}`", property.name);
            let found = format!("{} bytes", len.saturating_sub(offset));
            let kind = ErrorKind::truncated(expected, found);
            return Err(Error::new(Place::Byte(offset), kind));
        }
        offset += size;
    }
    Ok(Mark {
        row: at.row + 1,
        offset,
        line: 0,
    })
}

fn too_large(at: Mark, wanted: &Wanted, found: u64) -> Error {
    let kind = ErrorKind::TooLarge {
        what: "size of one row in bytes",
        found,
        limit: ROW,
    };
    Error::new(place(at, wanted.encoding), kind)
}

fn place(at: Mark, encoding: Encoding) -> Place {
    match encoding {
        Encoding::Ascii => Place::Line(at.line),
        _ => Place::Byte(at.offset),
    }
}
