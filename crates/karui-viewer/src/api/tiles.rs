//! Files of a tileset.

use crate::file::Content;
use crate::page::content_type;
use crate::refusal::{Refusal, aside};
use crate::shared::Shared;
use axum::extract::{Path, State};
use axum::http::header::CONTENT_TYPE;
use axum::response::IntoResponse;
use std::sync::Arc;

/// `GET api/files/N/tiles/...`: addresses are looked up in a list, never on the disk.
pub async fn file(
    State(shared): State<Arc<Shared>>,
    Path((id, name)): Path<(usize, String)>,
) -> Result<impl IntoResponse, Refusal> {
    let file = shared.file(id)?;
    let Content::Tileset(set) = &file.content else {
        return Err(Refusal::missing(format!("{} is no tileset", file.name)));
    };
    let missing = || Refusal::missing("there is no such file in the tileset");
    let path = set.file(&name).ok_or_else(missing)?.to_owned();
    let bytes = aside(move || std::fs::read(path).map_err(|_| missing())).await?;
    Ok(([(CONTENT_TYPE, content_type(&name))], bytes))
}
