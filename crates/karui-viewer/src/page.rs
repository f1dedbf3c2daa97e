//! The page, embedded when this crate is built.

use crate::refusal::Refusal;
use axum::extract::Path;
use axum::http::header::CONTENT_TYPE;
use axum::response::IntoResponse;
use rust_embed::RustEmbed;

/// What `npm run build` makes of `web/`.
#[derive(RustEmbed)]
#[folder = "page"]
struct Page;

/// `/TOKEN/`.
pub async fn index() -> Result<impl IntoResponse, Refusal> {
    embedded("index.html")
}

/// `/TOKEN/assets/...`.
pub async fn asset(Path(name): Path<String>) -> Result<impl IntoResponse, Refusal> {
    embedded(&format!("assets/{name}"))
}

fn embedded(name: &str) -> Result<impl IntoResponse + use<>, Refusal> {
    let file = Page::get(name).ok_or_else(|| Refusal::missing("there is no such page"))?;
    Ok(([(CONTENT_TYPE, content_type(name))], file.data))
}

/// By the name's end.
pub fn content_type(name: &str) -> &'static str {
    match name.rsplit_once('.').map_or("", |(_, end)| end) {
        "html" => "text/html; charset=utf-8",
        "js" => "text/javascript; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "txt" => "text/plain; charset=utf-8",
        "json" => "application/json",
        "svg" => "image/svg+xml",
        "png" => "image/png",
        "jpg" | "jpeg" => "image/jpeg",
        "glb" => "model/gltf-binary",
        "gltf" => "model/gltf+json",
        _ => "application/octet-stream",
    }
}
