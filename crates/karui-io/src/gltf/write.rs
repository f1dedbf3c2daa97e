//! From a [`Scene`] to a file.

use super::{
    GltfSource, container,
    feature_table::{self, Declared, FeatureTable, STRUCTURAL},
    heirs,
    instancing::{self, INSTANCING},
    json::{self, ROOT},
    lod::{self, LOD},
    material,
    origin::Origin,
    pack::{MESHOPT, Packed, Packer, Use},
    primitive::triangle_mode,
    quantize::{self, Grid, QUANTIZATION},
    references, uri,
    write_image::{Files, Place, name_by_type, put, write_images, write_textures},
    write_mesh::MeshWriter,
    write_node::write_nodes,
};
use crate::{
    Format,
    atomic::Transaction,
    error::{Error, ErrorKind, Place as ErrorPlace, Result},
    format::is_gz,
    write::write_file,
};
use karui::Scene;
use serde_json::{Value, json};
use std::{fs, path::Path, sync::Arc};

/// How glTF is written.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GltfOptions {
    /// Stores attributes as integers (`KHR_mesh_quantization`): positions in
    /// 16 bits of the mesh's largest extent, texture coordinates in 0..1 in 16
    /// bits, directions, colours and skin weights in 8. Positions of skinned
    /// or instanced meshes stay floats. Default off.
    pub quantize: bool,
    /// Compresses buffers with `EXT_meshopt_compression`, without loss.
    /// Default off.
    pub meshopt: bool,
    /// What the ids in attributes `_FEATURE_ID_0` of vertices and placements stand
    /// for (`EXT_mesh_features`, `EXT_instance_features`,
    /// `EXT_structural_metadata`); it replaces metadata that was read. Default none.
    pub features: Option<Arc<FeatureTable>>,
}

/// Extensions that the reader undoes.
const UNDONE: [&str; 4] = [
    super::draco::DRACO,
    MESHOPT,
    "KHR_meshopt_compression",
    QUANTIZATION,
];

/// A document and its binary data.
struct Built {
    json: Value,
    packed: Packed,
    /// Image files to be written beside it.
    files: Files,
}

/// Writes a `.gltf` with its companions, or a `.glb`.
pub(crate) fn write(
    files: &mut Transaction,
    path: &Path,
    scene: &Scene,
    options: &GltfOptions,
    format: Format,
) -> Result<()> {
    check(scene)?;
    if format == Format::Glb {
        let glb = glb(scene, options)?;
        return write_file(files, path, |sink| sink.write_all(&glb));
    }
    let stem = stem_of(path);
    let mut built = build(scene, options, Some(&stem))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    if !built.packed.bin.is_empty() {
        let name = free_bin_name(&stem, &built.files);
        built.json["buffers"][0]["uri"] = json!(uri::encode_path(&name));
        built
            .files
            .insert(name, Arc::from(built.packed.bin.as_slice()));
    }
    for (name, bytes) in &built.files {
        let target = folder.join(name);
        create_folder(&target)?;
        files.write(&target, |sink| sink.write_all(bytes))?;
    }
    let text = to_text(&built.json, true)?;
    write_file(files, path, |sink| sink.write_all(&text))
}

/// A scene as the bytes of a GLB file.
pub(crate) fn glb_bytes(scene: &Scene, options: &GltfOptions) -> Result<Vec<u8>> {
    check(scene)?;
    glb(scene, options)
}

fn check(scene: &Scene) -> Result<()> {
    let fail = |error| Error::new(ErrorPlace::File, ErrorKind::Geometry(error));
    scene.validate().map_err(fail)
}

/// The same. The scene must be valid.
fn glb(scene: &Scene, options: &GltfOptions) -> Result<Vec<u8>> {
    let built = build(scene, options, None)?;
    container::join(to_text(&built.json, false)?, &built.packed.bin)
}

/// The name of the model without `.gltf` or `.gltf.gz`.
fn stem_of(path: &Path) -> String {
    let mut stem = path.file_stem().unwrap_or_default();
    if is_gz(path) {
        stem = Path::new(stem).file_stem().unwrap_or_default();
    }
    match stem.to_string_lossy() {
        stem if stem.is_empty() => "model".to_owned(),
        stem => stem.into_owned(),
    }
}

fn free_bin_name(stem: &str, files: &Files) -> String {
    let plain = format!("{stem}.bin");
    if files.contains_key(&plain) {
        format!("{stem}_buffer.bin")
    } else {
        plain
    }
}

/// Images may lie in folders below the model's.
fn create_folder(target: &Path) -> Result<()> {
    match target.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => {
            fs::create_dir_all(folder).map_err(|e| Error::file(folder, ErrorKind::Io(e)))
        }
        _ => Ok(()),
    }
}

fn to_text(json: &Value, pretty: bool) -> Result<Vec<u8>> {
    let text = if pretty {
        serde_json::to_vec_pretty(json)
    } else {
        serde_json::to_vec(json)
    };
    text.map_err(|e| {
        Error::new(
            ErrorPlace::File,
            ErrorKind::syntax("a document", e.to_string()),
        )
    })
}

/// Builds the document; images are embedded unless `beside` names them.
fn build(scene: &Scene, options: &GltfOptions, beside: Option<&str>) -> Result<Built> {
    let source = scene.attachment.get::<GltfSource>();
    let mut origin = Origin::new(source.map(|s| &s.document));
    let mut json = origin.json();
    let mut packer = Packer::default();
    let source_meshes = json::count(&json, "meshes");
    write_asset(&mut json);
    let grids = if options.quantize {
        quantize::plan(scene, &json)
    } else {
        vec![None; scene.meshes.len()]
    };
    let numbers = write_meshes(&mut json, scene, &mut origin, &mut packer, options, &grids)?;
    if options.features.is_some() {
        json::remove_extension(&mut json, STRUCTURAL);
    }
    references::visit_outside_meshes(&mut json, &mut |target, value, at| {
        origin.pass(target, value, Use::Other, at, &mut packer)
    })?;
    write_materials(&mut json, scene);
    write_textures(&mut json, scene);
    let mut files = Files::new();
    let place = match beside {
        Some(stem) => Place::Beside(&mut files, stem),
        None => Place::Embedded(&mut packer),
    };
    write_images(&mut json, scene, place);
    write_nodes(&mut json, scene, source_meshes, |mesh| {
        let morphs = scene.meshes[mesh as usize].mesh.attributes.morphs.len();
        numbers[mesh as usize].map(|number| (number, morphs))
    });
    instancing::write_all(&mut json, scene, source, &mut packer);
    share_weights(&mut json, scene);
    place_meshes(&mut json, &numbers, &grids);
    let features = match &options.features {
        Some(table) => feature_table::write(&mut json, &mut packer, table)?,
        None => Declared::default(),
    };
    let (accessors, packed) = packer.finish(options.meshopt);
    json["accessors"] = Value::Array(accessors);
    let image_types = name_by_type(&mut json, scene);
    list_extensions(&mut json, scene, &grids, packed.fallback > 0);
    for name in image_types {
        require(&mut json, name);
    }
    for name in features.names() {
        list(&mut json, "extensionsUsed", name);
    }
    let packed = finish(&mut json, packed);
    Ok(Built {
        json,
        packed,
        files,
    })
}

fn write_asset(json: &mut Value) {
    let generator = concat!("karui ", env!("CARGO_PKG_VERSION"));
    json["asset"]["generator"] = json!(generator);
    json["asset"]["version"] = json!("2.0");
}

/// Writes all meshes; returns the index of each in the document, `None` for
/// those that hold nothing to draw.
fn write_meshes(
    json: &mut Value,
    scene: &Scene,
    origin: &mut Origin<'_>,
    packer: &mut Packer,
    options: &GltfOptions,
    grids: &[Option<Grid>],
) -> Result<Vec<Option<usize>>> {
    let mut writer = MeshWriter {
        origin,
        packer,
        quantize: options.quantize,
    };
    let mut numbers = Vec::with_capacity(scene.meshes.len());
    let mut meshes = Vec::new();
    for (m, mesh) in scene.meshes.iter().enumerate() {
        let written = writer.write(m, mesh, grids[m])?;
        numbers.push(written.is_some().then_some(meshes.len()));
        meshes.extend(written);
    }
    json["meshes"] = Value::Array(meshes);
    Ok(numbers)
}

/// Materials that are as they were read stay as they are.
fn write_materials(json: &mut Value, scene: &Scene) {
    let textures = json::count(json, "textures");
    for (m, material) in scene.materials.iter().enumerate() {
        let raw = json.pointer(&format!("/materials/{m}"));
        let read = raw.map(|raw| material::read(raw, textures, &ROOT));
        if read.is_none_or(|read| read.is_ok_and(|read| read != *material)) {
            let raw = raw.cloned().unwrap_or_default();
            put(json, "materials", m, material::write(material, raw));
        }
    }
}

/// Lets stand-ins of morphing nodes morph with them.
fn share_weights(json: &mut Value, scene: &Scene) {
    let morphs = |node: usize| {
        let mesh = scene.nodes.get(node).and_then(|n| n.mesh);
        mesh.map_or(0, |m| scene.meshes[m as usize].mesh.attributes.morphs.len())
    };
    heirs::hand_on_weights(json, scene, morphs);
    let lods = |node: usize| {
        let lods = scene.nodes.get(node).and_then(|n| n.lods.as_ref());
        lods.map_or_else(Vec::new, |l| l.nodes.clone())
    };
    let animations = json.get_mut("animations").and_then(Value::as_array_mut);
    for animation in animations.into_iter().flatten() {
        lod::share_weight_channels(animation, |node| morphs(node) > 0, lods);
    }
}

fn place_meshes(json: &mut Value, numbers: &[Option<usize>], grids: &[Option<Grid>]) {
    if grids.iter().all(Option::is_none) {
        return;
    }
    let written = numbers
        .iter()
        .zip(grids)
        .filter(|(number, _)| number.is_some());
    let by_number: Vec<Option<Grid>> = written.map(|(_, grid)| *grid).collect();
    quantize::place(json, |mesh| by_number.get(mesh).copied().flatten());
}

/// Brings the lists of extensions in step with what was written.
fn list_extensions(json: &mut Value, scene: &Scene, grids: &[Option<Grid>], meshopt: bool) {
    // Points and lines are passed through as they are, quantised or not.
    let quantized = quantize::uses(json, QUANTIZATION) && has_other_primitives(json)
        || grids.iter().any(Option::is_some)
        || uses_small_integers(json);
    let lods = scene.nodes.iter().any(|n| n.lods.is_some());
    let instances = scene.nodes.iter().any(|n| n.placements.is_some());
    // A file that could be shown without stays such a file.
    let only_instanced = !quantize::uses(json, INSTANCING);
    let transforms = scene.materials.iter().any(material::has_transform);
    let wanted = [
        (QUANTIZATION, quantized, true),
        (MESHOPT, meshopt, true),
        (LOD, lods, false),
        (INSTANCING, instances, only_instanced),
        ("KHR_texture_transform", transforms, false),
    ];
    for (key, all) in [("extensionsUsed", true), ("extensionsRequired", false)] {
        let old = json::remove(json, key).and_then(|l| l.as_array().cloned());
        let mut names = old.unwrap_or_default();
        names.retain(|name| !UNDONE.iter().any(|undone| name == undone));
        for (name, used, required) in wanted {
            if used && (all || required) && !names.iter().any(|n| n == name) {
                names.push(json!(name));
            }
        }
        if !names.is_empty() {
            json[key] = Value::Array(names);
        }
    }
}

/// Lists an extension without which the document cannot be shown.
fn require(json: &mut Value, name: &str) {
    for key in ["extensionsUsed", "extensionsRequired"] {
        list(json, key, name);
    }
}

/// Adds a name to a list of the document.
fn list(json: &mut Value, key: &str, name: &str) {
    if !json[key].is_array() {
        json[key] = json!([]);
    }
    let names = json[key].as_array_mut();
    if let Some(names) = names.filter(|names| !names.iter().any(|n| n == name)) {
        names.push(json!(name));
    }
}

fn primitives(json: &Value) -> impl Iterator<Item = &Value> {
    let meshes = json.get("meshes").and_then(Value::as_array);
    let lists = meshes
        .into_iter()
        .flatten()
        .filter_map(|m| m.get("primitives")?.as_array());
    lists.flatten()
}

fn has_other_primitives(json: &Value) -> bool {
    primitives(json).any(|p| triangle_mode(p).is_none())
}

/// Whether a direction is stored in a type that only quantisation allows.
fn uses_small_integers(json: &Value) -> bool {
    let is_float = |accessor: &Value| {
        let index = accessor.as_u64().unwrap_or(u64::MAX);
        let accessor = json.pointer(&format!("/accessors/{index}/componentType"));
        accessor.is_none_or(|c| c == 5126)
    };
    let small = |attributes: &Value| {
        let directions = ["NORMAL", "TANGENT"].iter();
        directions
            .filter_map(|d| attributes.get(*d))
            .any(|a| !is_float(a))
    };
    primitives(json).any(|p| {
        let targets = p.get("targets").and_then(Value::as_array);
        small(&p["attributes"]) || targets.into_iter().flatten().any(small)
    })
}

/// Adds the buffers and removes what the format does not allow to be empty.
fn finish(json: &mut Value, mut packed: Packed) -> Packed {
    json["bufferViews"] = Value::Array(std::mem::take(&mut packed.views));
    let mut buffers = Vec::new();
    if !packed.bin.is_empty() {
        buffers.push(json!({ "byteLength": packed.bin.len() }));
    }
    if packed.fallback > 0 {
        buffers.push(json!({
            "byteLength": packed.fallback,
            "extensions": { MESHOPT: { "fallback": true } },
        }));
    }
    json["buffers"] = Value::Array(buffers);
    if let Some(members) = json.as_object_mut() {
        members.retain(|_, member| !matches!(member, Value::Array(items) if items.is_empty()));
    }
    packed
}
