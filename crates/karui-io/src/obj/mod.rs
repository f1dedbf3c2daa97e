//! Wavefront OBJ and its material library MTL.
//!
//! A file becomes one mesh; `o` and `g` do not split it (the name of the first
//! `o` is kept), `usemtl` makes material ranges. Corners with equal indices of
//! position, texture coordinate and normal become one vertex. Lines, points
//! and free-form curves are passed over with a warning.

mod corners;
mod mtl_read;
mod mtl_write;
pub(crate) mod read;
mod write;

pub(crate) use read::read;
pub(crate) use write::write;

use karui::{
    PolyMesh, Scene,
    mesh::{Image, Material, NamedMesh, Texture},
};

/// What a file holds.
pub(crate) struct Model {
    pub mesh: PolyMesh,
    name: Option<String>,
    library: Library,
}

/// Materials with their textures and images.
#[derive(Default)]
struct Library {
    materials: Vec<Material>,
    textures: Vec<Texture>,
    images: Vec<Image>,
}

impl Model {
    /// As a scene of one mesh, triangulated.
    pub fn into_scene(self) -> Scene {
        let mut scene = Scene::from_mesh(self.mesh.triangulate());
        let name = self.name;
        let mesh = scene.meshes.pop().map(|m| m.mesh).unwrap_or_default();
        scene.meshes.push(NamedMesh { name, mesh });
        scene.materials = self.library.materials;
        scene.textures = self.library.textures;
        scene.images = self.library.images;
        scene
    }
}

#[cfg(test)]
mod tests;
