//! The header of a PLY file.

use crate::{
    error::{Error, ErrorKind, Result},
    text::{Lines, Words, integer, name, quote},
};

/// Elements and properties accepted; a real file has a few dozen (splats about
/// sixty).
const MOST: usize = 10_000;

/// How the body is encoded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// Type of a scalar.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn from_name(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    /// Size in a binary body, bytes.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    pub fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }
}

/// A property of an element.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Property {
    pub name: String,
    /// Type of the value, or of the items of a list.
    pub scalar: Scalar,
    /// Type of the length if it is a list.
    pub list: Option<Scalar>,
}

impl Property {
    /// Least size in a binary body, bytes.
    fn least_size(&self) -> usize {
        self.list.unwrap_or(self.scalar).size()
    }
}

/// A table of the body.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Element {
    pub name: String,
    pub count: usize,
    pub properties: Vec<Property>,
}

impl Element {
    /// Least size of one row in a binary body.
    pub fn least_stride(&self) -> usize {
        self.properties.iter().map(Property::least_size).sum()
    }
}

/// What the header says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
}

/// Reads the header; `lines` is left at the first line of the body.
pub(crate) fn read(lines: &mut Lines<'_>) -> Result<Header> {
    if lines.next().map(<[u8]>::trim_ascii) != Some(b"ply") {
        return Err(lines.fail(ErrorKind::syntax("`ply`", "something else")));
    }
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut properties = 0;
    while let Some(line) = lines.next() {
        let mut words = Words::new(line);
        match words.next() {
            Some(b"format") => encoding = Some(format(&mut words, lines)?),
            Some(b"element") => elements.push(element(&mut words, lines)?),
            Some(b"property") => {
                let Some(element) = elements.last_mut() else {
                    let kind = ErrorKind::syntax("`element` first", "`property`");
                    return Err(lines.fail(kind));
                };
                element.properties.push(property(&mut words, lines)?);
                properties += 1;
            }
            Some(b"end_header") => return finish(encoding, elements, lines),
            None | Some(b"comment" | b"obj_info") => {}
            Some(word) => {
                let expected = "`element`, `property` or `end_header`";
                return Err(lines.fail(ErrorKind::syntax(expected, quote(word))));
            }
        }
        limit(elements.len() + properties, lines)?;
    }
    Err(lines.fail(ErrorKind::truncated("`end_header`", "the end of the file")))
}

fn limit(found: usize, lines: &Lines<'_>) -> Result<()> {
    if found <= MOST {
        return Ok(());
    }
    Err(lines.fail(ErrorKind::TooLarge {
        what: "elements and properties",
        found: found as u64,
        limit: MOST as u64,
    }))
}

fn finish(encoding: Option<Encoding>, elements: Vec<Element>, lines: &Lines<'_>) -> Result<Header> {
    let missing = || lines.fail(ErrorKind::syntax("a `format` line", "none"));
    Ok(Header {
        encoding: encoding.ok_or_else(missing)?,
        elements,
    })
}

fn format(words: &mut Words<'_>, lines: &Lines<'_>) -> Result<Encoding> {
    let word = words.next().unwrap_or_default();
    let version = words.next().unwrap_or_default();
    if version != b"1.0" {
        let kind = ErrorKind::unsupported(format!("PLY version {}", quote(version)));
        return Err(lines.fail(kind));
    }
    match word {
        b"ascii" => Ok(Encoding::Ascii),
        b"binary_little_endian" => Ok(Encoding::LittleEndian),
        b"binary_big_endian" => Ok(Encoding::BigEndian),
        _ => {
            let expected = "`ascii`, `binary_little_endian` or `binary_big_endian`";
            Err(lines.fail(ErrorKind::syntax(expected, quote(word))))
        }
    }
}

fn element(words: &mut Words<'_>, lines: &Lines<'_>) -> Result<Element> {
    let title = words.next().unwrap_or_default();
    let word = words.next().unwrap_or_default();
    let count = integer(word).and_then(|n| usize::try_from(n).ok());
    let Some(count) = count else {
        return Err(lines.fail(ErrorKind::syntax("the number of elements", quote(word))));
    };
    Ok(Element {
        name: name(title),
        count,
        properties: Vec::new(),
    })
}

fn property(words: &mut Words<'_>, lines: &Lines<'_>) -> Result<Property> {
    let scalar = |words: &mut Words<'_>| {
        let word = words.next().unwrap_or_default();
        let fail = || lines.fail(ErrorKind::syntax("a type", quote(word)));
        Scalar::from_name(word).ok_or_else(fail)
    };
    let mut ahead = words.clone();
    let list = if ahead.next() == Some(b"list") {
        *words = ahead;
        let length = scalar(words)?;
        if length.is_float() {
            let kind = ErrorKind::syntax("a list length of whole numbers", "a fraction type");
            return Err(lines.fail(kind));
        }
        Some(length)
    } else {
        None
    };
    let scalar = scalar(words)?;
    let Some(title) = words.next() else {
        return Err(lines.fail(ErrorKind::syntax("the name of the property", "none")));
    };
    Ok(Property {
        name: name(title),
        scalar,
        list,
    })
}

/// Not enough bytes for what the header promises.
pub(crate) fn too_short(element: &Element, found: usize) -> ErrorKind {
    let expected = format!("{} elements `{}`", element.count, element.name);
    ErrorKind::truncated(expected, format!("{found} bytes"))
}

/// An error of the body, at `place`.
pub(super) fn fail<T>(place: crate::Place, kind: ErrorKind) -> Result<T> {
    Err(Error::new(place, kind))
}
