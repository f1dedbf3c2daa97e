//! `--saliency`: how much every vertex matters.

use crate::console::Console;
use crate::input::Input;
use crate::textures;
use crate::weights::MeshWeights;
use anyhow::Result;
use clap::ValueEnum;
use karui::render::Model;
use karui::saliency::{self, Preset, WeightMap};

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

impl Kind {
    /// As on the command line.
    pub fn name(self) -> String {
        self.resolve().name().to_owned()
    }

    /// As the library knows it.
    fn resolve(self) -> saliency::Kind {
        match self {
            Self::Curvature => saliency::Kind::Curvature,
            Self::Mesh => saliency::Kind::Mesh,
            Self::Image => saliency::Kind::Image,
            Self::Hybrid => saliency::Kind::Hybrid,
        }
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
    let kind = kind.resolve();
    let images = match kind.looks() {
        true => textures::decode(input, console),
        false => Vec::new(),
    };
    let model = Model::of_scene(&input.scene, &images);
    Ok(kind.saliency(&model, smoothing, &*console.progress())?)
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
