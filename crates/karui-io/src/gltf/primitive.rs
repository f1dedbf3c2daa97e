//! Primitives: what a mesh is made of, before vertices are put together.

use super::{
    accessor::{Component, Elements, Kind, Layout},
    budget::Budget,
    document::Document,
    draco::{self, DRACO},
    json::{self, At, ROOT},
};
use crate::{
    Warnings,
    error::{ErrorKind, Result},
};
use serde_json::Value;

/// Sets of one kind (UVs, colours, skin weights) that are modelled; further
/// ones are custom attributes.
const SETS: usize = 8;

/// What an attribute means.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Semantic<'v> {
    Position,
    Normal,
    Tangent,
    Uv(usize),
    Color(usize),
    Joints(usize),
    Weights(usize),
    Custom(&'v str),
}

impl<'v> Semantic<'v> {
    pub fn parse(name: &'v str) -> Self {
        let set = |prefix| {
            let digits = name.strip_prefix(prefix)?;
            let set: usize = digits.parse().ok()?;
            (set < SETS && digits == set.to_string()).then_some(set)
        };
        match name {
            "POSITION" => Self::Position,
            "NORMAL" => Self::Normal,
            "TANGENT" => Self::Tangent,
            _ => set("TEXCOORD_")
                .map(Self::Uv)
                .or_else(|| set("COLOR_").map(Self::Color))
                .or_else(|| set("JOINTS_").map(Self::Joints))
                .or_else(|| set("WEIGHTS_").map(Self::Weights))
                .unwrap_or(Self::Custom(name)),
        }
    }

    /// Whether elements of this shape can be read as this.
    fn accepts(self, layout: Layout) -> bool {
        match self {
            Self::Position | Self::Normal => layout.kind == Kind::Vec3,
            Self::Tangent | Self::Weights(_) => layout.kind == Kind::Vec4,
            Self::Uv(_) => layout.kind == Kind::Vec2,
            Self::Color(_) => matches!(layout.kind, Kind::Vec3 | Kind::Vec4),
            Self::Joints(_) => {
                layout.kind == Kind::Vec4
                    && matches!(layout.component, Component::U8 | Component::U16)
            }
            Self::Custom(_) => true,
        }
    }
}

/// How the vertices of a primitive make triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mode {
    List,
    Strip,
    Fan,
}

/// The mode, if the primitive has triangles at all.
pub(super) fn triangle_mode(primitive: &Value) -> Option<Mode> {
    let mode = primitive.get("mode").map_or(Some(4.0), Value::as_f64)?;
    let has_positions = primitive.get("attributes")?.get("POSITION").is_some();
    match mode {
        4.0 if has_positions => Some(Mode::List),
        5.0 if has_positions => Some(Mode::Strip),
        6.0 if has_positions => Some(Mode::Fan),
        _ => None,
    }
}

/// The vertices of one or several primitives of a mesh.
pub(super) struct Block<'a> {
    /// Number of vertices.
    pub count: usize,
    /// Values by meaning.
    pub attributes: Vec<(Semantic<'a>, Elements<'a>)>,
    /// Values by meaning for each morph target.
    pub targets: Vec<Vec<(Semantic<'a>, Elements<'a>)>>,
}

impl<'a> Block<'a> {
    /// The values with a meaning.
    pub fn get(&self, semantic: Semantic<'_>) -> Option<&Elements<'a>> {
        find(&self.attributes, semantic)
    }
}

pub(super) fn find<'e, 'a>(
    attributes: &'e [(Semantic<'_>, Elements<'a>)],
    semantic: Semantic<'_>,
) -> Option<&'e Elements<'a>> {
    let found = attributes.iter().find(|(s, _)| *s == semantic);
    found.map(|(_, elements)| elements)
}

/// What the readers of meshes share.
pub(super) struct Context<'a> {
    pub document: &'a Document,
    pub budget: &'a Budget,
    pub warnings: &'a mut Warnings,
}

impl<'a> Context<'a> {
    /// Elements of the accessor that `attributes[name]` names.
    fn accessor(
        &self,
        attributes: &Value,
        name: &'a str,
        at: &At<'_>,
    ) -> Result<(Semantic<'a>, Elements<'a>)> {
        let json = &self.document.json;
        let index = json::required(attributes, name, at)?;
        let at = at.key(name);
        let index = json::in_range(index, json::count(json, "accessors"), "accessor", &at)?;
        let elements = self.document.elements(index, self.budget)?;
        let semantic = Semantic::parse(name);
        check(semantic, elements.layout, &at)?;
        Ok((semantic, elements))
    }

    /// All values of an object that maps names to accessors; all must be of
    /// one length.
    fn accessors(
        &self,
        attributes: &'a Value,
        length: Option<usize>,
        at: &At<'_>,
    ) -> Result<Vec<(Semantic<'a>, Elements<'a>)>> {
        let Some(names) = attributes.as_object() else {
            return Err(at.syntax("an object", "something else"));
        };
        let mut found: Vec<(Semantic<'a>, Elements<'a>)> = Vec::new();
        for name in names.keys() {
            let (semantic, elements) = self.accessor(attributes, name, at)?;
            let length = length.or(found.first().map(|(_, e)| e.count));
            if let Some(length) = length.filter(|&l| l != elements.count) {
                let expected = format!("{length} elements");
                return Err(at.key(name).syntax(expected, elements.count.to_string()));
            }
            found.push((semantic, elements));
        }
        Ok(found)
    }

    /// Vertices of a primitive that is not compressed.
    pub fn block(&self, primitive: &'a Value, at: &At<'_>) -> Result<Block<'a>> {
        let attributes = self.accessors(&primitive["attributes"], None, &at.key("attributes"))?;
        let count = attributes.first().map_or(0, |(_, e)| e.count);
        let targets = self.targets(primitive, count, at)?;
        Ok(Block {
            count,
            attributes,
            targets,
        })
    }

    fn targets(
        &self,
        primitive: &'a Value,
        count: usize,
        at: &At<'_>,
    ) -> Result<Vec<Vec<(Semantic<'a>, Elements<'a>)>>> {
        let targets = json::array(primitive, "targets", at)?.iter().enumerate();
        targets
            .map(|(i, target)| self.accessors(target, Some(count), &at.item("targets", i)))
            .collect()
    }

    /// Vertices and corners of a Draco-compressed primitive. Attributes that
    /// the stream leaves out come from their accessors.
    pub fn draco_block(
        &self,
        primitive: &'a Value,
        compressed: &'a Value,
        at: &At<'_>,
    ) -> Result<(Block<'a>, Vec<u32>)> {
        let extensions = at.key("extensions");
        let at_draco = extensions.key(DRACO);
        let decoded = self
            .document
            .decode_draco(compressed, self.budget, &at_draco)?;
        let count = decoded.points();
        let ids = draco::attribute_ids(compressed, &at_draco)?;
        let mut attributes = Vec::new();
        let at_attributes = at.key("attributes");
        let Some(names) = primitive["attributes"].as_object() else {
            return Err(at_attributes.syntax("an object", "something else"));
        };
        for name in names.keys() {
            let Some(&(_, id)) = ids.iter().find(|(n, _)| n == name) else {
                let (semantic, elements) =
                    self.accessor(&primitive["attributes"], name, &at_attributes)?;
                if elements.count != count {
                    let expected = format!("{count} elements");
                    return Err(at_attributes
                        .key(name)
                        .syntax(expected, elements.count.to_string()));
                }
                attributes.push((semantic, elements));
                continue;
            };
            let layout = self.layout(&primitive["attributes"], name, &at_attributes)?;
            let semantic = Semantic::parse(name);
            check(semantic, layout, &at_attributes.key(name))?;
            let elements = decoded.elements(id, layout, self.budget, &at_draco)?;
            attributes.push((semantic, elements));
        }
        let targets = self.targets(primitive, count, at)?;
        let block = Block {
            count,
            attributes,
            targets,
        };
        Ok((block, decoded.indices))
    }

    /// The shape of an accessor whose data lie elsewhere.
    fn layout(&self, attributes: &Value, name: &str, at: &At<'_>) -> Result<Layout> {
        let accessors = json::array(&self.document.json, "accessors", &ROOT)?;
        let index = json::required(attributes, name, at)?;
        let index = json::in_range(index, accessors.len(), "accessor", &at.key(name))?;
        Layout::parse(&accessors[index], &ROOT.item("accessors", index))
    }

    /// Corners of a primitive over `vertices` vertices, as listed.
    pub fn corners(&self, primitive: &Value, vertices: usize, at: &At<'_>) -> Result<Vec<u32>> {
        let accessors = json::count(&self.document.json, "accessors");
        let Some(index) = json::index(primitive, "indices", accessors, "accessor", at)? else {
            self.budget.take(vertices, 4, at)?;
            return Ok((0..vertices as u32).collect());
        };
        let at = at.key("indices");
        let elements = self.document.elements(index, self.budget)?;
        let unsigned = matches!(
            elements.layout.component,
            Component::U8 | Component::U16 | Component::U32
        );
        if elements.layout.kind != Kind::Scalar || !unsigned {
            return Err(at.syntax("unsigned scalars", "other elements"));
        }
        self.budget.take(elements.count, 4, &at)?;
        let corners = elements.indices();
        match corners.iter().find(|&&c| c as usize >= vertices) {
            None => Ok(corners),
            Some(&worst) => Err(at.fail(ErrorKind::IndexOutOfRange {
                what: "vertex",
                index: i64::from(worst),
                count: vertices,
            })),
        }
    }
}

pub(super) fn check(semantic: Semantic<'_>, layout: Layout, at: &At<'_>) -> Result<()> {
    if semantic.accepts(layout) {
        return Ok(());
    }
    let found = format!("{:?} of {:?}", layout.kind, layout.component);
    Err(at.syntax("an accessor type that fits the attribute", found))
}

/// Triangles from corners as listed (glTF 2.0, section 3.7.2.1). Strips use
/// triangles without area to turn corners; those are left out.
pub(super) fn triangles(mode: Mode, corners: &[u32]) -> Vec<[u32; 3]> {
    let whole = |t: &[u32; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
    match mode {
        Mode::List => corners.as_chunks::<3>().0.to_vec(),
        Mode::Strip => {
            let strips = corners.windows(3).enumerate();
            let turned = |(i, w): (usize, &[u32])| match i % 2 {
                0 => [w[0], w[1], w[2]],
                _ => [w[0], w[2], w[1]],
            };
            strips.map(turned).filter(whole).collect()
        }
        Mode::Fan => {
            let Some((&hub, rim)) = corners.split_first() else {
                return Vec::new();
            };
            let fan = rim.windows(2).map(|w| [w[0], w[1], hub]);
            fan.filter(whole).collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn semantics_by_name() {
        assert_eq!(Semantic::parse("TEXCOORD_1"), Semantic::Uv(1));
        assert_eq!(Semantic::parse("WEIGHTS_0"), Semantic::Weights(0));
        let odd = ["TEXCOORD_01", "TEXCOORD_4000000000", "_BATCHID", "COLOR_"];
        for name in odd {
            assert_eq!(Semantic::parse(name), Semantic::Custom(name));
        }
    }

    #[test]
    fn strips_and_fans_keep_their_orientation() {
        let strip = triangles(Mode::Strip, &[0, 1, 2, 3, 3, 4]);
        assert_eq!(strip, [[0, 1, 2], [1, 3, 2]]);
        let fan = triangles(Mode::Fan, &[9, 1, 2, 3]);
        assert_eq!(fan, [[1, 2, 9], [2, 3, 9]]);
        assert_eq!(triangles(Mode::List, &[0, 1, 2, 3]), [[0, 1, 2]]);
    }
}
