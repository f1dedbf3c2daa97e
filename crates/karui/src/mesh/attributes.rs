//! What a vertex carries besides its position.

use glam::{Vec2, Vec3, Vec4};

/// Per-vertex attributes, structure of arrays. Every array that is present has
/// one entry a vertex.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Attributes {
    /// Unit normals.
    pub normals: Option<Vec<Vec3>>,
    /// Unit tangents in xyz, handedness (+1 or -1) in w, as in glTF.
    pub tangents: Option<Vec<Vec4>>,
    /// UV sets, `TEXCOORD_0` first; v grows downwards as in glTF.
    pub uvs: Vec<Vec<Vec2>>,
    /// Colour sets, `COLOR_0` first; linear RGBA, 1 is full.
    pub colors: Vec<Vec<Vec4>>,
    /// Skin sets, `JOINTS_0` / `WEIGHTS_0` first.
    pub skins: Vec<Vec<SkinWeights>>,
    /// Morph targets, as differences to the base.
    pub morphs: Vec<MorphTarget>,
    /// Any further named values, e.g. PLY properties or glTF `_NAME` attributes.
    pub custom: Vec<Attribute>,
}

/// The four joints that move a vertex and how much each does.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SkinWeights {
    /// Indices into the skin's joint list.
    pub joints: [u16; 4],
    /// Shares; they sum to 1 over all sets of a vertex.
    pub weights: [f32; 4],
}

/// One morph target (blend shape): per-vertex differences.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MorphTarget {
    /// Position differences, model units.
    pub positions: Option<Vec<Vec3>>,
    /// Normal differences.
    pub normals: Option<Vec<Vec3>>,
    /// Tangent differences (handedness does not morph).
    pub tangents: Option<Vec<Vec3>>,
}

/// A named array with `components` values an element.
#[derive(Debug, Clone, PartialEq)]
pub struct Attribute {
    /// Name as in the file, e.g. `confidence` or `_BATCHID`.
    pub name: String,
    /// Values an element, at least 1.
    pub components: usize,
    /// `components` x elements values, element after element.
    pub values: AttributeValues,
}

/// Values in the type of the file they came from.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs, reason = "variants are named after the type they hold")]
pub enum AttributeValues {
    I8(Vec<i8>),
    U8(Vec<u8>),
    I16(Vec<i16>),
    U16(Vec<u16>),
    I32(Vec<i32>),
    U32(Vec<u32>),
    F32(Vec<f32>),
    F64(Vec<f64>),
}

macro_rules! for_values {
    ($values:expr, $v:ident => $body:expr) => {
        match $values {
            AttributeValues::I8($v) => $body,
            AttributeValues::U8($v) => $body,
            AttributeValues::I16($v) => $body,
            AttributeValues::U16($v) => $body,
            AttributeValues::I32($v) => $body,
            AttributeValues::U32($v) => $body,
            AttributeValues::F32($v) => $body,
            AttributeValues::F64($v) => $body,
        }
    };
}

impl AttributeValues {
    /// No values of the same type.
    #[must_use]
    pub fn empty_like(&self) -> Self {
        match self {
            Self::I8(_) => Self::I8(Vec::new()),
            Self::U8(_) => Self::U8(Vec::new()),
            Self::I16(_) => Self::I16(Vec::new()),
            Self::U16(_) => Self::U16(Vec::new()),
            Self::I32(_) => Self::I32(Vec::new()),
            Self::U32(_) => Self::U32(Vec::new()),
            Self::F32(_) => Self::F32(Vec::new()),
            Self::F64(_) => Self::F64(Vec::new()),
        }
    }

    /// Appends values of the same type; those of another type are dropped.
    pub(crate) fn append(&mut self, other: Self) {
        match (self, other) {
            (Self::I8(to), Self::I8(from)) => to.extend(from),
            (Self::U8(to), Self::U8(from)) => to.extend(from),
            (Self::I16(to), Self::I16(from)) => to.extend(from),
            (Self::U16(to), Self::U16(from)) => to.extend(from),
            (Self::I32(to), Self::I32(from)) => to.extend(from),
            (Self::U32(to), Self::U32(from)) => to.extend(from),
            (Self::F32(to), Self::F32(from)) => to.extend(from),
            (Self::F64(to), Self::F64(from)) => to.extend(from),
            _ => {}
        }
    }

    /// Number of scalar values.
    #[must_use]
    pub fn len(&self) -> usize {
        for_values!(self, v => v.len())
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Bytes of memory that they take.
    #[must_use]
    pub fn memory(&self) -> usize {
        for_values!(self, v => size_of_val(&v[..]))
    }

    fn gathered(&self, components: usize, sources: &[u32]) -> Self {
        macro_rules! same_type {
            ($($kind:ident)*) => {
                match self {
                    $(Self::$kind(v) => Self::$kind(gather_wide(v, components, sources)),)*
                }
            };
        }
        same_type!(I8 U8 I16 U16 I32 U32 F32 F64)
    }
}

fn gather_wide<T: Copy>(values: &[T], components: usize, sources: &[u32]) -> Vec<T> {
    let element = |&s: &u32| {
        let first = s as usize * components;
        values[first..first + components].iter().copied()
    };
    sources.iter().flat_map(element).collect()
}

impl Attribute {
    /// Cuts off or fills up with zeros.
    pub(crate) fn resize(&mut self, elements: usize) {
        let len = elements * self.components;
        for_values!(&mut self.values, v => v.resize(len, Default::default()));
    }

    /// The same name, width and type, without values.
    #[must_use]
    pub fn empty_like(&self) -> Self {
        Self {
            name: self.name.clone(),
            components: self.components,
            values: self.values.empty_like(),
        }
    }

    /// Number of elements (vertices, faces) described.
    #[must_use]
    pub fn elements(&self) -> usize {
        self.values.len() / self.components.max(1)
    }
}

impl Attribute {
    /// The elements named by `sources`, in that order, as a new attribute.
    /// Every source must be a valid element.
    #[must_use]
    pub fn gathered(&self, sources: &[u32]) -> Self {
        Self {
            name: self.name.clone(),
            components: self.components,
            values: self.values.gathered(self.components, sources),
        }
    }
}

pub(crate) fn gathered<T: Copy>(values: &[T], sources: &[u32]) -> Vec<T> {
    sources.iter().map(|&s| values[s as usize]).collect()
}

fn gathered_sets<T: Copy>(sets: &[Vec<T>], sources: &[u32]) -> Vec<Vec<T>> {
    sets.iter().map(|set| gathered(set, sources)).collect()
}

impl Attributes {
    /// The vertices named by `sources`, in that order, as new attributes. What
    /// [`Attributes::gather`] does, at the cost of the vertices chosen only.
    pub(crate) fn gathered(&self, sources: &[u32]) -> Self {
        Self {
            normals: self.normals.as_ref().map(|v| gathered(v, sources)),
            tangents: self.tangents.as_ref().map(|v| gathered(v, sources)),
            uvs: gathered_sets(&self.uvs, sources),
            colors: gathered_sets(&self.colors, sources),
            skins: gathered_sets(&self.skins, sources),
            morphs: self.morphs.iter().map(|m| m.gathered(sources)).collect(),
            custom: self.custom.iter().map(|a| a.gathered(sources)).collect(),
        }
    }

    /// Keeps the vertices named by `sources`, in that order; a source may
    /// appear several times. Every source must be a valid vertex.
    pub fn gather(&mut self, sources: &[u32]) {
        *self = self.gathered(sources);
    }

    /// Name and element count of every array present, for validation.
    pub(crate) fn lengths(&self) -> Vec<(String, usize)> {
        let mut lengths = Vec::new();
        let mut push = |name: String, len: Option<usize>| lengths.extend(len.map(|l| (name, l)));
        push("normals".into(), self.normals.as_ref().map(Vec::len));
        push("tangents".into(), self.tangents.as_ref().map(Vec::len));
        for (i, set) in self.uvs.iter().enumerate() {
            push(format!("uv set {i}"), Some(set.len()));
        }
        for (i, set) in self.colors.iter().enumerate() {
            push(format!("colour set {i}"), Some(set.len()));
        }
        for (i, set) in self.skins.iter().enumerate() {
            push(format!("skin set {i}"), Some(set.len()));
        }
        for (i, morph) in self.morphs.iter().enumerate() {
            let name = |part| format!("morph target {i} {part}");
            push(name("positions"), morph.positions.as_ref().map(Vec::len));
            push(name("normals"), morph.normals.as_ref().map(Vec::len));
            push(name("tangents"), morph.tangents.as_ref().map(Vec::len));
        }
        for attribute in &self.custom {
            let name = format!("attribute `{}`", attribute.name);
            push(name, Some(attribute.elements()));
        }
        lengths
    }
}

impl MorphTarget {
    fn gathered(&self, sources: &[u32]) -> Self {
        let part = |values: &Option<Vec<Vec3>>| values.as_ref().map(|v| gathered(v, sources));
        Self {
            positions: part(&self.positions),
            normals: part(&self.normals),
            tangents: part(&self.tangents),
        }
    }
}
