//! Making levels of detail: the work of `karui lod`, asked for by the page.

use crate::job::Job;
use crate::levels::LevelSet;
use crate::model::Model;
use crate::refusal::Refusal;
use crate::shared::Shared;
use axum::Json;
use axum::extract::rejection::JsonRejection;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use karui::lod::{Levels, LodOptions, Method, Screen, SeenOptions, chain_scene, chain_seen};
use karui::render::Model as Drawn;
use karui::saliency::{Kind, WeightMap};
use karui::simplify::{Border, Quality, SimplifyOptions, Topology};
use serde::Deserialize;
use serde_json::{Value, json};
use std::sync::Arc;

/// What is asked for; what is left out is as `karui lod` has it.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Request {
    /// Levels by halving, at most. One way to say which levels of these five.
    levels: Option<usize>,
    ratios: Vec<f64>,
    triangles: Vec<usize>,
    errors: Vec<f64>,
    pixels: Vec<f64>,
    quality: QualityName,
    border: BorderName,
    method: MethodName,
    /// Keep every part, hole and handle.
    keep_topology: bool,
    /// Size up to which parts are removed, model units.
    prune: Option<f64>,
    /// Keep more detail where this kind says that it matters.
    saliency: Option<String>,
    /// Largest mean FLIP at the switch distance; without it, surfaces decide.
    flip: Option<f64>,
    /// Screen that switch distances are for.
    height: Option<f64>,
    /// Degrees.
    fov: Option<f64>,
    pixel_tolerance: Option<f64>,
}

#[derive(Debug, Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum QualityName {
    Fast,
    #[default]
    Balanced,
    Exact,
}

#[derive(Debug, Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum BorderName {
    #[default]
    Preserve,
    Lock,
    Free,
}

#[derive(Debug, Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum MethodName {
    #[default]
    Collapse,
    Cluster,
    CollapseElseCluster,
    Foliage,
}

/// `POST api/files/N/lod`.
pub async fn make(
    State(shared): State<Arc<Shared>>,
    Path(id): Path<usize>,
    body: Result<Json<Request>, JsonRejection>,
) -> Result<(StatusCode, Json<Value>), Refusal> {
    let unusable = |error: JsonRejection| Refusal::new(error.status(), error.body_text());
    let Json(request) = body.map_err(unusable)?;
    let file = shared.file(id)?;
    file.model()?;
    let kind = request.saliency.as_deref().map(str::parse).transpose()?;
    let (number, job) = shared.jobs.begin(id, &format!("{request:?}"));
    let accepted = (StatusCode::ACCEPTED, Json(json!({ "job": number })));
    let Some(job) = job else {
        return Ok(accepted);
    };
    tokio::task::spawn_blocking(move || {
        let made = file.model().and_then(|model| {
            let levels = work(model, &request, kind, &job)?;
            // A job that was told to end must not replace what a later one has made.
            karui::progress::step(&*job, "levels", 1.0)?;
            model.set_levels(levels);
            Ok(())
        });
        job.end_with(&made);
    });
    Ok(accepted)
}

fn work(
    model: &Model,
    request: &Request,
    kind: Option<Kind>,
    job: &Job,
) -> Result<LevelSet, Refusal> {
    let weights = match kind {
        Some(kind) => weights(model, kind, job)?,
        None => Vec::new(),
    };
    let options = LodOptions {
        weights: &weights,
        progress: job,
        ..request.options()
    };
    let mut chain = chain_scene(&model.scene, &options)?;
    let seen = match request.flip {
        Some(bound) => {
            let options = SeenOptions {
                bound,
                screen: chain.screen,
                progress: job,
                ..SeenOptions::default()
            };
            Some(chain_seen(
                &model.scene,
                model.images(),
                &mut chain,
                &options,
            )?)
        }
        None => None,
    };
    Ok(LevelSet::of_chain(&model.scene, chain, seen.as_deref())?)
}

fn weights(model: &Model, kind: Kind, job: &Job) -> Result<Vec<Option<Vec<f32>>>, Refusal> {
    let images = if kind.looks() { model.images() } else { &[] };
    let drawn = Drawn::of_scene(&model.scene, images);
    let saliency = kind.saliency(&drawn, None, job)?;
    let of_mesh = |values: Vec<f32>| Ok(Some(WeightMap::default().weights(&values)?));
    saliency.into_iter().map(of_mesh).collect()
}

impl Request {
    fn options(&self) -> LodOptions<'static> {
        let screen = Screen::default();
        LodOptions {
            levels: self.levels(),
            screen: Screen {
                height_px: self.height.unwrap_or(screen.height_px),
                fov_y: self.fov.map_or(screen.fov_y, f64::to_radians),
                tolerance_px: self.pixel_tolerance.unwrap_or(screen.tolerance_px),
            },
            simplify: self.simplify(),
            method: match self.method {
                MethodName::Collapse => Method::Collapse,
                MethodName::Cluster => Method::Cluster,
                MethodName::CollapseElseCluster => Method::CollapseElseCluster,
                MethodName::Foliage => Method::Foliage { card: 16 },
            },
            prune: self.prune,
            ..LodOptions::default()
        }
    }

    fn levels(&self) -> Levels {
        if !self.ratios.is_empty() {
            return Levels::Ratios(self.ratios.clone());
        }
        if !self.triangles.is_empty() {
            return Levels::Triangles(self.triangles.clone());
        }
        if !self.errors.is_empty() {
            return Levels::Errors(self.errors.clone());
        }
        if !self.pixels.is_empty() {
            return Levels::Pixels(self.pixels.clone());
        }
        match (self.levels, Levels::default()) {
            (Some(max_levels), Levels::Halving { min_triangles, .. }) => Levels::Halving {
                min_triangles,
                max_levels,
            },
            (_, default) => default,
        }
    }

    fn simplify(&self) -> SimplifyOptions<'static> {
        SimplifyOptions {
            quality: match self.quality {
                QualityName::Fast => Quality::Fast,
                QualityName::Balanced => Quality::Balanced,
                QualityName::Exact => Quality::Exact,
            },
            border: match self.border {
                BorderName::Preserve => Border::Preserve,
                BorderName::Lock => Border::Lock,
                BorderName::Free => Border::Free,
            },
            topology: match self.keep_topology {
                true => Topology::Preserve,
                false => Topology::Simplify,
            },
            ..SimplifyOptions::default()
        }
    }
}
