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
mod tags;
mod write;

pub(crate) use read::{read, read_control};
pub(crate) use write::write;

use karui::{
    PolyMesh, Scene, TriMesh,
    mesh::{Image, Material, NamedMesh, Texture},
    subdiv::ControlMesh,
};

/// What a file holds.
pub(crate) struct Model {
    pub mesh: PolyMesh,
    name: Option<String>,
    library: Library,
}

/// What a file holds, as a control mesh.
pub(crate) struct Control {
    pub mesh: ControlMesh,
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
        self.library.into_scene(self.name, self.mesh.triangulate())
    }
}

impl Control {
    /// The mesh, and a scene with its materials and an empty mesh in its place.
    pub fn into_parts(self) -> (ControlMesh, Scene) {
        let scene = self.library.into_scene(self.name, TriMesh::default());
        (self.mesh, scene)
    }
}

impl Library {
    fn into_scene(self, name: Option<String>, mesh: TriMesh) -> Scene {
        Scene {
            materials: self.materials,
            textures: self.textures,
            images: self.images,
            meshes: vec![NamedMesh { name, mesh }],
            ..Scene::from_mesh(TriMesh::default())
        }
    }
}

#[cfg(test)]
mod tests;
