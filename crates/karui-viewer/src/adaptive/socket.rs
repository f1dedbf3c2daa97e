//! The route of adaptive subdivision.

use super::AdaptiveSession;
use crate::file::{File, Origin};
use crate::live::{Desk, answer_all, open};
use crate::refusal::Refusal;
use crate::shared::Shared;
use axum::extract::ws::WebSocketUpgrade;
use axum::extract::{Path, State};
use axum::response::Response;
use karui::geom::Aabb;
use karui::subdiv::ControlMesh;
use karui_io::ReadOptions;
use serde_json::{Value, json};
use std::sync::Arc;

/// Faces of a cage that is refined live at most.
const MOST_FACES: usize = 100_000;

/// `api/files/N/adaptive`.
pub async fn adaptive(
    State(shared): State<Arc<Shared>>,
    Path(id): Path<usize>,
    socket: WebSocketUpgrade,
) -> Result<Response, Refusal> {
    let file = shared.file(id)?;
    file.model()?;
    Ok(open(&shared, socket, move |desk| smooth(&file, desk)))
}

fn smooth(file: &File, desk: &Desk) -> Result<(), Refusal> {
    let control = control(file)?;
    let faces = control.cage.offsets.len().saturating_sub(1);
    if faces > MOST_FACES {
        let message = format!(
            "{}: {faces} faces are more than the {MOST_FACES} of a control mesh; \
             subdivision is for coarse meshes",
            file.name
        );
        return Err(Refusal::unusable(message));
    }
    control.cage.validate()?;
    desk.tell(&json!({ "ready": ready(&control, faces) }));
    answer_all(AdaptiveSession::new(&control), desk);
    Ok(())
}

/// The file as a control mesh: not what is drawn, which has triangles and seams.
fn control(file: &File) -> Result<ControlMesh, Refusal> {
    let read = match &file.model()?.origin {
        Origin::Disk(path) => karui_io::read_control(path)?,
        Origin::Memory(bytes) => {
            karui_io::read_control_sent(&file.name, bytes, &ReadOptions::default())?
        }
    };
    Ok(read.mesh)
}

fn ready(control: &ControlMesh, faces: usize) -> Value {
    let Aabb { min, max } = Aabb::of(control.positions.iter().copied());
    let positions: Vec<f32> = control
        .positions
        .iter()
        .flat_map(|p| p.to_array())
        .collect();
    json!({
        "kind": "adaptive", "faces": faces, "vertices": control.positions.len(),
        "bounds": { "min": min.to_array(), "max": max.to_array() },
        "cage": { "positions": positions, "edges": edges(control) },
    })
}

/// Both ends of every edge of the cage.
fn edges(control: &ControlMesh) -> Vec<u32> {
    let mut edges = Vec::new();
    for ends in control.cage.offsets.windows(2) {
        let corners = &control.cage.indices[ends[0] as usize..ends[1] as usize];
        for (i, &a) in corners.iter().enumerate() {
            let b = corners[(i + 1) % corners.len()];
            edges.push([a.min(b), a.max(b)]);
        }
    }
    edges.sort_unstable();
    edges.dedup();
    edges.into_flattened()
}
