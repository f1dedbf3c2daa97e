//! What a page can ask for.

mod files;
mod flip;
mod heat;
mod jobs;
mod level;
mod lod;
mod tiles;
mod upload;

use crate::guard::guard;
use crate::page;
use crate::refusal::Refusal;
use crate::shared::Shared;
use axum::Router;
use axum::extract::DefaultBodyLimit;
use axum::http::header::CONTENT_TYPE;
use axum::middleware::from_fn_with_state;
use axum::response::{IntoResponse, Redirect};
use axum::routing::{get, post};
use std::sync::Arc;

/// Largest request that is not a file, bytes.
const SMALL: usize = 64 << 10;

/// All addresses. Each begins with the token, behind which addresses may be relative.
pub fn router(shared: Arc<Shared>) -> Router {
    let token = shared.token.clone();
    let at = |path: &str| format!("/{token}{path}");
    let to_page = Redirect::permanent(&at("/"));
    let upload = DefaultBodyLimit::max(shared.upload_bytes);
    Router::new()
        .route(&at(""), get(async || to_page))
        .route(&at("/"), get(page::index))
        .route(&at("/assets/{*name}"), get(page::asset))
        .route(&at("/api/state"), get(files::state))
        .route(&at("/api/files"), post(upload::upload).layer(upload))
        .route(&at("/api/files/{id}"), get(files::summary))
        .route(&at("/api/files/{id}/level/{level}"), get(level::level))
        .route(&at("/api/files/{id}/lods.glb"), get(level::combined))
        .route(&at("/api/files/{id}/lod"), post(lod::make))
        .route(&at("/api/files/{id}/heat/{kind}"), get(heat::heat))
        .route(&at("/api/files/{id}/flip.png"), get(flip::flip))
        .route(&at("/api/files/{id}/live"), get(crate::live::live))
        .route(
            &at("/api/files/{id}/adaptive"),
            get(crate::adaptive::adaptive),
        )
        .route(&at("/api/files/{id}/tiles/{*name}"), get(tiles::file))
        .route(&at("/api/jobs"), post(jobs::reserve))
        .route(
            &at("/api/jobs/{id}"),
            get(jobs::report).delete(jobs::cancel),
        )
        .fallback(async || Refusal::missing("there is nothing at this address"))
        .layer(DefaultBodyLimit::max(SMALL))
        .layer(from_fn_with_state(Arc::clone(&shared), guard))
        .with_state(shared)
}

/// A GLB as an answer.
fn glb_of(bytes: impl IntoResponse) -> impl IntoResponse {
    ([(CONTENT_TYPE, "model/gltf-binary")], bytes)
}
