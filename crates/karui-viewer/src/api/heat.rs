//! Numbers at the vertices, as colours.

use super::{glb_of, jobs::under, level::no_level};
use crate::job::Job;
use crate::levels::LevelSet;
use crate::measured::Measured;
use crate::model::Model;
use crate::refusal::Refusal;
use crate::shared::Shared;
use axum::Json;
use axum::extract::{Path, Query, State};
use axum::response::{IntoResponse as _, Response};
use karui::metrics::vertex_distances_observed;
use karui::progress::{Share, step};
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
    job: Option<usize>,
}

/// `GET api/files/N/heat/KIND.glb?level=K`: the level with `COLOR_0`; `KIND.json`: what the
/// colours stand for.
pub async fn heat(
    State(shared): State<Arc<Shared>>,
    Path((id, name)): Path<(usize, String)>,
    Query(Asked { level, job }): Query<Asked>,
) -> Result<Response, Refusal> {
    let file = shared.file(id)?;
    let (kind, end) = name.rsplit_once('.').unwrap_or((&name, ""));
    let what: Measured = kind.parse()?;
    match end {
        "glb" => {
            let work = move |job: &Job| glb(file.model()?, what, level, job);
            Ok(glb_of(under(&shared, job, work).await?).into_response())
        }
        "json" => {
            let work = move |job: &Job| legend(file.model()?, what, level, job);
            Ok(Json(under(&shared, job, work).await?).into_response())
        }
        _ => Err(Refusal::missing(format!("there is no {name}"))),
    }
}

fn legend(model: &Model, what: Measured, level: usize, job: &Job) -> Result<Value, Refusal> {
    let values = values(model, what, level, job)?;
    let map: Vec<String> = (heat_table().chunks(17))
        .map(|codes| format!("rgb({} {} {})", codes[0][0], codes[0][1], codes[0][2]))
        .collect();
    let (max, unit) = match what {
        Measured::Saliency(_) => (1.0, "saliency"),
        Measured::Error => (largest(&values), "model units"),
    };
    Ok(json!({ "min": 0.0, "max": max, "unit": unit, "map": "viridis", "colors": map }))
}

fn glb(model: &Model, what: Measured, level: usize, job: &Job) -> Result<Vec<u8>, Refusal> {
    let values = values(model, what, level, job)?;
    step(job, "colours", 0.0)?;
    let scene = model.levels().scene(&model.scene, level);
    let mut scene = scene.ok_or_else(|| no_level(&level.to_string()))?;
    let whole = match what {
        Measured::Saliency(_) => 1.0,
        Measured::Error => largest(&values).max(f32::MIN_POSITIVE),
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

/// One value a vertex of every mesh of a level, measured once.
fn values(
    model: &Model,
    what: Measured,
    level: usize,
    job: &Job,
) -> Result<Arc<Vec<Vec<f32>>>, Refusal> {
    let levels = model.levels();
    if level >= levels.rows.len() {
        return Err(no_level(&level.to_string()));
    }
    if let Some(known) = model.known(what, level, &levels) {
        return Ok(known);
    }
    let found = Arc::new(match what {
        Measured::Error => errors(model, &levels, level, job)?,
        Measured::Saliency(kind) => saliency(model, &levels, kind, level, job)?,
    });
    model.learn(what, level, &levels, Arc::clone(&found));
    Ok(found)
}

/// Distances to the original, world units.
fn errors(
    model: &Model,
    levels: &LevelSet,
    level: usize,
    job: &Job,
) -> Result<Vec<Vec<f32>>, Refusal> {
    if level > 0 && levels.chain.is_none() {
        let message = "the file brought its levels along; make them here to see where they err";
        return Err(Refusal::unusable(message));
    }
    let count = model.scene.meshes.len();
    let of_mesh = |m: usize| {
        let original = &model.scene.meshes[m].mesh;
        let coarse = levels.mesh(&model.scene, m, level);
        let chain = levels.chain.as_ref().and_then(|c| c.chains[m].as_ref());
        let share = |i: usize| i as f32 / count as f32;
        let own = Share {
            whole: job,
            stage: "distances",
            from: share(m),
            to: share(m + 1),
        };
        match chain {
            Some(chain) if level > 0 => {
                let distances = vertex_distances_observed(coarse, original, &own)?;
                let scale = chain.scale as f32;
                Ok(distances.iter().map(|d| d * scale).collect())
            }
            _ => Ok(vec![0.0; coarse.positions.len()]),
        }
    };
    (0..count).map(of_mesh).collect()
}

fn saliency(
    model: &Model,
    levels: &LevelSet,
    kind: Kind,
    level: usize,
    job: &Job,
) -> Result<Vec<Vec<f32>>, Refusal> {
    let scene = levels.scene(&model.scene, level);
    let scene = scene.ok_or_else(|| no_level(&level.to_string()))?;
    let images = if kind.looks() { model.images() } else { &[] };
    let drawn = Drawn::of_scene(&scene, images);
    Ok(kind.saliency(&drawn, None, job)?)
}
