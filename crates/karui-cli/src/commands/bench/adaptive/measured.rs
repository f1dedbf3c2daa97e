//! One cage, all settings.

use super::Args;
use super::pictures::Studio;
use crate::commands::bench::clock::{Cost, Watch};
use crate::output::Staged;
use anyhow::Result;
use karui::geom::{Aabb, Camera, DVec3, sin_cos};
use karui::subdiv::adaptive::{Adaptive, AdaptiveMesh, AdaptiveOptions, View};
use karui::subdiv::{ControlMesh, SubdivOptions};
use serde::Serialize;
use std::path::Path;

/// Degrees from one frame of the walk to the next.
const STEP: f64 = 0.5;
/// Field of view, radians.
const FOV: f32 = 0.6;

/// One cage and setting.
#[derive(Debug, Serialize)]
pub struct Row {
    pub model: String,
    pub setting: String,
    pub faces: usize,
    pub flip: f64,
    /// As deep as silhouettes, and only as deep as makes the picture as alike.
    pub deep: Uniform,
    pub alike: Uniform,
    /// Seconds: of the first frame; median, mean of the processor, and most of those after it.
    pub first: f64,
    pub median: f64,
    pub cpu: f64,
    pub slowest: f64,
    /// Faces of all levels that are kept after that.
    pub kept: usize,
}

/// Uniform refinement to a depth.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Uniform {
    pub depth: u32,
    pub faces: usize,
    pub flip: f64,
}

/// Measures a cage; pictures go to `staged`.
pub fn of_control(
    file: &Path,
    control: &ControlMesh,
    args: &Args,
    staged: Option<&Staged>,
) -> Result<Vec<Row>> {
    let model = file
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    let view = |turn: f64| view(control, args, turn);
    let studio = Studio::new(view(0.0).camera, args.size);
    let mut uniform = fresh(control)?;
    let mut at_depth = |depth| uniform.refine(&view(0.0), &AdaptiveOptions::uniform(depth));
    let deepest = args.depth_silhouette + 2;
    let truth = studio.picture(&at_depth(deepest)?)?;
    let mut uniforms = Vec::new();
    for depth in (0..deepest).step_by(2) {
        let mesh = at_depth(depth)?;
        uniforms.push(Uniform {
            depth,
            faces: mesh.mesh.face_count(),
            flip: studio.difference(&studio.picture(&mesh)?, &truth)?,
        });
    }
    drop(uniform);
    let mut rows = Vec::new();
    for (setting, options) in args.settings() {
        let mut adaptive = fresh(control)?;
        let mut mesh = AdaptiveMesh::default();
        let mut frame = |turn: f64, mesh: &mut AdaptiveMesh| -> Result<Cost> {
            let view = view(turn);
            let (done, cost) = Watch::Time.call(|| adaptive.refine_into(&view, &options, mesh));
            done?;
            Ok(cost)
        };
        let first = frame(0.0, &mut mesh)?.wall;
        let flip = studio.difference(&studio.picture(&mesh)?, &truth)?;
        if let Some(staged) = staged {
            let name = format!("{model}-{}", setting.replace([' ', '/'], "-"));
            studio.write(staged, &name, &mesh)?;
        }
        let faces = mesh.mesh.face_count();
        let turns = (1..=args.frames).map(|i| STEP * f64::from(i));
        let costs = turns
            .map(|t| frame(t, &mut mesh))
            .collect::<Result<Vec<Cost>>>()?;
        let mut times: Vec<f64> = costs.iter().map(|c| c.wall).collect();
        times.sort_by(f64::total_cmp);
        let last = uniforms[uniforms.len() - 1];
        let as_deep = uniforms.iter().find(|u| u.depth >= args.depth_silhouette);
        let alike = uniforms.iter().find(|u| u.flip <= flip);
        rows.push(Row {
            model: model.clone(),
            setting,
            faces,
            flip,
            deep: *as_deep.unwrap_or(&last),
            alike: *alike.unwrap_or(&last),
            first,
            median: times[times.len() / 2],
            cpu: costs.iter().map(|c| c.cpu).sum::<f64>() / costs.len() as f64,
            slowest: times[times.len() - 1],
            kept: adaptive.kept(),
        });
    }
    Ok(rows)
}

/// Turns faces over if the cage is inside out, by its volume.
pub fn turn_outwards(control: &mut ControlMesh) {
    let cage = &mut control.cage;
    let at = |v: u32| control.positions[v as usize].as_dvec3();
    let middle = control
        .positions
        .iter()
        .map(|p| p.as_dvec3())
        .sum::<DVec3>();
    let middle = middle / control.positions.len().max(1) as f64;
    let mut volume = 0.0;
    for w in cage.offsets.windows(2) {
        let face = &cage.indices[w[0] as usize..w[1] as usize];
        for pair in face[1..].windows(2) {
            let [a, b, c] = [face[0], pair[0], pair[1]].map(|v| at(v) - middle);
            volume += a.dot(b.cross(c));
        }
    }
    if volume < 0.0 {
        for w in cage.offsets.windows(2) {
            cage.indices[w[0] as usize..w[1] as usize].reverse();
        }
    }
}

fn fresh(control: &ControlMesh) -> Result<Adaptive> {
    let options = control.rules.apply(SubdivOptions::default());
    Ok(Adaptive::new(&control.cage, &control.positions, &options)?)
}

/// So many degrees on from where the walk starts.
fn view(control: &ControlMesh, args: &Args, turn: f64) -> View {
    let bounds = Aabb::of(control.positions.iter().copied());
    let (height, around) = sin_cos(args.elevation.to_radians());
    let (sine, cosine) = sin_cos((args.azimuth + turn).to_radians());
    let towards = DVec3::new(around * sine, height, around * cosine);
    View {
        camera: Camera::looking_at(bounds, towards.as_vec3(), FOV),
        size: [args.size.0, args.size.1],
        lights: Vec::new(),
    }
}
