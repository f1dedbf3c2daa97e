//! Files that are dropped on the page.

use crate::file::File;
use crate::refusal::{Refusal, aside};
use crate::shared::Shared;
use axum::Json;
use axum::body::Bytes;
use axum::extract::rejection::BytesRejection;
use axum::extract::{Query, State};
use axum::http::StatusCode;
use serde::Deserialize;
use serde_json::{Value, json};
use std::sync::Arc;

/// Letters of a name that are kept.
const NAME_LENGTH: usize = 120;

#[derive(Debug, Deserialize)]
pub struct Named {
    name: String,
}

/// `POST api/files?name=NAME` with the file as the body.
pub async fn upload(
    State(shared): State<Arc<Shared>>,
    Query(Named { name }): Query<Named>,
    body: Result<Bytes, BytesRejection>,
) -> Result<(StatusCode, Json<Value>), Refusal> {
    let limit = shared.upload_bytes;
    let body = body.map_err(|error| too_large(&error, limit))?;
    let name = plain(&name);
    let file = aside(move || File::dropped(&name, body)).await?;
    let id = shared.add(file)?;
    Ok((StatusCode::CREATED, Json(json!({ "id": id }))))
}

fn too_large(error: &BytesRejection, limit: usize) -> Refusal {
    let message = match error.status() {
        StatusCode::PAYLOAD_TOO_LARGE => {
            format!(
                "the file is larger than the limit of {limit} bytes; name it on the command line"
            )
        }
        _ => error.body_text(),
    };
    Refusal::new(error.status(), message)
}

/// What a name is without folders and control characters: it is shown, and its end tells
/// the format.
fn plain(name: &str) -> String {
    let last = name.rsplit(['/', '\\']).next().unwrap_or_default();
    let letters: Vec<char> = last.chars().filter(|c| !c.is_control()).collect();
    let from = letters.len().saturating_sub(NAME_LENGTH);
    letters[from..].iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_without_folders() {
        assert_eq!(plain("../../etc/bunny.obj"), "bunny.obj");
        assert_eq!(plain("C:\\models\\bunny.obj\n"), "bunny.obj");
        let long = format!("{}.ply.gz", "x".repeat(500));
        assert_eq!(plain(&long).len(), NAME_LENGTH);
        assert!(plain(&long).ends_with(".ply.gz"));
    }
}
