//! The route of live refinement: a socket, and a thread that works for it.

use super::desk::{Desk, Outgoing};
use super::{ClusterSession, Geometry, HalfEdgeSession, Session};
use crate::file::File;
use crate::refusal::Refusal;
use crate::shared::Shared;
use axum::extract::ws::{CloseFrame, Message, WebSocket, WebSocketUpgrade, close_code};
use axum::extract::{Path, Query, State};
use axum::response::Response;
use karui::geom::Aabb;
use serde::Deserialize;
use serde_json::{Value, json};
use std::sync::Arc;
use std::time::Instant;
use tokio::sync::OwnedSemaphorePermit;
use tokio::sync::mpsc::{Receiver, channel};
use tokio::task::JoinHandle;

/// Largest message of a page, bytes.
const MAX_MESSAGE: usize = 64 << 10;

/// Sockets at a time: each holds about 44 bytes a triangle.
pub const MAX_SESSIONS: usize = 16;

/// Which refinement.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LiveKind {
    /// The half-edge hierarchy.
    HalfEdge,
    /// The graph of clusters.
    Clusters,
}

/// `?kind=` of an address.
#[derive(Debug, Clone, Copy, Deserialize)]
pub struct Asked {
    kind: LiveKind,
}

/// `api/files/N/live?kind=half-edge|clusters`.
pub async fn live(
    State(shared): State<Arc<Shared>>,
    Path(id): Path<usize>,
    Query(Asked { kind }): Query<Asked>,
    socket: WebSocketUpgrade,
) -> Result<Response, Refusal> {
    let file = shared.file(id)?;
    file.model()?;
    Ok(open(&shared, socket, move |desk| refine(&file, kind, desk)))
}

/// Opens a socket that `work` answers, in a thread of its own. What it returns is told to the
/// page, as is that there is no place for it.
pub(crate) fn open(
    shared: &Shared,
    socket: WebSocketUpgrade,
    work: impl FnOnce(&Desk) -> Result<(), Refusal> + Send + 'static,
) -> Response {
    let socket = socket.max_message_size(MAX_MESSAGE);
    let permit = Arc::clone(&shared.sessions).try_acquire_owned();
    match permit {
        Ok(permit) => socket.on_upgrade(|socket| converse(socket, work, permit)),
        Err(_) => socket.on_upgrade(turn_away),
    }
}

/// Browsers keep from a page why a socket was not opened, so it is opened to be told.
async fn turn_away(mut socket: WebSocket) {
    let message = format!(
        "Karui refines for {MAX_SESSIONS} pages already. Close one of them and reload this page."
    );
    let told = json!({ "error": message, "fatal": true }).to_string();
    let close = CloseFrame {
        code: close_code::AGAIN,
        reason: "too many pages".into(),
    };
    for last in [Message::Text(told.into()), Message::Close(Some(close))] {
        // That it cannot be sent means that the page has gone.
        let _gone = socket.send(last).await;
    }
}

/// Tells the thread that the page has gone, whatever ends the conversation.
struct AtDesk(Arc<Desk>);

impl Drop for AtDesk {
    fn drop(&mut self) {
        self.0.close();
    }
}

async fn converse(
    mut socket: WebSocket,
    work: impl FnOnce(&Desk) -> Result<(), Refusal> + Send + 'static,
    permit: OwnedSemaphorePermit,
) {
    let (out, answers) = channel(4);
    let desk = AtDesk(Arc::new(Desk::new(out)));
    let at_work = Arc::clone(&desk.0);
    let worker = tokio::task::spawn_blocking(move || {
        if let Err(refusal) = work(&at_work) {
            at_work.tell(&json!({ "error": refusal.message(), "fatal": true }));
        }
        drop(permit);
    });
    talk(&mut socket, &desk.0, answers, worker).await;
    // That it cannot be sent means that the page has gone.
    let _gone = socket.send(Message::Close(None)).await;
}

/// Until the page goes or the work ends, if it should.
async fn talk(
    socket: &mut WebSocket,
    desk: &Desk,
    mut answers: Receiver<Outgoing>,
    mut worker: JoinHandle<()>,
) {
    loop {
        tokio::select! {
            // The last words of the work come before its end.
            biased;
            answer = answers.recv() => {
                let Some(answer) = answer else { break };
                let message = match answer {
                    Outgoing::Text(text) => Message::Text(text.into()),
                    Outgoing::Frame(bytes) => Message::Binary(bytes.into()),
                };
                if socket.send(message).await.is_err() {
                    break;
                }
            }
            _ended = &mut worker => break,
            message = socket.recv() => match message {
                Some(Ok(Message::Text(text))) => desk.put(text.to_string()),
                // Nothing else is a message; that it is none is told in order.
                Some(Ok(Message::Binary(_))) => desk.put("bytes".to_owned()),
                Some(Ok(Message::Ping(_) | Message::Pong(_))) => {}
                Some(Ok(Message::Close(_)) | Err(_)) | None => break,
            },
        }
    }
}

fn refine(file: &File, kind: LiveKind, desk: &Desk) -> Result<(), Refusal> {
    let model = file.model()?;
    let whole = model.prepared.mesh(&model.scene)?;
    let (mesh, geometry) = &*whole;
    let started = Instant::now();
    match kind {
        LiveKind::HalfEdge => {
            let hierarchy = model.prepared.half_edge(mesh, desk)?;
            let session = HalfEdgeSession::new(geometry, &hierarchy)?;
            let about = json!({
                "kind": "half-edge", "nodes": hierarchy.node_count(),
                "coarsest": hierarchy.counts().coarsest,
            });
            ready(geometry, started, about, desk);
            answer_all(session, desk);
        }
        LiveKind::Clusters => {
            let dag = model.prepared.clusters(mesh, desk)?;
            let session = ClusterSession::new(geometry, &dag)?;
            let most = dag.clusters().iter().map(|c| c.triangles).max();
            let about = json!({
                "kind": "clusters", "clusters": dag.clusters().len(), "levels": dag.levels(),
                "coarsest": dag.triangles_of_roots(), "slot": most.unwrap_or(0),
            });
            ready(geometry, started, about, desk);
            answer_all(session, desk);
        }
    }
    Ok(())
}

/// Tells the page that it may ask now, and what of.
fn ready(geometry: &Geometry, started: Instant, about: Value, desk: &Desk) {
    let Aabb { min, max } = geometry.bounds();
    let mut ready = json!({
        "triangles": geometry.triangle_count(), "vertices": geometry.vertex_count(),
        "bounds": { "min": min.to_array(), "max": max.to_array() },
        "seconds": started.elapsed().as_secs_f64(),
    });
    if let (Some(all), Value::Object(about)) = (ready.as_object_mut(), about) {
        all.extend(about);
    }
    desk.tell(&json!({ "ready": ready }));
}

/// Answers until the page has gone.
pub(crate) fn answer_all(mut session: impl Session, desk: &Desk) {
    while let Some(message) = desk.take() {
        match session.answer(&message) {
            Ok(frame) => desk.send(Outgoing::Frame(frame)),
            Err(error) => desk.fail(&error),
        }
    }
}
