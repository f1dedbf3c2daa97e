//! Little-endian numbers in and out of bytes.

use crate::mesh::{Attribute, AttributeValues};

/// Takes numbers off the front of some bytes; nothing if they end before.
pub(super) struct Reader<'a>(pub &'a [u8]);

impl<'a> Reader<'a> {
    pub fn take(&mut self, bytes: usize) -> Option<&'a [u8]> {
        let (first, rest) = self.0.split_at_checked(bytes)?;
        self.0 = rest;
        Some(first)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*first)
    }

    pub fn u8(&mut self) -> Option<u8> {
        self.array::<1>().map(|[byte]| byte)
    }

    /// So many words of 16 bits.
    pub fn words<const N: usize>(&mut self) -> Option<[u16; N]> {
        let mut words = [0; N];
        for word in &mut words {
            *word = u16::from_le_bytes(self.array()?);
        }
        Some(words)
    }

    pub fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    pub fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    pub fn f64(&mut self) -> Option<f64> {
        self.array().map(f64::from_le_bytes)
    }

    /// A text of fewer than 2^32 bytes.
    pub fn text(&mut self) -> Option<String> {
        let length = self.u32()? as usize;
        String::from_utf8(self.take(length)?.to_vec()).ok()
    }

    /// So many items, each read by `one`. Memory is taken for what is there: an item has at
    /// least one byte.
    pub fn many<T>(
        &mut self,
        count: usize,
        mut one: impl FnMut(&mut Self) -> Option<T>,
    ) -> Option<Vec<T>> {
        if count > self.0.len() {
            return None;
        }
        (0..count).map(|_| one(self)).collect()
    }

    /// Triples of words.
    pub fn triples(&mut self, count: usize) -> Option<impl Iterator<Item = [u32; 3]> + 'a> {
        let bytes = self.take(count.checked_mul(12)?)?;
        let (triples, _) = bytes.as_chunks::<12>();
        Some(triples.iter().map(|bytes| {
            let (words, _) = bytes.as_chunks::<4>();
            std::array::from_fn(|i| u32::from_le_bytes(words[i]))
        }))
    }
}

/// Appends triples of words.
pub(super) fn put_triples(bytes: &mut Vec<u8>, triples: impl Iterator<Item = [u32; 3]>) {
    for triple in triples {
        bytes.extend(triple.map(u32::to_le_bytes).as_flattened());
    }
}

/// Appends a text.
pub(super) fn put_text(bytes: &mut Vec<u8>, text: &str) {
    bytes.extend((text.len() as u32).to_le_bytes());
    bytes.extend(text.as_bytes());
}

/// Name, width and type of a column.
pub(super) fn put_kind(bytes: &mut Vec<u8>, column: &Attribute) {
    put_text(bytes, &column.name);
    bytes.extend((column.components as u32).to_le_bytes());
    bytes.push(match column.values {
        AttributeValues::I8(_) => 0,
        AttributeValues::U8(_) => 1,
        AttributeValues::I16(_) => 2,
        AttributeValues::U16(_) => 3,
        AttributeValues::I32(_) => 4,
        AttributeValues::U32(_) => 5,
        AttributeValues::F32(_) => 6,
        AttributeValues::F64(_) => 7,
    });
}

/// A column without values, as [`put_kind`] has written it.
pub(super) fn kind(reader: &mut Reader<'_>) -> Option<Attribute> {
    Some(Attribute {
        name: reader.text()?,
        components: reader.u32()? as usize,
        values: match reader.u8()? {
            0 => AttributeValues::I8(Vec::new()),
            1 => AttributeValues::U8(Vec::new()),
            2 => AttributeValues::I16(Vec::new()),
            3 => AttributeValues::U16(Vec::new()),
            4 => AttributeValues::I32(Vec::new()),
            5 => AttributeValues::U32(Vec::new()),
            6 => AttributeValues::F32(Vec::new()),
            7 => AttributeValues::F64(Vec::new()),
            _ => return None,
        },
    })
}

macro_rules! values {
    ($($kind:ident $type:ident),*) => {
        /// Appends the values of the elements named.
        pub(super) fn put_values(bytes: &mut Vec<u8>, column: &Attribute, elements: &[u32]) {
            let width = column.components;
            match &column.values {
                $(AttributeValues::$kind(v) => for &e in elements {
                    let first = e as usize * width;
                    for value in &v[first..first + width] {
                        bytes.extend(value.to_le_bytes());
                    }
                })*
            }
        }

        /// Values of so many elements of this kind.
        pub(super) fn read_values(
            reader: &mut Reader<'_>,
            kind: &Attribute,
            elements: usize,
        ) -> Option<Attribute> {
            let count = elements.checked_mul(kind.components)?;
            let values = match kind.values {
                $(AttributeValues::$kind(_) => {
                    let bytes = reader.take(count.checked_mul(size_of::<$type>())?)?;
                    let (chunks, _) = bytes.as_chunks();
                    AttributeValues::$kind(chunks.iter().map(|b| $type::from_le_bytes(*b)).collect())
                })*
            };
            Some(Attribute { values, ..kind.empty_like() })
        }
    };
}

values!(I8 i8, U8 u8, I16 i16, U16 u16, I32 i32, U32 u32, F32 f32, F64 f64);
