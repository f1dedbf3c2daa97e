//! Answers that say no.

use axum::Json;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use serde_json::json;

/// Why a request is not done, as `{"error": ...}`.
#[derive(Debug)]
pub struct Refusal {
    status: StatusCode,
    message: String,
}

impl Refusal {
    /// With this status.
    pub fn new(status: StatusCode, message: impl Into<String>) -> Self {
        let message = message.into();
        Self { status, message }
    }

    /// What it says.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// There is no such thing.
    pub fn missing(what: impl Into<String>) -> Self {
        Self::new(StatusCode::NOT_FOUND, what)
    }

    /// What was sent cannot be used.
    pub fn unusable(message: impl Into<String>) -> Self {
        Self::new(StatusCode::UNPROCESSABLE_ENTITY, message)
    }
}

impl IntoResponse for Refusal {
    fn into_response(self) -> Response {
        (self.status, Json(json!({ "error": self.message }))).into_response()
    }
}

/// Options out of range and models that cannot be worked on; no request is to blame for
/// anything else that the libraries say.
impl From<karui::Error> for Refusal {
    fn from(error: karui::Error) -> Self {
        Self::unusable(error.to_string())
    }
}

impl From<karui_io::Error> for Refusal {
    fn from(error: karui_io::Error) -> Self {
        let hint = error.hint().map(|hint| format!("; {hint}"));
        Self::unusable(format!("{error}{}", hint.unwrap_or_default()))
    }
}

/// Does long work where it keeps no other request waiting.
pub async fn aside<T: Send + 'static>(
    work: impl FnOnce() -> Result<T, Refusal> + Send + 'static,
) -> Result<T, Refusal> {
    let stopped = |_| Refusal::new(StatusCode::INTERNAL_SERVER_ERROR, "the work was broken off");
    tokio::task::spawn_blocking(work).await.map_err(stopped)?
}
