//! Where a level looks different from the original.

use super::jobs::under;
use super::level::no_level;
use crate::job::Job;
use crate::model::Model;
use crate::refusal::Refusal;
use crate::shared::Shared;
use axum::extract::{Path, Query, State};
use axum::http::HeaderName;
use axum::http::header::CONTENT_TYPE;
use axum::response::IntoResponse;
use karui::Scene;
use karui::geom::{Camera, Light, Projection, Vec3};
use karui::metrics::image::{PIXELS_PER_DEGREE, flip as difference};
use karui::progress::step;
use karui::render::{Model as Drawn, Outputs, Picture, RenderOptions, Renderer};
use serde::Deserialize;
use std::sync::Arc;

/// Longest side of a picture, pixels.
const MAX_SIDE: u32 = 2048;
/// Behind the model: dark, as on the page.
const BACKGROUND: [u8; 4] = [22, 24, 28, 255];

/// From where to look; `eye`, `target` and `up` are `x,y,z`.
#[derive(Debug, Deserialize)]
pub struct Asked {
    level: usize,
    eye: String,
    target: String,
    up: String,
    /// Vertical field of view, radians.
    fov: f32,
    width: u32,
    height: u32,
    job: Option<usize>,
}

/// `GET api/files/N/flip.png`: FLIP of level and original at every pixel, its mean in the
/// header `x-karui-flip`.
pub async fn flip(
    State(shared): State<Arc<Shared>>,
    Path(id): Path<usize>,
    Query(asked): Query<Asked>,
) -> Result<impl IntoResponse, Refusal> {
    let file = shared.file(id)?;
    let (camera, number) = (asked.camera()?, asked.job);
    let work = move |job: &Job| picture(file.model()?, &asked, &camera, job);
    let (mean, png) = under(&shared, number, work).await?;
    let mean = (HeaderName::from_static("x-karui-flip"), mean.to_string());
    let kind = (CONTENT_TYPE, "image/png".to_owned());
    Ok(([kind, mean], png))
}

impl Asked {
    fn camera(&self) -> Result<Camera, Refusal> {
        let sides = [self.width, self.height];
        if !sides.iter().all(|side| (1..=MAX_SIDE).contains(side)) {
            let message = format!("a picture has 1 to {MAX_SIDE} pixels a side");
            return Err(Refusal::unusable(message));
        }
        Ok(Camera {
            eye: vector(&self.eye)?,
            target: vector(&self.target)?,
            up: vector(&self.up)?,
            projection: Projection::Perspective { fov_y: self.fov },
            near: None,
            far: None,
        })
    }
}

fn vector(text: &str) -> Result<Vec3, Refusal> {
    let numbers: Option<Vec<f32>> = text.split(',').map(|n| n.parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y, z]) => Ok(Vec3::new(x, y, z)),
        _ => Err(Refusal::unusable(format!("`{text}` is not three numbers"))),
    }
}

fn picture(
    model: &Model,
    asked: &Asked,
    camera: &Camera,
    job: &Job,
) -> Result<(f64, Vec<u8>), Refusal> {
    step(job, "pictures", 0.0)?;
    let scene = model.levels().scene(&model.scene, asked.level);
    let level = scene.ok_or_else(|| no_level(&asked.level.to_string()))?;
    let options = RenderOptions {
        width: asked.width,
        height: asked.height,
        samples: 2,
        outputs: Outputs::COLOR,
        background: BACKGROUND,
        ..RenderOptions::default()
    };
    let of = |scene: &Scene, from: f32| -> Result<Picture, Refusal> {
        let drawn = Drawn::of_scene(scene, model.images());
        let lights = Light::three_points(camera)?;
        let renderer = Renderer::of_model(&drawn)?;
        step(job, "pictures", from + 0.2)?;
        let frame = renderer.frame(camera, &lights, &options)?;
        step(job, "pictures", from + 0.4)?;
        Ok(frame.color)
    };
    let (original, level) = (of(&model.scene, 0.0)?, of(&level, 0.4)?);
    let found = difference(&original, &level, PIXELS_PER_DEGREE)?;
    step(job, "pictures", 1.0)?;
    Ok((found.mean, karui_io::encode_png(&found.picture()?)?))
}
