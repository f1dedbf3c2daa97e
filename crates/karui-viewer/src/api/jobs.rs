//! How long work goes on.

use crate::job::{Job, Report};
use crate::refusal::Refusal;
use crate::shared::Shared;
use axum::Json;
use axum::extract::{Path, State};
use std::sync::Arc;

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
