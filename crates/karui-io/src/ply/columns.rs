//! The body of a PLY file, one typed column a property.

use super::header::{Element, Encoding, Property, Scalar, fail, too_short};
use crate::{
    Place, Warnings,
    error::{ErrorKind, Result},
    text::{Lines, Words, integer, parse, quote},
};
use karui::mesh::AttributeValues;

/// All rows of an element.
pub(crate) struct Table {
    pub columns: Vec<Column>,
    pub rows: usize,
    origin: Origin,
}

/// All values of a property.
pub(crate) struct Column {
    pub property: Property,
    pub values: AttributeValues,
    pub lengths: Lengths,
}

/// How many values a row has.
pub(crate) enum Lengths {
    /// The same in every row; 1 for a scalar.
    Fixed(usize),
    Varying(Vec<u32>),
}

impl Lengths {
    /// Values of row `row`.
    pub fn get(&self, row: usize) -> usize {
        match self {
            Self::Fixed(length) => *length,
            Self::Varying(lengths) => lengths.get(row).map_or(0, |&l| l as usize),
        }
    }

    fn push(&mut self, rows: usize, length: u32) {
        match self {
            Self::Fixed(fixed) if *fixed == length as usize && rows > 0 => {}
            Self::Fixed(_) if rows == 0 => *self = Self::Fixed(length as usize),
            Self::Fixed(fixed) => {
                let mut lengths = vec![*fixed as u32; rows];
                lengths.push(length);
                *self = Self::Varying(lengths);
            }
            Self::Varying(lengths) => lengths.push(length),
        }
    }
}

/// Where in the file the rows are.
enum Origin {
    /// Rows from which on lines follow each other, and the line of each.
    Lines(Vec<(usize, u64)>),
    /// Offset of the first row.
    Byte(usize),
}

/// Appends the values of type `$T` in `$bytes`.
macro_rules! extend {
    ($values:expr, $T:ty, $bytes:expr, $big:expr) => {{
        let (pieces, _) = $bytes.as_chunks::<{ size_of::<$T>() }>();
        if $big {
            $values.extend(pieces.iter().map(|b| <$T>::from_be_bytes(*b)));
        } else {
            $values.extend(pieces.iter().map(|b| <$T>::from_le_bytes(*b)));
        }
    }};
}

macro_rules! with_type {
    ($scalar:expr, $T:ident => $body:expr) => {
        match $scalar {
            Scalar::I8 => AttributeValues::I8({
                type $T = i8;
                $body
            }),
            Scalar::U8 => AttributeValues::U8({
                type $T = u8;
                $body
            }),
            Scalar::I16 => AttributeValues::I16({
                type $T = i16;
                $body
            }),
            Scalar::U16 => AttributeValues::U16({
                type $T = u16;
                $body
            }),
            Scalar::I32 => AttributeValues::I32({
                type $T = i32;
                $body
            }),
            Scalar::U32 => AttributeValues::U32({
                type $T = u32;
                $body
            }),
            Scalar::F32 => AttributeValues::F32({
                type $T = f32;
                $body
            }),
            Scalar::F64 => AttributeValues::F64({
                type $T = f64;
                $body
            }),
        }
    };
}

macro_rules! with_values {
    ($values:expr, $v:ident, $T:ident => $body:expr) => {
        match $values {
            AttributeValues::I8($v) => {
                type $T = i8;
                $body
            }
            AttributeValues::U8($v) => {
                type $T = u8;
                $body
            }
            AttributeValues::I16($v) => {
                type $T = i16;
                $body
            }
            AttributeValues::U16($v) => {
                type $T = u16;
                $body
            }
            AttributeValues::I32($v) => {
                type $T = i32;
                $body
            }
            AttributeValues::U32($v) => {
                type $T = u32;
                $body
            }
            AttributeValues::F32($v) => {
                type $T = f32;
                $body
            }
            AttributeValues::F64($v) => {
                type $T = f64;
                $body
            }
        }
    };
}
pub(super) use with_values;

impl Column {
    fn empty(property: &Property) -> Self {
        Self {
            property: property.clone(),
            values: with_type!(property.scalar, T => Vec::<T>::new()),
            lengths: Lengths::Fixed(1),
        }
    }

    /// Leaves a column without a name, so that it is not found again but
    /// still tells the size of a row.
    fn take(&mut self) -> Self {
        let mut left = Self::empty(&self.property);
        left.property.name.clear();
        if let Lengths::Fixed(length) = self.lengths {
            left.lengths = Lengths::Fixed(length);
        }
        std::mem::replace(self, left)
    }
}

impl Table {
    fn empty(element: &Element, origin: Origin) -> Self {
        Self {
            columns: element.properties.iter().map(Column::empty).collect(),
            rows: 0,
            origin,
        }
    }

    /// The column `name`, if it is there and has not been taken.
    pub fn get(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|c| c.property.name == name)
    }

    /// Takes the values of column `name`, if it is there.
    pub fn take(&mut self, name: &str) -> Option<Column> {
        let column = self.columns.iter_mut().find(|c| c.property.name == name)?;
        Some(column.take())
    }

    /// Takes all columns that are left.
    pub fn take_rest(&mut self) -> Vec<Column> {
        let left = |c: &&mut Column| !c.property.name.is_empty();
        self.columns
            .iter_mut()
            .filter(left)
            .map(Column::take)
            .collect()
    }

    /// Where in the file row `row` is. Exact unless lists of varying length
    /// have been taken.
    pub fn place(&self, row: usize) -> Place {
        match &self.origin {
            Origin::Lines(runs) => {
                let next = runs.partition_point(|&(first, _)| first <= row);
                let (first, line) = next.checked_sub(1).map_or((row, 0), |i| runs[i]);
                Place::Line(line + (row - first) as u64)
            }
            Origin::Byte(start) => Place::Byte((start + row_offset(&self.columns, row)) as u64),
        }
    }
}

/// Offset of a row from the start of its table.
fn row_offset(columns: &[Column], row: usize) -> usize {
    let values = |c: &Column| match &c.lengths {
        Lengths::Fixed(length) => length * row,
        Lengths::Varying(lengths) => lengths.iter().take(row).map(|&l| l as usize).sum(),
    };
    let size = |c: &Column| {
        values(c) * c.property.scalar.size() + c.property.list.map_or(0, |l| l.size() * row)
    };
    columns.iter().map(size).sum()
}

/// Reads the rows of a text body, one a line.
pub(crate) fn read_ascii(
    element: &Element,
    lines: &mut Lines<'_>,
    warnings: &mut Warnings,
) -> Result<Table> {
    let mut table = Table::empty(element, Origin::Lines(Vec::new()));
    if element.properties.is_empty() {
        return Ok(table);
    }
    let left = lines.rest().len();
    if element.count.saturating_mul(2) > left.saturating_add(1) {
        return Err(lines.fail(too_short(element, left)));
    }
    let mut runs: Vec<(usize, u64)> = Vec::new();
    while table.rows < element.count {
        let Some(line) = lines.next() else {
            let expected = format!("{} elements `{}`", element.count, element.name);
            return Err(lines.fail(ErrorKind::truncated(expected, table.rows.to_string())));
        };
        let mut words = Words::new(line);
        if words.rest().is_empty() {
            continue;
        }
        let follows = |&(row, first): &(usize, u64)| first + (table.rows - row) as u64;
        if runs.last().map(follows) != Some(lines.line) {
            runs.push((table.rows, lines.line));
        }
        row_of_words(&mut table, &mut words).map_err(|kind| lines.fail(kind))?;
        if words.next().is_some() {
            warnings.push("values beyond those the header declares were passed over");
        }
    }
    table.origin = Origin::Lines(runs);
    Ok(table)
}

fn row_of_words(table: &mut Table, words: &mut Words<'_>) -> Result<(), ErrorKind> {
    for column in &mut table.columns {
        let missing =
            || ErrorKind::syntax(format!("a value for `{}`", column.property.name), "none");
        let mut length = 1;
        if column.property.list.is_some() {
            let word = words.next().ok_or_else(missing)?;
            length = integer(word)
                .and_then(|n| u32::try_from(n).ok())
                .ok_or_else(|| ErrorKind::syntax("the length of a list", quote(word)))?;
            column.lengths.push(table.rows, length);
        }
        for _ in 0..length {
            push_word(&mut column.values, words.next().ok_or_else(missing)?)?;
        }
    }
    table.rows += 1;
    Ok(())
}

fn push_word(values: &mut AttributeValues, word: &[u8]) -> Result<(), ErrorKind> {
    let bad = || ErrorKind::syntax("a number of the declared type", quote(word));
    match values {
        AttributeValues::F32(v) => v.push(parse(word).ok_or_else(bad)?),
        AttributeValues::F64(v) => v.push(parse(word).ok_or_else(bad)?),
        AttributeValues::I8(v) => v.push(whole(word).ok_or_else(bad)?),
        AttributeValues::U8(v) => v.push(whole(word).ok_or_else(bad)?),
        AttributeValues::I16(v) => v.push(whole(word).ok_or_else(bad)?),
        AttributeValues::U16(v) => v.push(whole(word).ok_or_else(bad)?),
        AttributeValues::I32(v) => v.push(whole(word).ok_or_else(bad)?),
        AttributeValues::U32(v) => v.push(whole(word).ok_or_else(bad)?),
    }
    Ok(())
}

fn whole<T: TryFrom<i64>>(word: &[u8]) -> Option<T> {
    T::try_from(integer(word)?).ok()
}

/// A position in a binary body.
pub(crate) struct Body<'a> {
    pub bytes: &'a [u8],
    pub at: usize,
    pub encoding: Encoding,
}

impl<'a> Body<'a> {
    fn rest(&self) -> &'a [u8] {
        self.bytes.get(self.at..).unwrap_or(&[])
    }

    fn is_big(&self) -> bool {
        self.encoding == Encoding::BigEndian
    }
}

/// Reads the rows of a binary body.
pub(crate) fn read_binary(element: &Element, body: &mut Body<'_>) -> Result<Table> {
    let left = body.rest().len();
    if element.count.saturating_mul(element.least_stride()) > left {
        return fail(Place::Byte(body.at as u64), too_short(element, left));
    }
    if element.properties.is_empty() || element.count == 0 {
        return Ok(Table::empty(element, Origin::Byte(body.at)));
    }
    match regular_layout(element, body) {
        Some(layout) => Ok(read_regular(element, body, &layout)),
        None => read_irregular(element, body),
    }
}

/// Offsets and lengths of the columns in rows that are all of one size.
struct Layout {
    stride: usize,
    /// Offset of the first value and number of values of each column.
    columns: Vec<(usize, usize)>,
}

/// The layout of the first row, if all rows share it: the usual case, also for
/// faces that are all triangles.
fn regular_layout(element: &Element, body: &Body<'_>) -> Option<Layout> {
    let rest = body.rest();
    let mut columns = Vec::new();
    let mut lists = Vec::new();
    let mut at = 0;
    for property in &element.properties {
        let mut length = 1;
        if let Some(scalar) = property.list {
            length = list_length(scalar, rest.get(at..)?, body.is_big())?;
            lists.push((at, scalar.size()));
            at += scalar.size();
        }
        columns.push((at, length));
        at = at.checked_add(length.checked_mul(property.scalar.size())?)?;
    }
    let rows = rest.get(..element.count.checked_mul(at)?)?;
    let same = |&(at, size): &(usize, usize)| {
        let wanted = &rows[at..at + size];
        rows.chunks_exact(at_least_one(rows.len() / element.count))
            .all(|row| &row[at..at + size] == wanted)
    };
    lists.iter().all(same).then_some(Layout {
        stride: at,
        columns,
    })
}

fn at_least_one(n: usize) -> usize {
    n.max(1)
}

/// The length at the head of `bytes`; `None` if cut off or negative.
pub(crate) fn list_length(scalar: Scalar, bytes: &[u8], big: bool) -> Option<usize> {
    let raw = bytes.get(..scalar.size())?;
    let mut padded = [0; 8];
    if big {
        padded[8 - raw.len()..].copy_from_slice(raw);
    } else {
        padded[..raw.len()].copy_from_slice(raw);
    }
    let value = if big {
        u64::from_be_bytes(padded)
    } else {
        u64::from_le_bytes(padded)
    };
    let signed = matches!(scalar, Scalar::I8 | Scalar::I16 | Scalar::I32);
    let limit = 1u64 << (8 * scalar.size() - usize::from(signed));
    (value < limit).then_some(value as usize)
}

fn read_regular(element: &Element, body: &mut Body<'_>, layout: &Layout) -> Table {
    let mut table = Table::empty(element, Origin::Byte(body.at));
    let rows = &body.rest()[..element.count * layout.stride];
    for (column, &(offset, length)) in table.columns.iter_mut().zip(&layout.columns) {
        column.lengths = Lengths::Fixed(length);
        let size = length * column.property.scalar.size();
        let pieces = rows
            .chunks_exact(at_least_one(layout.stride))
            .map(|row| &row[offset..offset + size]);
        let big = body.is_big();
        column.values = with_type!(column.property.scalar, T => {
            let mut values = Vec::<T>::with_capacity(element.count * length);
            for piece in pieces {
                extend!(values, T, piece, big);
            }
            values
        });
    }
    table.rows = element.count;
    body.at += rows.len();
    table
}

fn read_irregular(element: &Element, body: &mut Body<'_>) -> Result<Table> {
    let mut table = Table::empty(element, Origin::Byte(body.at));
    let big = body.is_big();
    for row in 0..element.count {
        for column in &mut table.columns {
            let mut length = 1;
            if let Some(scalar) = column.property.list {
                let found = list_length(scalar, body.rest(), big);
                let Some(found) = found.filter(|&l| u32::try_from(l).is_ok()) else {
                    return fail(Place::Byte(body.at as u64), bad_length(body, scalar));
                };
                column.lengths.push(row, found as u32);
                body.at += scalar.size();
                length = found;
            }
            let size = length.saturating_mul(column.property.scalar.size());
            let Some(bytes) = body.rest().get(..size) else {
                let expected = format!("{length} values of `{}`", column.property.name);
                let found = format!("{} bytes", body.rest().len());
                let kind = ErrorKind::truncated(expected, found);
                return fail(Place::Byte(body.at as u64), kind);
            };
            with_values!(&mut column.values, v, T => extend!(v, T, bytes, big));
            body.at += size;
        }
    }
    table.rows = element.count;
    Ok(table)
}

fn bad_length(body: &Body<'_>, scalar: Scalar) -> ErrorKind {
    if body.rest().len() < scalar.size() {
        return ErrorKind::truncated("the length of a list", "the end of the file");
    }
    ErrorKind::syntax("the length of a list", "a negative number")
}
