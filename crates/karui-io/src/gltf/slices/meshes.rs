//! Where the vertices and corners of meshes lie.

use super::{
    super::{
        accessor::{Component, Kind},
        draco::DRACO,
        json::{self, At, ROOT},
        primitive::{Mode, Semantic, check, triangle_mode},
    },
    buffers::{AccessorAt, Buffers},
};
use crate::{
    error::{ErrorKind, Result},
    warnings::Warnings,
};
use serde_json::{Map, Value};
use std::collections::HashMap;

/// A mesh.
#[derive(Default)]
pub(super) struct MeshAt {
    /// Its vertices, those of one block after those of the other.
    pub blocks: Vec<BlockAt>,
    pub primitives: Vec<PrimitiveAt>,
    pub vertices: u64,
}

/// Vertices of one or several primitives.
pub(super) struct BlockAt {
    pub positions: AccessorAt,
    pub normals: Option<AccessorAt>,
    pub tangents: Option<AccessorAt>,
    pub uvs: Vec<Option<AccessorAt>>,
    pub colors: Vec<Option<AccessorAt>>,
}

/// A list, strip or fan of triangles.
pub(super) struct PrimitiveAt {
    pub mode: Mode,
    /// First vertex of its block within the mesh.
    pub first: u64,
    /// Vertices of its block.
    pub vertices: u64,
    /// Which of them are its corners; `None` if all are, in order.
    pub corners: Option<AccessorAt>,
    /// Triangles, those without area included.
    pub triangles: u64,
}

/// Finds mesh number `index`.
pub(super) fn find(
    json: &Value,
    index: usize,
    buffers: &Buffers,
    warnings: &mut Warnings,
) -> Result<MeshAt> {
    let at = ROOT.item("meshes", index);
    let raw = &json["meshes"][index];
    let mut mesh = MeshAt::default();
    let mut known: HashMap<String, (u64, u64)> = HashMap::new();
    for (i, primitive) in json::array(raw, "primitives", &at)?.iter().enumerate() {
        let Some(mode) = triangle_mode(primitive) else {
            continue;
        };
        let at = at.item("primitives", i);
        if json::extension(primitive, DRACO).is_some() {
            let feature = "compressed glTF in slices (`karui convert` writes it as plain GLB)";
            return Err(at.fail(ErrorKind::unsupported(feature)));
        }
        // As when read whole, primitives with the same accessors share vertices.
        let targets = primitive.get("targets").map(Value::to_string);
        let key = format!(
            "{} {}",
            primitive["attributes"],
            targets.unwrap_or_default()
        );
        let (first, vertices) = match known.get(&key) {
            Some(&block) => block,
            None => {
                let block = find_block(json, primitive, buffers, warnings, &at)?;
                let found = (mesh.vertices, block.positions.count);
                mesh.vertices += found.1;
                mesh.blocks.push(block);
                known.insert(key, found);
                found
            }
        };
        let corners = find_corners(json, primitive, buffers, &at)?;
        let count = corners.as_ref().map_or(vertices, |c| c.count);
        let triangles = match mode {
            Mode::List => count / 3,
            Mode::Strip | Mode::Fan => count.saturating_sub(2),
        };
        mesh.primitives.push(PrimitiveAt {
            mode,
            first,
            vertices,
            corners,
            triangles,
        });
    }
    Ok(mesh)
}

fn find_block(
    json: &Value,
    primitive: &Value,
    buffers: &Buffers,
    warnings: &mut Warnings,
    at: &At<'_>,
) -> Result<BlockAt> {
    let at = at.key("attributes");
    let attributes = &primitive["attributes"];
    let find = |name: &str| -> Result<AccessorAt> {
        let found = accessor(json, attributes, name, &at)?;
        let found = buffers.accessor(json, found)?;
        check(Semantic::parse(name), found.layout, &at.key(name))?;
        Ok(found)
    };
    let mut block = BlockAt {
        positions: find("POSITION")?,
        normals: None,
        tangents: None,
        uvs: Vec::new(),
        colors: Vec::new(),
    };
    let (found, limit) = (block.positions.count, u64::from(u32::MAX));
    if found > limit {
        let what = "vertices of a primitive";
        return Err(at.fail(ErrorKind::TooLarge { what, found, limit }));
    }
    if primitive.get("targets").is_some() {
        warnings.push("morph targets were left aside");
    }
    for name in attributes.as_object().into_iter().flat_map(Map::keys) {
        let slot = match Semantic::parse(name) {
            Semantic::Position => continue,
            Semantic::Normal => &mut block.normals,
            Semantic::Tangent => &mut block.tangents,
            Semantic::Uv(set) => slot(&mut block.uvs, set),
            Semantic::Color(set) => slot(&mut block.colors, set),
            Semantic::Joints(_) | Semantic::Weights(_) => {
                warnings.push("skins were left aside");
                continue;
            }
            Semantic::Custom(_) => {
                warnings.push(format!("attribute {name} was left aside"));
                continue;
            }
        };
        let found = find(name)?;
        if found.count != block.positions.count {
            let expected = format!("{} elements", block.positions.count);
            return Err(at.key(name).syntax(expected, found.count.to_string()));
        }
        *slot = Some(found);
    }
    Ok(block)
}

fn slot(sets: &mut Vec<Option<AccessorAt>>, set: usize) -> &mut Option<AccessorAt> {
    if sets.len() <= set {
        sets.resize(set + 1, None);
    }
    &mut sets[set]
}

fn accessor(json: &Value, holder: &Value, name: &str, at: &At<'_>) -> Result<usize> {
    let index = json::required(holder, name, at)?;
    json::in_range(
        index,
        json::count(json, "accessors"),
        "accessor",
        &at.key(name),
    )
}

fn find_corners(
    json: &Value,
    primitive: &Value,
    buffers: &Buffers,
    at: &At<'_>,
) -> Result<Option<AccessorAt>> {
    if primitive.get("indices").is_none() {
        return Ok(None);
    }
    let found = buffers.accessor(json, accessor(json, primitive, "indices", at)?)?;
    let is_unsigned = matches!(
        found.layout.component,
        Component::U8 | Component::U16 | Component::U32
    );
    if found.layout.kind != Kind::Scalar || !is_unsigned {
        return Err(at
            .key("indices")
            .syntax("unsigned scalars", "other elements"));
    }
    Ok(Some(found))
}
