//! `--saliency`: how much every vertex matters.

use crate::console::Console;
use crate::input::Input;
use crate::textures;
use anyhow::Result;
use clap::ValueEnum;
use karui::TriMesh;
use karui::render::Model;
use karui::saliency::{self, HybridOptions, MeshSaliencyOptions, MultiView, MultiViewOptions};
use karui::saliency::{Views, WeightMap};

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

    /// One value a vertex, 0 to 1.
    fn of_mesh(self, mesh: &TriMesh, views: Option<&MultiView>) -> Result<Vec<f32>> {
        let of_shape = |mesh| saliency::mesh_saliency(mesh, &MeshSaliencyOptions::default());
        Ok(match (self, views) {
            (Self::Curvature, _) => bend(mesh)?,
            (Self::Image, Some(views)) => views.mean.clone(),
            (Self::Hybrid, Some(views)) => {
                let (bend, shape) = (bend(mesh)?, of_shape(mesh)?);
                saliency::hybrid(&bend, &shape, views, &HybridOptions::default())?.values
            }
            _ => of_shape(mesh)?,
        })
    }
}

/// One value a vertex of every mesh, 0 to 1; a mesh without triangles has zeros.
pub fn of_scene(kind: Kind, input: &Input, console: &Console) -> Result<Vec<Vec<f32>>> {
    let views = match kind {
        Kind::Image | Kind::Hybrid => look(input, console)?,
        Kind::Curvature | Kind::Mesh => Vec::new(),
    };
    let of_mesh = |(i, mesh): (usize, &TriMesh)| match mesh.triangles.is_empty() {
        true => Ok(vec![0.0; mesh.positions.len()]),
        false => kind.of_mesh(mesh, views.get(i)),
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

/// Weights for simplification, from 1 to `most`.
pub fn weights(
    kind: Kind,
    most: f32,
    input: &Input,
    console: &Console,
) -> Result<Vec<Option<Vec<f32>>>> {
    let map = WeightMap::Linear { least: 1.0, most };
    let of_mesh = |values: Vec<f32>| Ok(Some(map.weights(&values)?));
    of_scene(kind, input, console)?
        .into_iter()
        .map(of_mesh)
        .collect()
}

/// Share of the vertices whose curvature is the largest there is: a few spikes would
/// make everything else nothing.
const SPIKES: f64 = 0.01;

/// Size of the mean curvature, as a share of what nearly all vertices stay under.
fn bend(mesh: &TriMesh) -> Result<Vec<f32>> {
    let found = saliency::curvature(mesh)?;
    let mut sizes: Vec<f64> = found.iter().map(|c| c.mean().abs()).collect();
    let found = sizes.clone();
    sizes.sort_unstable_by(f64::total_cmp);
    let most = sizes[((1.0 - SPIKES) * (sizes.len() - 1) as f64) as usize];
    let share = |size: f64| {
        if most > 0.0 {
            (size / most).min(1.0)
        } else {
            0.0
        }
    };
    Ok(found.into_iter().map(|c| share(c) as f32).collect())
}
