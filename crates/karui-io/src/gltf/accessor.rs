//! Accessors: typed arrays over buffer views (glTF 2.0, section 3.6.2).

use super::{
    budget::Budget,
    document::Document,
    json::{self, At, ROOT},
};
use crate::error::{ErrorKind, Result};
use serde_json::Value;
use std::borrow::Cow;

/// Type of one component.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    /// By its number in the format.
    pub fn from_code(code: usize) -> Option<Self> {
        Some(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    /// Its number in the format.
    pub fn code(self) -> u32 {
        match self {
            Self::I8 => 5120,
            Self::U8 => 5121,
            Self::I16 => 5122,
            Self::U16 => 5123,
            Self::U32 => 5125,
            Self::F32 => 5126,
        }
    }

    /// Bytes.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }
}

/// Shape of one element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Scalar,
    Vec2,
    Vec3,
    Vec4,
    Mat2,
    Mat3,
    Mat4,
}

impl Kind {
    pub fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "SCALAR" => Self::Scalar,
            "VEC2" => Self::Vec2,
            "VEC3" => Self::Vec3,
            "VEC4" => Self::Vec4,
            "MAT2" => Self::Mat2,
            "MAT3" => Self::Mat3,
            "MAT4" => Self::Mat4,
            _ => return None,
        })
    }

    /// Its name in the format.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scalar => "SCALAR",
            Self::Vec2 => "VEC2",
            Self::Vec3 => "VEC3",
            Self::Vec4 => "VEC4",
            Self::Mat2 => "MAT2",
            Self::Mat3 => "MAT3",
            Self::Mat4 => "MAT4",
        }
    }

    /// Components an element.
    pub fn components(self) -> usize {
        match self {
            Self::Scalar => 1,
            Self::Vec2 => 2,
            Self::Vec3 => 3,
            Self::Vec4 | Self::Mat2 => 4,
            Self::Mat3 => 9,
            Self::Mat4 => 16,
        }
    }

    /// Rows of a matrix; a vector is one column.
    fn rows(self) -> usize {
        match self {
            Self::Mat2 => 2,
            Self::Mat3 => 3,
            Self::Mat4 => 4,
            other => other.components(),
        }
    }
}

/// What an array holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Layout {
    pub component: Component,
    pub kind: Kind,
    /// Integers stand for 0..1 or -1..1.
    pub normalized: bool,
}

impl Layout {
    /// Reads `componentType`, `type` and `normalized`.
    pub fn parse(accessor: &Value, at: &At<'_>) -> Result<Self> {
        let code = json::required(accessor, "componentType", at)?;
        let component = Component::from_code(code)
            .ok_or_else(|| at.syntax("a componentType of 5120 to 5126", code.to_string()))?;
        let name = json::text(accessor, "type").unwrap_or("none");
        let kind = Kind::from_name(name).ok_or_else(|| at.syntax("a type", name))?;
        let normalized = accessor.get("normalized").and_then(Value::as_bool) == Some(true);
        Ok(Self {
            component,
            kind,
            normalized,
        })
    }

    /// Bytes from one column of a matrix to the next: columns start at
    /// multiples of 4 (section 3.6.2.4).
    fn column(self) -> usize {
        self.kind.rows() * self.component.size()
    }

    fn padded_column(self) -> usize {
        match self.kind {
            Kind::Mat2 | Kind::Mat3 | Kind::Mat4 => self.column().next_multiple_of(4),
            _ => self.column(),
        }
    }

    /// Bytes of one element, padding between columns included.
    pub fn size(self) -> usize {
        let columns = self.kind.components() / self.kind.rows();
        (columns - 1) * self.padded_column() + self.column()
    }

    /// The first component of an element, not normalised; 0 if it is cut off.
    pub fn scalar(self, element: &[u8]) -> f64 {
        let word = |size: usize| {
            let mut word = [0; 4];
            let there = size.min(element.len());
            word[..there].copy_from_slice(&element[..there]);
            word
        };
        match self.component {
            Component::I8 => f64::from(word(1)[0] as i8),
            Component::U8 => f64::from(word(1)[0]),
            Component::I16 => f64::from(i16::from_le_bytes([word(2)[0], word(2)[1]])),
            Component::U16 => f64::from(u16::from_le_bytes([word(2)[0], word(2)[1]])),
            Component::U32 => f64::from(u32::from_le_bytes(word(4))),
            Component::F32 => f64::from(f32::from_le_bytes(word(4))),
        }
    }

    /// Byte offset of component `i` in an element.
    fn offset(self, i: usize) -> usize {
        let rows = self.kind.rows();
        i / rows * self.padded_column() + i % rows * self.component.size()
    }
}

/// The elements of an accessor.
pub(super) struct Elements<'a> {
    /// What they are.
    pub layout: Layout,
    /// How many.
    pub count: usize,
    bytes: Cow<'a, [u8]>,
    stride: usize,
}

impl Document {
    /// Resolves accessor `index`, which must exist.
    pub fn elements(&self, index: usize, budget: &Budget) -> Result<Elements<'_>> {
        let at = ROOT.item("accessors", index);
        let accessor = &self.json["accessors"][index];
        let layout = Layout::parse(accessor, &at)?;
        let count = json::required(accessor, "count", &at)?;
        if count == 0 {
            return Err(at.syntax("a count of at least 1", "0"));
        }
        let plain = self.plain(accessor, layout, count, &at)?;
        if plain.is_some() && accessor.get("sparse").is_none() {
            return plain.ok_or_else(|| at.syntax("elements", "none"));
        }
        budget.take(count, layout.size(), &at)?;
        let mut elements = match plain {
            Some(elements) => elements.packed(),
            None => Elements::from_bytes(layout, vec![0; count * layout.size()]),
        };
        if let Some(sparse) = accessor.get("sparse") {
            self.overlay(&mut elements, sparse, &at.key("sparse"))?;
        }
        Ok(elements)
    }

    /// Elements straight from the buffer view, if the accessor has one.
    fn plain(
        &self,
        accessor: &Value,
        layout: Layout,
        count: usize,
        at: &At<'_>,
    ) -> Result<Option<Elements<'_>>> {
        let views = self.view_count();
        let Some(view) = json::index(accessor, "bufferView", views, "bufferView", at)? else {
            return Ok(None);
        };
        let stride = self.stride(view).unwrap_or(layout.size());
        if stride < layout.size() {
            let expected = format!("a byteStride of at least {}", layout.size());
            return Err(at.syntax(expected, stride.to_string()));
        }
        let offset = json::number(accessor, "byteOffset", at)?.unwrap_or(0);
        let bytes = span(self.view(view), offset, count, stride, layout.size(), at)?;
        Ok(Some(Elements {
            layout,
            count,
            bytes: Cow::Borrowed(bytes),
            stride,
        }))
    }

    /// Replaces the elements that a sparse accessor lists.
    fn overlay(&self, elements: &mut Elements<'_>, sparse: &Value, at: &At<'_>) -> Result<()> {
        let count = json::required(sparse, "count", at)?;
        if count > elements.count {
            return Err(at.syntax(
                format!("a count of at most {}", elements.count),
                count.to_string(),
            ));
        }
        let code = Layout::parse_index_code(&sparse["indices"], &at.key("indices"))?;
        let indices = self.sparse_part(sparse, "indices", code, count, at)?;
        let values = self.sparse_part(sparse, "values", elements.layout, count, at)?;
        let size = elements.layout.size();
        let target = elements.bytes.to_mut();
        for i in 0..count {
            let index = indices.integer(i, 0) as usize;
            json::in_range(index, elements.count, "element", &at.key("indices"))?;
            target[index * size..][..size].copy_from_slice(values.element(i));
        }
        Ok(())
    }

    fn sparse_part(
        &self,
        sparse: &Value,
        key: &str,
        layout: Layout,
        count: usize,
        at: &At<'_>,
    ) -> Result<Elements<'_>> {
        let at = at.key(key);
        let part = self.plain(&sparse[key], layout, count, &at)?;
        part.ok_or_else(|| at.syntax("`bufferView`", "none"))
    }
}

/// The bytes of `count` elements of `size` bytes every `stride` bytes.
fn span<'a>(
    view: &'a [u8],
    offset: usize,
    count: usize,
    stride: usize,
    size: usize,
    at: &At<'_>,
) -> Result<&'a [u8]> {
    let length = count
        .saturating_sub(1)
        .checked_mul(stride)
        .and_then(|l| l.checked_add(if count == 0 { 0 } else { size }));
    let end = length.and_then(|l| l.checked_add(offset));
    end.and_then(|end| view.get(offset..end)).ok_or_else(|| {
        let expected = format!("{count} elements of {size} bytes from byte {offset}");
        let found = format!("a buffer view of {}", view.len());
        at.fail(ErrorKind::truncated(expected, found))
    })
}

impl Layout {
    fn parse_index_code(indices: &Value, at: &At<'_>) -> Result<Self> {
        let code = json::required(indices, "componentType", at)?;
        match Component::from_code(code) {
            Some(component @ (Component::U8 | Component::U16 | Component::U32)) => Ok(Self {
                component,
                kind: Kind::Scalar,
                normalized: false,
            }),
            _ => Err(at.syntax("unsigned integers", code.to_string())),
        }
    }
}

impl Elements<'_> {
    /// Elements one after the other in memory.
    pub fn from_bytes(layout: Layout, bytes: Vec<u8>) -> Self {
        Self {
            layout,
            count: bytes.len() / layout.size(),
            bytes: Cow::Owned(bytes),
            stride: layout.size(),
        }
    }

    /// Elements of which one starts every `stride` bytes; the last may end before.
    pub fn spaced(layout: Layout, count: usize, stride: usize, bytes: Vec<u8>) -> Self {
        Self {
            layout,
            count,
            bytes: Cow::Owned(bytes),
            stride,
        }
    }

    /// The bytes of element `i`.
    pub fn element(&self, i: usize) -> &[u8] {
        &self.bytes[i * self.stride..][..self.layout.size()]
    }

    /// A copy without gaps.
    pub fn packed(&self) -> Elements<'static> {
        let size = self.layout.size();
        let mut bytes = Vec::with_capacity(self.count * size);
        for i in 0..self.count {
            bytes.extend_from_slice(self.element(i));
        }
        Elements::from_bytes(self.layout, bytes)
    }

    /// Elements one after the other.
    pub fn into_bytes(self) -> Vec<u8> {
        if self.stride == self.layout.size() {
            return self.bytes.into_owned();
        }
        self.packed().bytes.into_owned()
    }

    fn component(&self, i: usize, c: usize) -> [u8; 4] {
        let start = i * self.stride + self.layout.offset(c);
        let size = self.layout.component.size();
        let mut word = [0; 4];
        word[..size].copy_from_slice(&self.bytes[start..start + size]);
        word
    }

    /// Component `c` of element `i` as a whole number; floats are truncated.
    pub fn integer(&self, i: usize, c: usize) -> i64 {
        let word = self.component(i, c);
        match self.layout.component {
            Component::I8 => i64::from(word[0] as i8),
            Component::U8 => i64::from(word[0]),
            Component::I16 => i64::from(i16::from_le_bytes([word[0], word[1]])),
            Component::U16 => i64::from(u16::from_le_bytes([word[0], word[1]])),
            Component::U32 => i64::from(u32::from_le_bytes(word)),
            Component::F32 => f32::from_le_bytes(word) as i64,
        }
    }

    /// Component `c` of element `i` as a number, normalised if the layout
    /// says so.
    pub fn float(&self, i: usize, c: usize) -> f32 {
        let raw = self.integer_or_float(i, c);
        if !self.layout.normalized {
            return raw;
        }
        match self.layout.component {
            Component::I8 => (raw / 127.0).max(-1.0),
            Component::U8 => raw / 255.0,
            Component::I16 => (raw / 32767.0).max(-1.0),
            Component::U16 => raw / 65535.0,
            Component::U32 => raw / 4_294_967_295.0,
            Component::F32 => raw,
        }
    }

    fn integer_or_float(&self, i: usize, c: usize) -> f32 {
        match self.layout.component {
            Component::F32 => f32::from_le_bytes(self.component(i, c)),
            _ => self.integer(i, c) as f32,
        }
    }

    /// All elements as `N` numbers each; components that are missing are
    /// taken from `default`.
    pub fn floats<const N: usize>(&self, default: [f32; N]) -> Vec<[f32; N]> {
        let there = N.min(self.layout.kind.components());
        if self.layout.component == Component::F32 && there == N {
            return (0..self.count).map(|i| self.float_words(i)).collect();
        }
        let element = |i| {
            let mut values = default;
            for (c, value) in values.iter_mut().enumerate().take(there) {
                *value = self.float(i, c);
            }
            values
        };
        (0..self.count).map(element).collect()
    }

    /// The first `N` floats of element `i`, which has at least as many. Their
    /// layout has no gaps for up to four.
    fn float_words<const N: usize>(&self, i: usize) -> [f32; N] {
        let words = self.element(i).as_chunks::<4>().0;
        std::array::from_fn(|c| f32::from_le_bytes(words[c]))
    }

    /// All scalars as indices.
    pub fn indices(&self) -> Vec<u32> {
        match self.layout.component {
            Component::U16 => self.scalars(|b| u32::from(u16::from_le_bytes(b))),
            Component::U32 => self.scalars(u32::from_le_bytes),
            _ => (0..self.count).map(|i| self.integer(i, 0) as u32).collect(),
        }
    }

    /// All scalars of `S` bytes.
    fn scalars<const S: usize>(&self, read: impl Fn([u8; S]) -> u32) -> Vec<u32> {
        let elements = self.bytes.chunks(self.stride);
        let scalars = elements.filter_map(|e| e.first_chunk::<S>());
        scalars.take(self.count).map(|s| read(*s)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout(component: Component, kind: Kind, normalized: bool) -> Layout {
        Layout {
            component,
            kind,
            normalized,
        }
    }

    #[test]
    fn matrix_columns_are_aligned() {
        // The two layouts drawn in section 3.6.2.4 of the specification.
        let mat2 = layout(Component::U8, Kind::Mat2, false);
        assert_eq!(mat2.size(), 6);
        assert_eq!([0, 1, 2, 3].map(|i| mat2.offset(i)), [0, 1, 4, 5]);
        let mat3 = layout(Component::U16, Kind::Mat3, false);
        assert_eq!(mat3.size(), 22);
        assert_eq!([2, 3, 8].map(|i| mat3.offset(i)), [4, 8, 20]);
        assert_eq!(layout(Component::F32, Kind::Mat4, false).size(), 64);
    }

    #[test]
    fn normalised_integers() {
        let bytes = vec![0, 127, 128, 129, 255];
        let signed = Elements::from_bytes(layout(Component::I8, Kind::Scalar, true), bytes.clone());
        let expected = [[0.0], [1.0], [-1.0], [-1.0], [-1.0 / 127.0]];
        assert_eq!(signed.floats([9.0]), expected);
        let unsigned = Elements::from_bytes(layout(Component::U8, Kind::Scalar, true), bytes);
        assert_eq!(unsigned.float(4, 0), 1.0);
        let wide = Elements::from_bytes(
            layout(Component::I16, Kind::Vec2, true),
            vec![0xff, 0x7f, 0x00, 0x80],
        );
        assert_eq!(wide.floats([0.0, 0.0, 7.0]), [[1.0, -1.0, 7.0]]);
    }
}
