//! Which files there are, and what they hold.

use crate::file::{Content, File, Origin};
use crate::levels::Row;
use crate::model::Model;
use crate::refusal::Refusal;
use crate::shared::Shared;
use crate::tileset::Tileset;
use axum::Json;
use axum::extract::{Path, State};
use karui::Scene;
use karui::saliency::Kind;
use serde::Serialize;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::sync::Arc;

/// `GET api/state`.
pub async fn state(State(shared): State<Arc<Shared>>) -> Json<Value> {
    let files = shared.files();
    let line = |(id, file): (usize, &Arc<File>)| {
        let name = &file.name;
        match &file.content {
            Content::Model(model) => {
                json!({ "id": id, "name": name, "kind": "model", "version": model.version() })
            }
            Content::Tileset(_) => json!({ "id": id, "name": name, "kind": "tileset" }),
        }
    };
    let files: Vec<Value> = files.iter().enumerate().map(line).collect();
    Json(json!({
        "version": env!("CARGO_PKG_VERSION"),
        "limits": { "upload_bytes": shared.upload_bytes },
        "files": files,
    }))
}

/// `GET api/files/N`.
pub async fn summary(
    State(shared): State<Arc<Shared>>,
    Path(id): Path<usize>,
) -> Result<Json<Summary>, Refusal> {
    let file = shared.file(id)?;
    let name = file.name.clone();
    Ok(Json(match &file.content {
        Content::Model(model) => Summary::Model(Box::new(of_model(id, name, model))),
        Content::Tileset(set) => Summary::Tileset(of_tileset(id, name, set)),
    }))
}

/// What a file holds.
#[derive(Debug, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Summary {
    Model(Box<OfModel>),
    Tileset(OfTileset),
}

#[derive(Debug, Serialize)]
pub struct OfModel {
    id: usize,
    name: String,
    triangles: usize,
    vertices: usize,
    meshes: usize,
    materials: usize,
    /// Size of the file.
    bytes: u64,
    /// Whether it was dropped on the page rather than named.
    dropped: bool,
    bounds: Bounds,
    diagonal: f64,
    /// What a length of 1 is, if the format says so.
    unit: Option<&'static str>,
    up: &'static str,
    attributes: BTreeSet<String>,
    warnings: Vec<String>,
    /// Another number whenever the levels are others.
    version: usize,
    levels: Vec<Row>,
    can: Can,
}

#[derive(Debug, Serialize)]
struct Bounds {
    min: [f32; 3],
    max: [f32; 3],
}

/// What else there is to see.
#[derive(Debug, Serialize)]
struct Can {
    /// A hierarchy to refine.
    live: bool,
    /// Clusters to refine.
    clusters: bool,
    /// A cage to subdivide.
    subdivide: bool,
    heat: Vec<&'static str>,
}

#[derive(Debug, Serialize)]
pub struct OfTileset {
    id: usize,
    name: String,
    bytes: u64,
    files: usize,
    /// Address of the root, below `api/files/N/tiles/`.
    root: String,
}

fn of_model(id: usize, name: String, model: &Model) -> OfModel {
    let scene = &*model.scene;
    // Before the levels: what is newer than its number is fetched once more.
    let version = model.version();
    let levels = model.levels();
    let is_gltf = name.ends_with(".glb") || name.ends_with(".gltf");
    let mut heat: Vec<_> = Kind::ALL.map(Kind::name).to_vec();
    heat.push("error");
    let one = scene.meshes.len() == 1;
    OfModel {
        id,
        triangles: levels.rows.first().map_or(0, |row| row.triangles),
        vertices: levels.rows.first().map_or(0, |row| row.vertices),
        meshes: scene.meshes.len(),
        materials: scene.materials.len(),
        bytes: model.bytes,
        dropped: matches!(model.origin, Origin::Memory(_)),
        bounds: Bounds {
            min: model.bounds.min.to_array(),
            max: model.bounds.max.to_array(),
        },
        diagonal: model.bounds.diagonal(),
        unit: is_gltf.then_some("m"),
        up: "y",
        attributes: attributes(scene),
        warnings: model.warnings.clone(),
        version,
        levels: levels.rows.clone(),
        can: Can {
            live: true,
            clusters: true,
            subdivide: one,
            heat,
        },
        name,
    }
}

fn of_tileset(id: usize, name: String, set: &Tileset) -> OfTileset {
    OfTileset {
        id,
        name,
        bytes: set.bytes,
        files: set.count(),
        root: set.root.clone(),
    }
}

/// Names of what vertices carry, of all meshes together.
fn attributes(scene: &Scene) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for mesh in scene.meshes.iter().map(|m| &m.mesh.attributes) {
        names.extend(mesh.normals.as_ref().map(|_| "normals".to_owned()));
        names.extend(mesh.tangents.as_ref().map(|_| "tangents".to_owned()));
        names.extend((0..mesh.uvs.len()).map(|i| format!("uv {i}")));
        names.extend((0..mesh.colors.len()).map(|i| format!("colour {i}")));
        names.extend((!mesh.skins.is_empty()).then(|| "skin".to_owned()));
        names.extend((!mesh.morphs.is_empty()).then(|| "morph targets".to_owned()));
        names.extend(mesh.custom.iter().map(|a| a.name.clone()));
    }
    names
}
