//! From a file to a [`Scene`].

use super::{
    GltfSource,
    budget::Budget,
    document::Document,
    instancing,
    json::{self, At, ROOT},
    material,
    node::{self, Counts, ImageReader},
    primitive::Context,
    read_mesh,
    references::{self, Target},
    tie,
};
use crate::{
    error::{ErrorKind, Result},
    source::Source,
};
use karui::{
    Scene,
    mesh::{Attachment, Image, Material, NamedMesh, Node, Texture},
};
use serde_json::Value;
use std::{collections::HashMap, mem::size_of};

/// Required extensions that need no warning: those that are decoded, and
/// those that change how a surface looks but not where it is.
const UNDERSTOOD: [&str; 9] = [
    "KHR_draco_mesh_compression",
    "KHR_mesh_quantization",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "KHR_texture_transform",
    "KHR_texture_basisu",
    "KHR_lights_punctual",
    "EXT_mesh_gpu_instancing",
    "MSFT_lod",
];

/// Reads a glTF or GLB file.
pub(crate) fn read(source: &mut Source<'_>) -> Result<Scene> {
    let (mut document, budget) = Document::load(source)?;
    warn_of_extensions(&document.json, source);
    let keep = check_references(&mut document, &budget)?;
    let images = read_images(&document, &budget, source)?;
    let mut scene = Scene {
        images,
        textures: read_textures(&document.json)?,
        materials: read_materials(&document.json, &budget)?,
        nodes: read_nodes(&document.json, &budget)?,
        ..Scene::default()
    };
    instancing::read_all(&document, &budget, &mut scene.nodes)?;
    tie::mark(&document.json, &mut scene.nodes);
    scene.roots = node::roots(&document.json, &scene.nodes)?;
    let mut context = Context {
        document: &document,
        budget: &budget,
        warnings: &mut source.warnings,
    };
    scene.meshes = read_meshes(&mut context)?;
    document.keep_views(&keep);
    let placements = scene.nodes.iter().map(|n| n.placements.clone()).collect();
    scene.attachment = Attachment::new(GltfSource {
        document,
        placements,
    });
    Ok(scene)
}

fn warn_of_extensions(json: &Value, source: &mut Source<'_>) {
    let required = json.get("extensionsRequired").and_then(Value::as_array);
    let names = required.into_iter().flatten().filter_map(Value::as_str);
    for name in names {
        if !UNDERSTOOD.contains(&name) && !name.starts_with("KHR_materials_") {
            source.warnings.push(format!(
                "the required extension {name} is passed through without being understood"
            ));
        }
    }
}

/// Checks what is passed through as it is, and tells which buffer views are
/// needed for that.
fn check_references(document: &mut Document, budget: &Budget) -> Result<Vec<bool>> {
    let mut used = Vec::new();
    let mut json = std::mem::take(&mut document.json);
    let result = references::visit_all(&mut json, &mut |target, value, at| {
        used.push((target, whole(value, at)?, at.to_string()));
        Ok(())
    });
    document.json = json;
    result?;
    let mut keep = vec![false; document.view_count()];
    let mut checked = vec![false; json::count(&document.json, "accessors")];
    for (target, index, pointer) in used {
        let found = match target {
            Target::View => keep.len(),
            Target::Accessor => checked.len(),
        };
        if index >= found {
            let kind = ErrorKind::IndexOutOfRange {
                what: "element",
                index: index as i64,
                count: found,
            };
            return Err(crate::Error::new(crate::Place::Pointer(pointer), kind));
        }
        match target {
            Target::View => keep[index] = true,
            Target::Accessor if std::mem::replace(&mut checked[index], true) => {}
            Target::Accessor => {
                document.elements(index, budget)?;
                keep_accessor(&document.json["accessors"][index], &mut keep);
            }
        }
    }
    Ok(keep)
}

fn whole(value: &Value, at: &At<'_>) -> Result<usize> {
    let number = value.as_u64().and_then(|n| usize::try_from(n).ok());
    number.ok_or_else(|| at.syntax("an index", value.to_string()))
}

/// Marks the buffer views of an accessor whose references are good.
fn keep_accessor(accessor: &Value, keep: &mut [bool]) {
    let pointers = [
        "/bufferView",
        "/sparse/indices/bufferView",
        "/sparse/values/bufferView",
    ];
    for view in pointers
        .iter()
        .filter_map(|p| accessor.pointer(p)?.as_f64())
    {
        keep[view as usize] = true;
    }
}

fn read_images(
    document: &Document,
    budget: &Budget,
    source: &mut Source<'_>,
) -> Result<Vec<Image>> {
    let mut reader = ImageReader {
        document,
        budget,
        source,
        known: HashMap::new(),
    };
    let images = json::array(&document.json, "images", &ROOT)?
        .iter()
        .enumerate();
    images
        .map(|(i, raw)| reader.read(raw, &ROOT.item("images", i)))
        .collect()
}

fn read_textures(json: &Value) -> Result<Vec<Texture>> {
    let textures = json::array(json, "textures", &ROOT)?.iter().enumerate();
    let read = |(i, raw)| node::read_texture(raw, json, &ROOT.item("textures", i));
    textures.map(read).collect()
}

fn read_materials(json: &Value, budget: &Budget) -> Result<Vec<Material>> {
    let textures = json::count(json, "textures");
    let materials = json::array(json, "materials", &ROOT)?;
    budget.take(
        materials.len(),
        size_of::<Material>(),
        &ROOT.key("materials"),
    )?;
    let read = |(i, raw)| material::read(raw, textures, &ROOT.item("materials", i));
    materials.iter().enumerate().map(read).collect()
}

pub(super) fn read_nodes(json: &Value, budget: &Budget) -> Result<Vec<Node>> {
    let raw = json::array(json, "nodes", &ROOT)?;
    budget.take(raw.len(), size_of::<Node>(), &ROOT.key("nodes"))?;
    let counts = Counts {
        nodes: raw.len(),
        meshes: json::count(json, "meshes"),
        skins: json::count(json, "skins"),
    };
    let read = |(i, raw)| node::read_node(raw, &counts, &ROOT.item("nodes", i));
    let nodes: Vec<Node> = raw.iter().enumerate().map(read).collect::<Result<_>>()?;
    node::check_trees(&nodes)?;
    check_lods(&nodes)?;
    Ok(nodes)
}

fn check_lods(nodes: &[Node]) -> Result<()> {
    for (n, node) in nodes.iter().enumerate() {
        let stand_ins = node.lods.iter().flat_map(|l| &l.nodes);
        if stand_ins.into_iter().any(|&s| s as usize == n) {
            let at = ROOT.item("nodes", n);
            let kind = ErrorKind::Geometry(karui::Error::BadReference {
                what: "node",
                index: n,
                target: "level of detail",
                to: n,
                problem: "is the node itself",
            });
            return Err(at.key("extensions").key(super::lod::LOD).fail(kind));
        }
    }
    Ok(())
}

fn read_meshes(context: &mut Context<'_>) -> Result<Vec<NamedMesh>> {
    let document = context.document;
    let mut first = 0;
    let mut meshes = Vec::new();
    for (i, raw) in json::array(&document.json, "meshes", &ROOT)?
        .iter()
        .enumerate()
    {
        let at = ROOT.item("meshes", i);
        meshes.push(read_mesh::read(context, raw, first, &at)?);
        first += json::array(raw, "primitives", &at)?.len() as u32;
    }
    Ok(meshes)
}
