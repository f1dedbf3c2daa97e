//! Levels as files.

use super::glb_of;
use crate::refusal::{Refusal, aside};
use crate::shared::Shared;
use axum::extract::{Path, State};
use axum::response::IntoResponse;
use std::sync::Arc;

/// `GET api/files/N/level/K.glb`: the original for K = 0.
pub async fn level(
    State(shared): State<Arc<Shared>>,
    Path((id, name)): Path<(usize, String)>,
) -> Result<impl IntoResponse, Refusal> {
    let file = shared.file(id)?;
    let levels = file.model()?.levels();
    let level = name.strip_suffix(".glb").and_then(|k| k.parse().ok());
    let glb = level.and_then(|level| levels.glb(level));
    Ok(glb_of(glb.ok_or_else(|| no_level(&name))?))
}

/// `GET api/files/N/lods.glb`: all levels in one file (`MSFT_lod`).
pub async fn combined(
    State(shared): State<Arc<Shared>>,
    Path(id): Path<usize>,
) -> Result<impl IntoResponse, Refusal> {
    let file = shared.file(id)?;
    let glb = aside(move || {
        let model = file.model()?;
        Ok(model.levels().combined(&model.scene)?)
    });
    Ok(glb_of(glb.await?))
}

/// That there is no level of this name.
pub fn no_level(name: &str) -> Refusal {
    Refusal::missing(format!("there is no level {name}"))
}
