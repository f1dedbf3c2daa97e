//! The objects of a scene.

use crate::error::{Error, Result};
use crate::geom::DMat4;
use crate::hlod::{Object, Shape};
use crate::mesh::Scene;
use crate::render::{Model, Picture};

/// A mesh that stands somewhere.
#[derive(Debug, Clone, Copy)]
pub(super) struct Placed {
    pub mesh: u32,
    pub node: u32,
    pub world_from_mesh: DMat4,
}

/// All placed meshes that have triangles, and what is perceived of them.
pub(super) fn gather(
    scene: &Scene,
    images: &[Option<Picture>],
) -> Result<(Vec<Placed>, Vec<Object>)> {
    let shapes = shapes(scene, images)?;
    let stand_in = scene.stand_ins();
    let mut objects = (Vec::new(), Vec::new());
    for instance in scene.iter_instances() {
        let shape = shapes.get(instance.mesh as usize).and_then(Option::as_ref);
        let Some(shape) = shape.filter(|_| !stand_in[instance.node as usize]) else {
            continue;
        };
        if !instance.world_from_mesh.is_finite() {
            return Err(Error::NotFinite {
                what: "matrix of node".into(),
                index: instance.node as usize,
            });
        }
        objects.1.push(shape.placed(&instance.world_from_mesh));
        objects.0.push(Placed {
            mesh: instance.mesh,
            node: instance.node,
            world_from_mesh: instance.world_from_mesh,
        });
    }
    if objects.0.is_empty() {
        return Err(Error::Empty { what: "scene" });
    }
    Ok(objects)
}

/// Of every mesh that has triangles.
fn shapes(scene: &Scene, images: &[Option<Picture>]) -> Result<Vec<Option<Shape>>> {
    let model = Model {
        meshes: scene.meshes.iter().map(|m| &m.mesh).collect(),
        instances: Vec::new(),
        materials: &scene.materials,
        textures: &scene.textures,
        images,
    };
    let shape = |(m, mesh): (usize, &&crate::mesh::TriMesh)| match mesh.triangles.is_empty() {
        true => Ok(None),
        false => Shape::of(&model, m).map(Some),
    };
    model.meshes.iter().enumerate().map(shape).collect()
}
