//! `--picture`: a model from the front and from behind, in the colours of its
//! saliency.

use crate::eye::require_placed;
use crate::input::Input;
use crate::sheet::Layout;
use crate::text::legend;
use anyhow::Result;
use karui::geom::{Camera, Light, Vec3};
use karui::render::{Model, Outputs, Paint, Picture, RenderOptions, Renderer, Scalar, heat_table};

/// Pixels a side of each view.
const SIDE: u32 = 768;
/// Field of view, radians.
const FOV: f32 = 0.5;
/// From the model towards the eye: where `karui render` looks from, and the
/// opposite side.
const VIEWS: [(&str, Vec3); 2] = [
    ("front", Vec3::new(0.470, 0.342, 0.814)),
    ("back", Vec3::new(-0.470, 0.342, -0.814)),
];

/// Both views side by side, with a legend; `values` are those of every mesh.
pub fn sheet(input: &Input, values: &[Vec<f32>], name: &str) -> Result<Picture> {
    let model = Model::of_scene(&input.scene, &[]);
    let renderer = Renderer::of_model(&model)?;
    require_placed(&renderer, &input.path)?;
    let map = heat_table();
    let values: Vec<&[f32]> = values.iter().map(Vec::as_slice).collect();
    let options = RenderOptions {
        width: SIDE,
        height: SIDE,
        samples: 2,
        outputs: Outputs::COLOR,
        paint: Paint::Scalar(Scalar {
            values: &values,
            low: 0.0,
            high: 1.0,
            map: &map,
        }),
        ..RenderOptions::default()
    };
    let tile = |(side, direction): (&str, Vec3)| -> Result<(Picture, String)> {
        let camera = Camera::looking_at(renderer.bounds(), direction, FOV);
        let lights = Light::three_points(&camera)?;
        let mut picture = renderer.frame(&camera, &lights, &options)?.color;
        let unit = format!("{name} saliency, no unit");
        legend(&mut picture, ["0", "1"], &unit, options.background);
        Ok((picture, side.to_owned()))
    };
    let tiles = VIEWS.into_iter().map(tile).collect::<Result<Vec<_>>>()?;
    Ok(Layout::new(tiles.len(), (SIDE, SIDE)).draw(&tiles, options.background))
}
