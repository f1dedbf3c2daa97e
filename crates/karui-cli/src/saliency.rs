//! `--saliency`: how much every vertex matters.

use crate::console::Console;
use crate::input::Input;
use crate::textures;
use crate::weights::MeshWeights;
use anyhow::Result;
use clap::ValueEnum;
use karui::TriMesh;
use karui::render::Model;
use karui::saliency::{self, HybridOptions, MeshSaliencyOptions, MultiView, MultiViewOptions};
use karui::saliency::{Preset, SMOOTHING, Views, WeightMap};

/// Ways to tell what matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Kind {
    /// How strongly the surface bends
    Curvature,
    /// Where it bends otherwise than around it (Lee, Varshney & Jacobs 2005)
    Mesh,
    /// What stands out in pictures from all around, textures included (Itti, Koch & Niebur
    /// 1998; mean of 96 views)
    Image,
    /// All three: at each vertex the one that has most to say (An 2014)
    Hybrid,
}

/// Directions that pictures are made from.
const VIEWS: u32 = 96;

impl Kind {
    /// As on the command line.
    pub fn name(self) -> String {
        let value = self.to_possible_value();
        value.map_or(String::new(), |v| v.get_name().to_owned())
    }

    /// How wide values are smoothed if nothing else is asked for, as a share of the diagonal.
    fn smoothing(self) -> f64 {
        match self {
            Self::Hybrid => SMOOTHING,
            Self::Curvature | Self::Mesh | Self::Image => 0.0,
        }
    }

    /// One value a vertex, 0 to 1.
    fn of_mesh(self, mesh: &TriMesh, views: Option<&MultiView>) -> Result<Vec<f32>> {
        let of_shape = |mesh| saliency::mesh_saliency(mesh, &MeshSaliencyOptions::default());
        Ok(match (self, views) {
            (Self::Curvature, _) => sizes(mesh)?,
            (Self::Image, Some(views)) => views.mean.clone(),
            (Self::Hybrid, Some(views)) => {
                let (bend, shape) = (sizes(mesh)?, of_shape(mesh)?);
                saliency::hybrid(&bend, &shape, views, &HybridOptions::default())?.values
            }
            _ => of_shape(mesh)?,
        })
    }
}

/// Published ways, with the options of their papers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PresetArg {
    /// Hybrid, linear suppression, 614 views that count as 0 where they see nothing (An 2014)
    Thesis2014,
    /// Mesh saliency, squared suppression (Lee, Varshney & Jacobs 2005)
    Lee2005,
    /// Mean of 614 views, colours compared as printed (Itti, Koch & Niebur 1998)
    Itti1998,
}

impl PresetArg {
    /// As the library knows it.
    pub fn resolve(self) -> Preset {
        match self {
            Self::Thesis2014 => Preset::Thesis2014,
            Self::Lee2005 => Preset::Lee2005,
            Self::Itti1998 => Preset::Itti1998,
        }
    }
}

/// Sizes of the mean curvature, 0 to 1.
fn sizes(mesh: &TriMesh) -> Result<Vec<f32>> {
    Ok(saliency::curvature_sizes(&saliency::curvature(mesh)?))
}

/// One value a vertex of every mesh, 0 to 1, as published.
pub fn of_preset(preset: Preset, input: &Input, console: &Console) -> Result<Vec<Vec<f32>>> {
    let images = textures::decode(input, console);
    let model = Model::of_scene(&input.scene, &images);
    Ok(preset.saliency(&model, &*console.progress())?)
}

/// One value a vertex of every mesh, 0 to 1; a mesh without triangles has zeros. Smoothed
/// as far as asked for, else as the kind is.
pub fn of_scene(
    kind: Kind,
    smoothing: Option<f64>,
    input: &Input,
    console: &Console,
) -> Result<Vec<Vec<f32>>> {
    let width = smoothing.unwrap_or(kind.smoothing());
    let views = match kind {
        Kind::Image | Kind::Hybrid => look(input, console)?,
        Kind::Curvature | Kind::Mesh => Vec::new(),
    };
    let of_mesh = |(i, mesh): (usize, &TriMesh)| match mesh.triangles.is_empty() {
        true => Ok(vec![0.0; mesh.positions.len()]),
        false => Ok(saliency::smooth(
            mesh,
            &kind.of_mesh(mesh, views.get(i))?,
            width,
        )?),
    };
    let meshes = input.scene.meshes.iter().map(|m| &m.mesh);
    meshes.enumerate().map(of_mesh).collect()
}

/// What pictures from all around say about every mesh.
fn look(input: &Input, console: &Console) -> Result<Vec<MultiView>> {
    let images = textures::decode(input, console);
    let model = Model::of_scene(&input.scene, &images);
    let options = MultiViewOptions {
        views: Views::Fibonacci(VIEWS),
        ..MultiViewOptions::default()
    };
    Ok(saliency::multi_view(
        &model,
        &options,
        &*console.progress(),
    )?)
}

/// Weights for simplification.
pub fn weights(
    kind: Kind,
    map: WeightMap,
    input: &Input,
    console: &Console,
) -> Result<MeshWeights> {
    mapped(map, of_scene(kind, None, input, console)?)
}

/// Weights for simplification as published.
pub fn preset_weights(preset: Preset, input: &Input, console: &Console) -> Result<MeshWeights> {
    mapped(preset.weights(), of_preset(preset, input, console)?)
}

fn mapped(map: WeightMap, saliency: Vec<Vec<f32>>) -> Result<MeshWeights> {
    let of_mesh = |values: Vec<f32>| Ok(Some(map.weights(&values)?));
    saliency.into_iter().map(of_mesh).collect()
}
