//! Numbers at the vertices, as colours.

use super::{glb_of, level::no_level};
use crate::levels::LevelSet;
use crate::model::Model;
use crate::refusal::{Refusal, aside};
use crate::shared::Shared;
use axum::Json;
use axum::extract::{Path, Query, State};
use axum::response::{IntoResponse as _, Response};
use karui::metrics::vertex_distances;
use karui::progress::Silent;
use karui::render::{Model as Drawn, heat_color, heat_table};
use karui::saliency::Kind;
use karui_io::{GltfOptions, glb_bytes};
use serde::Deserialize;
use serde_json::{Value, json};
use std::sync::Arc;

#[derive(Debug, Deserialize)]
pub struct Asked {
    #[serde(default)]
    level: usize,
}

/// `GET api/files/N/heat/KIND.glb?level=K`: the level with `COLOR_0`; `KIND.json`: what the
/// colours stand for.
pub async fn heat(
    State(shared): State<Arc<Shared>>,
    Path((id, name)): Path<(usize, String)>,
    Query(Asked { level }): Query<Asked>,
) -> Result<Response, Refusal> {
    let file = shared.file(id)?;
    let (kind, end) = name.rsplit_once('.').unwrap_or((&name, ""));
    let what: What = kind.parse()?;
    match end {
        "glb" => {
            let glb = aside(move || glb(file.model()?, what, level)).await?;
            Ok(glb_of(glb).into_response())
        }
        "json" => {
            let legend = aside(move || legend(file.model()?, what, level)).await?;
            Ok(Json(legend).into_response())
        }
        _ => Err(Refusal::missing(format!("there is no {name}"))),
    }
}

/// What is painted.
#[derive(Debug, Clone, Copy)]
enum What {
    Saliency(Kind),
    /// Distance to the original.
    Error,
}

impl std::str::FromStr for What {
    type Err = karui::Error;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        match name {
            "error" => Ok(Self::Error),
            _ => Ok(Self::Saliency(name.parse()?)),
        }
    }
}

fn legend(model: &Model, what: What, level: usize) -> Result<Value, Refusal> {
    let values = values(model, what, level)?;
    let map: Vec<String> = (heat_table().chunks(17))
        .map(|codes| format!("rgb({} {} {})", codes[0][0], codes[0][1], codes[0][2]))
        .collect();
    let (max, unit) = match what {
        What::Saliency(_) => (1.0, "saliency"),
        What::Error => (largest(&values), "model units"),
    };
    Ok(json!({ "min": 0.0, "max": max, "unit": unit, "map": "viridis", "colors": map }))
}

fn glb(model: &Model, what: What, level: usize) -> Result<Vec<u8>, Refusal> {
    let values = values(model, what, level)?;
    let scene = model.levels().scene(&model.scene, level);
    let mut scene = scene.ok_or_else(|| no_level(&level.to_string()))?;
    let whole = match what {
        What::Saliency(_) => 1.0,
        What::Error => largest(&values).max(f32::MIN_POSITIVE),
    };
    for (named, values) in scene.meshes.iter_mut().zip(&*values) {
        let colors = values.iter().map(|v| heat_color(v / whole));
        named.mesh.attributes.colors = vec![colors.collect()];
    }
    Ok(glb_bytes(&scene, &GltfOptions::default())?)
}

fn largest(values: &[Vec<f32>]) -> f32 {
    values.iter().flatten().copied().fold(0.0, f32::max)
}

/// One value a vertex of every mesh of a level.
fn values(model: &Model, what: What, level: usize) -> Result<Arc<Vec<Vec<f32>>>, Refusal> {
    let levels = model.levels();
    if level >= levels.rows.len() {
        return Err(no_level(&level.to_string()));
    }
    match what {
        What::Error => Ok(Arc::new(errors(model, &levels, level)?)),
        What::Saliency(kind) => saliency(model, &levels, kind, level),
    }
}

/// Distances to the original, world units.
fn errors(model: &Model, levels: &LevelSet, level: usize) -> Result<Vec<Vec<f32>>, Refusal> {
    if level > 0 && levels.chain.is_none() {
        let message = "the file brought its levels along; make them here to see where they err";
        return Err(Refusal::unusable(message));
    }
    let of_mesh = |m: usize| {
        let original = &model.scene.meshes[m].mesh;
        let coarse = levels.mesh(&model.scene, m, level);
        let chain = levels.chain.as_ref().and_then(|c| c.chains[m].as_ref());
        match chain {
            Some(chain) if level > 0 => {
                let distances = vertex_distances(coarse, original)?;
                let scale = chain.scale as f32;
                Ok(distances.iter().map(|d| d * scale).collect())
            }
            _ => Ok(vec![0.0; coarse.positions.len()]),
        }
    };
    (0..model.scene.meshes.len()).map(of_mesh).collect()
}

fn saliency(
    model: &Model,
    levels: &Arc<LevelSet>,
    kind: Kind,
    level: usize,
) -> Result<Arc<Vec<Vec<f32>>>, Refusal> {
    if let Some(known) = model.known(kind, level, levels) {
        return Ok(known);
    }
    let scene = levels.scene(&model.scene, level);
    let scene = scene.ok_or_else(|| no_level(&level.to_string()))?;
    let images = if kind.looks() { model.images() } else { &[] };
    let drawn = Drawn::of_scene(&scene, images);
    let found = Arc::new(kind.saliency(&drawn, None, &Silent)?);
    model.learn(kind, level, levels, Arc::clone(&found));
    Ok(found)
}
