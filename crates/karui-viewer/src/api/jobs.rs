//! How long work goes on.

use crate::job::{Job, Report};
use crate::refusal::{Refusal, aside};
use crate::shared::Shared;
use axum::Json;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use karui::Progress as _;
use serde_json::{Value, json};
use std::sync::Arc;

/// `POST api/jobs`: a number under which a map may be asked for, so that how far it is can
/// be told.
pub async fn reserve(State(shared): State<Arc<Shared>>) -> (StatusCode, Json<Value>) {
    let (id, _) = shared.jobs.reserve();
    (StatusCode::CREATED, Json(json!({ "job": id })))
}

/// `GET api/jobs/J`.
pub async fn report(
    State(shared): State<Arc<Shared>>,
    Path(id): Path<usize>,
) -> Result<Json<Report>, Refusal> {
    Ok(Json(job(&shared, id)?.report()))
}

/// `DELETE api/jobs/J`: ends it at its next step.
pub async fn cancel(
    State(shared): State<Arc<Shared>>,
    Path(id): Path<usize>,
) -> Result<Json<Report>, Refusal> {
    let job = job(&shared, id)?;
    job.cancel();
    Ok(Json(job.report()))
}

fn job(shared: &Shared, id: usize) -> Result<Arc<Job>, Refusal> {
    let job = shared.jobs.get(id);
    job.ok_or_else(|| Refusal::missing(format!("there is no job {id}")))
}

/// Tells the work that nobody waits for its answer.
struct Awaited(Arc<Job>);

impl Drop for Awaited {
    fn drop(&mut self) {
        self.0.cancel();
    }
}

/// Does the work of a request, under the number of a job if it has one. It ends at its next
/// step once the job is cancelled, and once the request is: what waits for the answer is
/// dropped when the page goes or asks for something else.
pub async fn under<T: Send + 'static>(
    shared: &Shared,
    id: Option<usize>,
    work: impl FnOnce(&Job) -> Result<T, Refusal> + Send + 'static,
) -> Result<T, Refusal> {
    let job = match id {
        Some(id) => job(shared, id)?,
        None => Arc::new(Job::nameless()),
    };
    let awaited = Awaited(Arc::clone(&job));
    let made = aside(move || {
        let made = work(&job);
        job.end_with(&made);
        made.map_err(|refusal| match job.cancelled() {
            true => Refusal::new(StatusCode::CONFLICT, "the work was cancelled"),
            false => refusal,
        })
    });
    let made = made.await;
    drop(awaited);
    made
}
