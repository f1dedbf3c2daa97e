//! How long a camera waits for its delta: `live_latency MODEL [FRAMES]`.
//!
//! Once around the model, once more while the eye comes closer and goes away again, and once
//! with the light moving along; 1280 x 720 pixels. The time is from the text of a message to
//! the bytes of its answer. The first answer, which holds a whole cut, is told apart.

#![expect(clippy::print_stdout, reason = "it is what this is for")]

use karui::geom::{Aabb, Camera, Projection, Vec3, turntable_directions};
use karui::hierarchy::cluster::{ClusterDag, ClusterDagOptions};
use karui::hierarchy::{Hierarchy, HierarchyOptions};
use karui_viewer::live::{ClusterSession, Geometry, HalfEdgeSession, Session};
use serde_json::{Value, json};
use std::error::Error;
use std::time::Instant;

/// A way around a model.
#[derive(Debug, Clone, Copy)]
struct Way {
    name: &'static str,
    /// How close the eye comes, as a factor to the distance at which all is seen.
    closest: f32,
    /// Whether the light goes along.
    lit: bool,
}

const WAYS: [Way; 3] = [
    Way {
        name: "around",
        closest: 1.0,
        lit: false,
    },
    Way {
        name: "closer and away",
        closest: 0.3,
        lit: false,
    },
    Way {
        name: "around, with the light",
        closest: 1.0,
        lit: true,
    },
];

impl Way {
    /// Camera messages along it.
    fn messages(&self, bounds: Aabb, frames: u32, options: &Value, budget: &Value) -> Vec<String> {
        let directions = turntable_directions(frames, 0.3);
        let still = bounds.center() + Vec3::new(-0.6, 0.7, 0.8) * bounds.diagonal() as f32;
        let message = |(seq, direction): (u32, Vec3)| {
            let mut camera = Camera::looking_at(bounds, direction, 30f32.to_radians());
            let turn = std::f32::consts::TAU * seq as f32 / frames as f32;
            let share = 0.5 * (1.0 - self.closest) * (1.0 - turn.cos());
            camera.eye -= (camera.eye - camera.target) * share;
            let along = camera.eye + camera.up * bounds.diagonal() as f32;
            let light = if self.lit { along } else { still };
            let Projection::Perspective { fov_y } = camera.projection else {
                unreachable!("looking_at has a perspective");
            };
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
        (1u32..).zip(directions).map(message).collect()
    }
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

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let model = arguments
        .next()
        .ok_or("usage: live_latency MODEL [FRAMES]")?;
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
        ("half-edges", page.clone(), json!({})),
        ("half-edges, library's defaults", json!({}), json!({})),
        (
            "half-edges, at most 100,000",
            page,
            json!({ "triangles": 100_000 }),
        ),
    ];
    for (name, options, budget) in half_edges {
        for way in WAYS {
            let messages = way.messages(bounds, frames, &options, &budget);
            let session = HalfEdgeSession::new(&geometry, &hierarchy)?;
            walk(&format!("{name}, {}", way.name), &messages, session)?;
        }
    }
    let clusters = [
        ("clusters", json!({ "threshold": 1.0 }), json!({})),
        (
            "clusters, half the error in light",
            json!({ "light_factor": 0.5 }),
            json!({}),
        ),
        (
            "clusters, at most 100,000",
            json!({ "threshold": 0.25 }),
            json!({ "triangles": 100_000 }),
        ),
    ];
    for (name, options, budget) in clusters {
        for way in WAYS {
            let messages = way.messages(bounds, frames, &options, &budget);
            let session = ClusterSession::new(&geometry, &dag)?;
            walk(&format!("{name}, {}", way.name), &messages, session)?;
        }
    }
    Ok(())
}
