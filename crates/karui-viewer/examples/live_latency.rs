//! How long a camera waits for its delta: `live_latency MODEL [FRAMES]`.
//!
//! Once around the model in small steps, 1280 x 720 pixels, a light that moves along, both
//! hierarchies; the time from the text of a message to the bytes of its answer, and their
//! number. The first answer, which holds a whole cut, is told apart.

use karui::geom::{Aabb, Camera, Projection, turntable_directions};
use karui::hierarchy::cluster::{ClusterDag, ClusterDagOptions};
use karui::hierarchy::{Hierarchy, HierarchyOptions};
use karui_viewer::live::{ClusterSession, Geometry, HalfEdgeSession, Session};
use serde_json::{Value, json};
use std::error::Error;
use std::time::Instant;

/// Camera messages along the way.
fn messages(bounds: Aabb, frames: u32, options: &Value, budget: &Value) -> Vec<String> {
    let message = |(seq, direction)| {
        let camera = Camera::looking_at(bounds, direction, 30f32.to_radians());
        let Projection::Perspective { fov_y } = camera.projection else {
            unreachable!("looking_at has a perspective");
        };
        let light = camera.eye + camera.up * bounds.diagonal() as f32;
        json!({
            "seq": seq, "size": [1280, 720], "options": options, "budget": budget,
            "frame": {
                "camera": {
                    "eye": camera.eye.to_array(), "target": camera.target.to_array(),
                    "fov": fov_y.to_degrees(),
                },
                "lights": [{ "type": "point", "position": light.to_array() }],
            },
        })
        .to_string()
    };
    let directions = turntable_directions(frames, 0.3);
    (1u32..).zip(directions).map(message).collect()
}

/// The value that a share of all does not exceed.
fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[(share * (sorted.len() - 1) as f64).round() as usize]
}

/// Sends all messages and prints a line.
fn walk(name: &str, messages: &[String], mut session: impl Session) -> Result<(), Box<dyn Error>> {
    let (mut times, mut sizes, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    for message in messages {
        let started = Instant::now();
        let frame = session.answer(message)?;
        times.push(started.elapsed().as_secs_f64() * 1e3);
        sizes.push(frame.len() as f64 / 1e3);
        triangles.push(f64::from(u32::from_le_bytes(frame[36..40].try_into()?)));
    }
    println!(
        "{name:44} {:7.0} triangles; ms: first {:6.1}, median {:6.2}, 95 % {:6.2}; kB: first {:6.0}, median {:6.1}, 95 % {:6.1}",
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

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let model = arguments.next().ok_or("usage: live_latency MODEL [FRAMES]")?;
    let frames = arguments.next().map_or(Ok(600), |n| n.parse())?;
    let mesh = karui_io::read(&model)?.into_single_mesh()?;
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
    let page = json!({
        "area": 100.0, "silhouette": 25.0, "light_silhouette": 25.0,
        "highlight": 15.0, "highlight_area": 25.0,
    });
    let half_edges = [
        ("half-edges, as the page asks at first", page.clone(), json!({})),
        ("half-edges, the library's defaults", json!({}), json!({})),
        ("half-edges, at most 100,000 triangles", page, json!({ "triangles": 100_000 })),
    ];
    for (name, options, budget) in half_edges {
        let session = HalfEdgeSession::new(&geometry, &hierarchy)?;
        walk(name, &messages(bounds, frames, &options, &budget), session)?;
    }
    let clusters = [
        ("clusters, as the page asks at first", json!({ "threshold": 1.0 }), json!({})),
        ("clusters, half of that in light", json!({ "threshold": 1.0, "light_factor": 0.5 }), json!({})),
        ("clusters, at most 100,000 triangles", json!({ "threshold": 0.25 }), json!({ "triangles": 100_000 })),
    ];
    for (name, options, budget) in clusters {
        let session = ClusterSession::new(&geometry, &dag)?;
        walk(name, &messages(bounds, frames, &options, &budget), session)?;
    }
    Ok(())
}
