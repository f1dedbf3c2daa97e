//! `--saliency`: how much every vertex matters.

use crate::input::Input;
use anyhow::Result;
use clap::ValueEnum;
use karui::TriMesh;
use karui::saliency::{self, MeshSaliencyOptions, WeightMap};

/// Ways to tell what matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Kind {
    /// How strongly the surface bends
    Curvature,
    /// Where it bends otherwise than around it (Lee, Varshney & Jacobs 2005)
    Mesh,
}

impl Kind {
    /// As on the command line.
    pub fn name(self) -> String {
        let value = self.to_possible_value();
        value.map_or(String::new(), |v| v.get_name().to_owned())
    }

    /// One value a vertex, 0 to 1.
    fn of_mesh(self, mesh: &TriMesh) -> Result<Vec<f32>> {
        Ok(match self {
            Self::Curvature => bend(mesh)?,
            Self::Mesh => saliency::mesh_saliency(mesh, &MeshSaliencyOptions::default())?,
        })
    }
}

/// One value a vertex of every mesh, 0 to 1; a mesh without triangles has zeros.
pub fn of_scene(kind: Kind, input: &Input) -> Result<Vec<Vec<f32>>> {
    let of_mesh = |mesh: &TriMesh| match mesh.triangles.is_empty() {
        true => Ok(vec![0.0; mesh.positions.len()]),
        false => kind.of_mesh(mesh),
    };
    let meshes = input.scene.meshes.iter();
    meshes.map(|m| of_mesh(&m.mesh)).collect()
}

/// Weights for simplification, from 1 to `most`.
pub fn weights(kind: Kind, most: f32, input: &Input) -> Result<Vec<Option<Vec<f32>>>> {
    let map = WeightMap::Linear { least: 1.0, most };
    let of_mesh = |values: Vec<f32>| Ok(Some(map.weights(&values)?));
    of_scene(kind, input)?.into_iter().map(of_mesh).collect()
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
