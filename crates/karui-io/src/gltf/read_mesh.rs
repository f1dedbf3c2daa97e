//! A mesh from its primitives: vertices are appended block after block, and
//! primitives that share all their accessors share vertices.

use super::{
    accessor::{Component, Elements, Layout},
    draco::DRACO,
    json::{self, At},
    primitive::{Block, Context, Mode, Semantic, find, triangle_mode, triangles},
};
use crate::error::{ErrorKind, Result};
use glam::{Vec2, Vec3, Vec4};
use karui::mesh::{
    Attribute, AttributeValues, Attributes, MaterialRange, MorphTarget, NamedMesh, SkinWeights,
    TriMesh,
};
use serde_json::Value;
use std::{collections::HashMap, mem::size_of};

/// The vertices of a mesh as they are read, and its triangles.
#[derive(Default)]
struct Assembly<'a> {
    blocks: Vec<Block<'a>>,
    /// First vertex of each block.
    starts: Vec<u32>,
    /// Block by the accessors it was read from.
    known: HashMap<String, usize>,
    vertices: usize,
    triangles: Vec<[u32; 3]>,
    ranges: Vec<MaterialRange>,
}

/// Reads a mesh. Its first primitive is number `first` of the file.
pub(super) fn read<'a>(
    context: &mut Context<'a>,
    mesh: &'a Value,
    first: u32,
    at: &At<'_>,
) -> Result<NamedMesh> {
    let mut assembly = Assembly::default();
    for (i, primitive) in json::array(mesh, "primitives", at)?.iter().enumerate() {
        if let Some(mode) = triangle_mode(primitive) {
            let source = first + i as u32;
            assembly.add(context, primitive, mode, source, &at.item("primitives", i))?;
        }
    }
    Ok(NamedMesh {
        name: json::name(mesh),
        mesh: assembly.finish(context, at)?,
    })
}

impl<'a> Assembly<'a> {
    fn add(
        &mut self,
        context: &mut Context<'a>,
        primitive: &'a Value,
        mode: Mode,
        source: u32,
        at: &At<'_>,
    ) -> Result<()> {
        let materials = json::count(&context.document.json, "materials");
        let material = json::index(primitive, "material", materials, "material", at)?;
        let (block, triangles) = match json::extension(primitive, DRACO) {
            Some(compressed) => {
                let (block, corners) = context.draco_block(primitive, compressed, at)?;
                (self.push(block, at)?, triangles(Mode::List, &corners))
            }
            None => {
                let block = self.block(context, primitive, at)?;
                let corners = context.corners(primitive, self.blocks[block].count, at)?;
                if mode == Mode::List && !corners.len().is_multiple_of(3) {
                    context.warnings.push(format!(
                        "{at}: the last {} indices make no triangle",
                        corners.len() % 3
                    ));
                }
                (block, triangles(mode, &corners))
            }
        };
        context
            .budget
            .take(triangles.len(), size_of::<[u32; 3]>(), at)?;
        let start = self.starts[block];
        let first = self.triangles.len() as u32;
        self.triangles
            .extend(triangles.iter().map(|t| t.map(|v| v + start)));
        self.ranges.push(MaterialRange {
            first,
            count: triangles.len() as u32,
            material: material.map(|m| m as u32),
            source: Some(source),
        });
        Ok(())
    }

    /// The block of a primitive that is not compressed, read once for all
    /// primitives of the mesh that name the same accessors.
    fn block(
        &mut self,
        context: &mut Context<'a>,
        primitive: &'a Value,
        at: &At<'_>,
    ) -> Result<usize> {
        let targets = primitive.get("targets").map(Value::to_string);
        let key = format!(
            "{} {}",
            primitive["attributes"],
            targets.unwrap_or_default()
        );
        if let Some(&block) = self.known.get(&key) {
            return Ok(block);
        }
        let block = context.block(primitive, at)?;
        let index = self.push(block, at)?;
        self.known.insert(key, index);
        Ok(index)
    }

    fn push(&mut self, block: Block<'a>, at: &At<'_>) -> Result<usize> {
        let start = self.vertices;
        self.vertices += block.count;
        if self.vertices > u32::MAX as usize {
            return Err(at.fail(ErrorKind::TooLarge {
                what: "vertices of a mesh",
                found: self.vertices as u64,
                limit: u64::from(u32::MAX),
            }));
        }
        self.starts.push(start as u32);
        self.blocks.push(block);
        Ok(self.blocks.len() - 1)
    }

    fn finish(self, context: &mut Context<'a>, at: &At<'_>) -> Result<TriMesh> {
        let mut gather = Gather {
            blocks: &self.blocks,
            vertices: self.vertices,
            context,
        };
        let positions = gather.positions(at)?;
        let attributes = gather.attributes(at)?;
        Ok(TriMesh {
            positions,
            triangles: self.triangles,
            attributes,
            face_attributes: Vec::new(),
            ranges: self.ranges,
        })
    }
}

/// Puts the values of all blocks one after the other.
struct Gather<'g, 'a> {
    blocks: &'g [Block<'a>],
    vertices: usize,
    context: &'g mut Context<'a>,
}

impl<'a> Gather<'_, 'a> {
    fn positions(&mut self, at: &At<'_>) -> Result<Vec<Vec3>> {
        self.take(size_of::<Vec3>(), at)?;
        let mut positions = Vec::with_capacity(self.vertices);
        for block in self.blocks {
            let Some(elements) = block.get(Semantic::Position) else {
                return Err(at.syntax("`POSITION` in every primitive", "none"));
            };
            positions.extend(elements.floats([0.0; 3]).into_iter().map(Vec3::from));
        }
        if positions.iter().all(|p: &Vec3| p.is_finite()) {
            return Ok(positions);
        }
        Err(at.fail(ErrorKind::NotFinite { what: "a position" }))
    }

    fn take(&self, size: usize, at: &At<'_>) -> Result<()> {
        self.context.budget.take(self.vertices, size, at)
    }

    /// Values that some block has, with `default` where a block has none.
    fn floats<const N: usize>(
        &mut self,
        pick: impl for<'b> Fn(&'b Block<'a>) -> Option<&'b Elements<'a>>,
        default: [f32; N],
        at: &At<'_>,
    ) -> Result<Option<Vec<[f32; N]>>> {
        if !self.blocks.iter().any(|b| pick(b).is_some()) {
            return Ok(None);
        }
        self.take(N * 4, at)?;
        let mut values = Vec::with_capacity(self.vertices);
        for block in self.blocks {
            match pick(block) {
                Some(elements) => values.extend(elements.floats(default)),
                None => values.resize(values.len() + block.count, default),
            }
        }
        let mut replaced = false;
        for value in values
            .iter_mut()
            .filter(|v| v.iter().any(|f| !f.is_finite()))
        {
            *value = default;
            replaced = true;
        }
        if replaced {
            let warning = format!("{at}: attribute values that are not finite were replaced");
            self.context.warnings.push(warning);
        }
        Ok(Some(values))
    }

    fn semantic<const N: usize>(
        &mut self,
        semantic: Semantic<'a>,
        default: [f32; N],
        at: &At<'_>,
    ) -> Result<Option<Vec<[f32; N]>>> {
        self.floats(|b| b.get(semantic), default, at)
    }

    fn attributes(&mut self, at: &At<'_>) -> Result<Attributes> {
        let normals = self.semantic(Semantic::Normal, [0.0, 0.0, 1.0], at)?;
        let tangents = self.semantic(Semantic::Tangent, [1.0, 0.0, 0.0, 1.0], at)?;
        let mut attributes = Attributes {
            normals: normals.map(each::<Vec3, 3>),
            tangents: tangents.map(each::<Vec4, 4>),
            ..Attributes::default()
        };
        for set in 0..self.sets(|s| match s {
            Semantic::Uv(n) => Some(n),
            _ => None,
        }) {
            let uvs = self.semantic(Semantic::Uv(set), [0.0; 2], at)?;
            attributes
                .uvs
                .push(self.or_default(uvs.map(each::<Vec2, 2>), Vec2::ZERO, at)?);
        }
        for set in 0..self.sets(|s| match s {
            Semantic::Color(n) => Some(n),
            _ => None,
        }) {
            let colors = self.semantic(Semantic::Color(set), [1.0; 4], at)?;
            let colors = self.or_default(colors.map(each::<Vec4, 4>), Vec4::ONE, at)?;
            attributes.colors.push(colors);
        }
        for set in 0..self.sets(|s| match s {
            Semantic::Joints(n) | Semantic::Weights(n) => Some(n),
            _ => None,
        }) {
            attributes.skins.push(self.skin(set, at)?);
        }
        attributes.morphs = self.morphs(at)?;
        attributes.custom = self.custom(at)?;
        Ok(attributes)
    }

    /// One more than the highest set of a kind.
    fn sets(&self, number: impl Fn(Semantic<'a>) -> Option<usize>) -> usize {
        let attributes = self.blocks.iter().flat_map(|b| &b.attributes);
        let numbers = attributes.filter_map(|(s, _)| number(*s));
        numbers.max().map_or(0, |n| n + 1)
    }

    /// A set that only fills a gap between others is made of defaults.
    fn or_default<T: Clone>(
        &self,
        values: Option<Vec<T>>,
        default: T,
        at: &At<'_>,
    ) -> Result<Vec<T>> {
        if let Some(values) = values {
            return Ok(values);
        }
        self.take(size_of::<T>(), at)?;
        Ok(vec![default; self.vertices])
    }

    /// Joints and weights of a set. Vertices of primitives that are not
    /// skinned follow the first joint.
    fn skin(&mut self, set: usize, at: &At<'_>) -> Result<Vec<SkinWeights>> {
        let whole = if set == 0 { 1.0 } else { 0.0 };
        let weights = self.semantic(Semantic::Weights(set), [whole, 0.0, 0.0, 0.0], at)?;
        self.take(size_of::<SkinWeights>(), at)?;
        let mut skin = vec![SkinWeights::default(); self.vertices];
        for (skin, weights) in skin.iter_mut().zip(weights.into_iter().flatten()) {
            skin.weights = weights;
        }
        let mut start = 0;
        for block in self.blocks {
            if let Some(joints) = block.get(Semantic::Joints(set)) {
                for (i, skin) in skin[start..start + block.count].iter_mut().enumerate() {
                    skin.joints = std::array::from_fn(|c| joints.integer(i, c) as u16);
                }
            }
            start += block.count;
        }
        Ok(skin)
    }

    fn morphs(&mut self, at: &At<'_>) -> Result<Vec<MorphTarget>> {
        let count = self.blocks.iter().map(|b| b.targets.len()).max();
        let mut morphs = Vec::new();
        for target in 0..count.unwrap_or(0) {
            let mut part = |semantic| -> Result<Option<Vec<Vec3>>> {
                let values = self.floats(|b| find_target(b, target, semantic), [0.0; 3], at)?;
                Ok(values.map(each::<Vec3, 3>))
            };
            morphs.push(MorphTarget {
                positions: part(Semantic::Position)?,
                normals: part(Semantic::Normal)?,
                tangents: part(Semantic::Tangent)?,
            });
        }
        let modelled = [Semantic::Position, Semantic::Normal, Semantic::Tangent];
        let targets = self.blocks.iter().flat_map(|b| b.targets.iter().flatten());
        if targets.map(|(s, _)| s).any(|s| !modelled.contains(s)) {
            let warning = "morph targets of texture coordinates or colours were left out";
            self.context.warnings.push(format!("{at}: {warning}"));
        }
        Ok(morphs)
    }

    fn custom(&mut self, at: &At<'_>) -> Result<Vec<Attribute>> {
        let mut names = Vec::new();
        for (semantic, elements) in self.blocks.iter().flat_map(|b| &b.attributes) {
            if let Semantic::Custom(name) = *semantic
                && !names.iter().any(|(n, _)| *n == name)
            {
                names.push((name, elements.layout));
            }
        }
        let read = |(name, layout): (&'a str, Layout)| {
            let components = layout.kind.components();
            self.take(components * layout.component.size(), at)?;
            let values = self.values(name, layout.component, components);
            let name = name.to_owned();
            Ok(Attribute {
                name,
                components,
                values,
            })
        };
        names.into_iter().map(read).collect()
    }

    /// Values of a custom attribute in the type of the first block that has
    /// it. Normalised integers stay integers.
    fn values(&self, name: &'a str, component: Component, components: usize) -> AttributeValues {
        macro_rules! collect {
            ($variant:ident, $type:ty) => {
                AttributeValues::$variant(
                    self.scalars(name, components, |e, i, c| e.integer(i, c) as $type),
                )
            };
        }
        match component {
            Component::I8 => collect!(I8, i8),
            Component::U8 => collect!(U8, u8),
            Component::I16 => collect!(I16, i16),
            Component::U16 => collect!(U16, u16),
            Component::U32 => collect!(U32, u32),
            Component::F32 => {
                AttributeValues::F32(self.scalars(name, components, |e, i, c| e.float(i, c)))
            }
        }
    }

    fn scalars<T: Default + Clone>(
        &self,
        name: &'a str,
        components: usize,
        scalar: impl Fn(&Elements<'a>, usize, usize) -> T,
    ) -> Vec<T> {
        let mut values = Vec::with_capacity(self.vertices * components);
        for block in self.blocks {
            let elements = block.get(Semantic::Custom(name));
            let there = elements.map_or(0, |e| e.layout.kind.components());
            for i in 0..block.count {
                values.extend((0..components).map(|c| match elements {
                    Some(elements) if c < there => scalar(elements, i, c),
                    _ => T::default(),
                }));
            }
        }
        values
    }
}

/// All values of an accessor in their own type, `components` an element.
/// Normalised integers stay integers.
pub(super) fn all_values(elements: &Elements<'_>, components: usize) -> AttributeValues {
    macro_rules! collect {
        ($variant:ident, $scalar:expr) => {
            AttributeValues::$variant(scalars(elements, components, $scalar))
        };
    }
    match elements.layout.component {
        Component::I8 => collect!(I8, |e, i, c| e.integer(i, c) as i8),
        Component::U8 => collect!(U8, |e, i, c| e.integer(i, c) as u8),
        Component::I16 => collect!(I16, |e, i, c| e.integer(i, c) as i16),
        Component::U16 => collect!(U16, |e, i, c| e.integer(i, c) as u16),
        Component::U32 => collect!(U32, |e, i, c| e.integer(i, c) as u32),
        Component::F32 => collect!(F32, |e, i, c| e.float(i, c)),
    }
}

fn scalars<T>(
    elements: &Elements<'_>,
    components: usize,
    scalar: impl Fn(&Elements<'_>, usize, usize) -> T,
) -> Vec<T> {
    let of_element = |i| (0..components).map(move |c| (i, c));
    let places = (0..elements.count).flat_map(of_element);
    places.map(|(i, c)| scalar(elements, i, c)).collect()
}

fn find_target<'e, 'a>(
    block: &'e Block<'a>,
    target: usize,
    semantic: Semantic<'_>,
) -> Option<&'e Elements<'a>> {
    find(block.targets.get(target)?, semantic)
}

fn each<V: From<[f32; N]>, const N: usize>(values: Vec<[f32; N]>) -> Vec<V> {
    values.into_iter().map(V::from).collect()
}
