//! How long a camera waits for its delta: `live_latency MODEL [FRAMES] [--socket]`.
//!
//! Once around the model, once more while the eye comes closer and goes away again, and once
//! with the light moving along; 1280 x 720 pixels. The time is from the text of a message to
//! the bytes of its answer, with `--socket` from before it is sent to a running viewer until
//! the last byte of the answer has come. The first answer, which holds a whole cut, is told
//! apart.

#![expect(clippy::print_stdout, reason = "it is what this is for")]

mod socket;
mod ways;

use karui::geom::Aabb;
use karui::hierarchy::cluster::{ClusterDag, ClusterDagOptions};
use karui::hierarchy::{Hierarchy, HierarchyOptions};
use karui_viewer::live::{ClusterSession, Geometry, HalfEdgeSession, Session};
use serde_json::{Value, json};
use socket::Server;
use std::error::Error;
use std::time::Instant;
use ways::WAYS;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// What is asked for: a line's name, options and budget.
type Case = (&'static str, Value, Value);

fn half_edges() -> [Case; 3] {
    let page = json!({
        "area": 100.0, "silhouette": 25.0, "light_silhouette": 25.0,
        "highlight": 15.0, "highlight_area": 25.0,
    });
    let budget = json!({ "triangles": 100_000 });
    [
        ("half-edges", page.clone(), json!({})),
        ("half-edges, library's defaults", json!({}), json!({})),
        ("half-edges, at most 100,000", page, budget),
    ]
}

fn clusters() -> [Case; 3] {
    let (light, fine) = (json!({ "light_factor": 0.5 }), json!({ "threshold": 0.25 }));
    let budget = json!({ "triangles": 100_000 });
    [
        ("clusters", json!({ "threshold": 1.0 }), json!({})),
        ("clusters, half the error in light", light, json!({})),
        ("clusters, at most 100,000", fine, budget),
    ]
}

/// The value that a share of all does not exceed.
fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[(share * (sorted.len() - 1) as f64).round() as usize]
}

/// Sends all messages and prints a line.
fn walk(
    name: &str,
    messages: &[String],
    mut answer: impl FnMut(&str) -> Result<Vec<u8>>,
) -> Result<()> {
    let (mut times, mut sizes, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    for message in messages {
        let started = Instant::now();
        let frame = answer(message)?;
        times.push(started.elapsed().as_secs_f64() * 1e3);
        sizes.push(frame.len() as f64 / 1e3);
        triangles.push(f64::from(u32::from_le_bytes(frame[36..40].try_into()?)));
    }
    println!(
        "{name:62} {:7.0} triangles; ms: first {:6.1}, median {:6.2}, 95 % {:6.2}; kB: first {:6.0}, median {:6.1}, 95 % {:6.1}",
        quantile(&triangles, 0.5),
        times[0],
        quantile(&times[1..], 0.5),
        quantile(&times[1..], 0.95),
        sizes[0],
        quantile(&sizes[1..], 0.5),
        quantile(&sizes[1..], 0.95),
    );
    Ok(())
}

/// All ways of all cases; `open` begins a session that knows nothing yet.
fn walk_all<A: FnMut(&str) -> Result<Vec<u8>>>(
    cases: [Case; 3],
    bounds: Aabb,
    frames: u32,
    open: impl Fn() -> Result<A>,
) -> Result<()> {
    for (name, options, budget) in cases {
        for way in WAYS {
            let messages = way.messages(bounds, frames, &options, &budget);
            walk(&format!("{name}, {}", way.name), &messages, open()?)?;
        }
    }
    Ok(())
}

/// Messages answered by a session in this thread.
fn called(model: &str, frames: u32) -> Result<()> {
    let mesh = karui_io::read(model)?.into_single_mesh()?;
    let geometry = Geometry::of(&mesh)?;
    let started = Instant::now();
    let options = HierarchyOptions {
        alpha: f64::INFINITY,
        ..HierarchyOptions::default()
    };
    let hierarchy = Hierarchy::build(&mesh, &options)?;
    let built = started.elapsed().as_secs_f64();
    let dag = ClusterDag::build(&mesh, &ClusterDagOptions::default())?;
    let both = started.elapsed().as_secs_f64();
    println!(
        "{model}: {} triangles; half-edges built in {built:.1} s, clusters in {:.1} s; once around in {frames} frames",
        mesh.triangles.len(),
        both - built,
    );
    let bounds = geometry.bounds();
    walk_all(half_edges(), bounds, frames, || {
        let mut session = HalfEdgeSession::new(&geometry, &hierarchy)?;
        Ok(move |message: &str| Ok(session.answer(message)?))
    })?;
    walk_all(clusters(), bounds, frames, || {
        let mut session = ClusterSession::new(&geometry, &dag)?;
        Ok(move |message: &str| Ok(session.answer(message)?))
    })
}

/// Messages sent to a viewer that runs.
fn sent(model: &str, frames: u32) -> Result<()> {
    let bounds = karui_io::read(model)?.into_single_mesh()?.bounds();
    let server = Server::start(model)?;
    for (kind, cases) in [("half-edge", half_edges()), ("clusters", clusters())] {
        let (_, ready) = server.open(kind)?;
        println!(
            "{model}: {} triangles over a socket, {kind}: ready after {:.1} s; once around in {frames} frames",
            ready["triangles"],
            ready["seconds"].as_f64().unwrap_or_default(),
        );
        walk_all(cases, bounds, frames, || {
            let (mut page, _) = server.open(kind)?;
            Ok(move |message: &str| page.answer(message))
        })?;
    }
    Ok(())
}

fn main() -> Result<()> {
    let (flags, plain): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|a| a.starts_with("--"));
    let usage = "usage: live_latency MODEL [FRAMES] [--socket]";
    let over_socket = match flags.as_slice() {
        [] => false,
        [flag] if flag == "--socket" => true,
        _ => return Err(usage.into()),
    };
    let (model, frames) = match plain.as_slice() {
        [model] => (model, 600),
        [model, frames] => (model, frames.parse()?),
        _ => return Err(usage.into()),
    };
    match over_socket {
        true => sent(model, frames),
        false => called(model, frames),
    }
}
