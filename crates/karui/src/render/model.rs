//! What the renderer is given.

use super::Picture;
use crate::error::{Error, Result};
use crate::geom::Mat4;
use crate::mesh::{Material, Scene, Texture, TextureRef, TriMesh};

/// Meshes, where they stand and what they are made of.
#[derive(Debug, Clone, Default)]
pub struct Model<'a> {
    /// Meshes; materials by range, as usual.
    pub meshes: Vec<&'a TriMesh>,
    /// Where they stand.
    pub instances: Vec<Instance>,
    /// Materials that ranges name. With none at all everything is grey, whatever
    /// ranges say.
    pub materials: &'a [Material],
    /// Textures that materials name.
    pub textures: &'a [Texture],
    /// Decoded images that textures name. One that is `None`, has no pixels or
    /// lies beyond the end is taken as missing: the material does without.
    pub images: &'a [Option<Picture>],
}

/// A mesh that stands somewhere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instance {
    /// Index into [`Model::meshes`].
    pub mesh: u32,
    /// Node of the scene it comes from, if any.
    pub node: Option<u32>,
    /// Takes the mesh's space to the world's; affine.
    pub world_from_mesh: Mat4,
}

impl<'a> Model<'a> {
    /// One mesh where it is, without materials.
    #[must_use]
    pub fn of_mesh(mesh: &'a TriMesh) -> Self {
        Self {
            meshes: vec![mesh],
            instances: vec![Instance {
                mesh: 0,
                node: None,
                world_from_mesh: Mat4::IDENTITY,
            }],
            ..Self::default()
        }
    }

    /// Every placed mesh of a scene; coarser stand-ins of nodes are left out,
    /// skins and morph targets at rest.
    #[must_use]
    pub fn of_scene(scene: &'a Scene, images: &'a [Option<Picture>]) -> Self {
        let stand_in = scene.stand_ins();
        let placed = scene.iter_instances();
        let instances = placed
            .filter(|i| !stand_in[i.node as usize])
            .map(|i| Instance {
                mesh: i.mesh,
                node: Some(i.node),
                world_from_mesh: i.world_from_mesh.as_mat4(),
            });
        Self {
            meshes: scene.meshes.iter().map(|m| &m.mesh).collect(),
            instances: instances.collect(),
            materials: &scene.materials,
            textures: &scene.textures,
            images,
        }
    }

    /// What indexing and arithmetic rely on.
    pub(super) fn check(&self) -> Result<()> {
        self.meshes
            .iter()
            .try_for_each(|mesh| self.check_mesh(mesh))?;
        for (index, instance) in self.instances.iter().enumerate() {
            let mesh = Some(instance.mesh);
            exists(("instance", index), "mesh", mesh, self.meshes.len())?;
            if !instance.world_from_mesh.is_finite() {
                let what = "matrix of instance".into();
                return Err(Error::NotFinite { what, index });
            }
        }
        for (index, material) in self.materials.iter().enumerate() {
            for texture in textures_of(material).into_iter().flatten() {
                let to = Some(texture.texture);
                exists(("material", index), "texture", to, self.textures.len())?;
            }
        }
        Ok(())
    }

    fn check_mesh(&self, mesh: &TriMesh) -> Result<()> {
        mesh.validate_indices()?;
        mesh.validate_lengths()?;
        mesh.validate_ranges()?;
        if let Some(index) = mesh.positions.iter().position(|p| !p.is_finite()) {
            let what = "position".into();
            return Err(Error::NotFinite { what, index });
        }
        if self.materials.is_empty() {
            return Ok(());
        }
        let mut ranges = mesh.ranges.iter().enumerate();
        ranges.try_for_each(|(index, range)| {
            exists(
                ("range", index),
                "material",
                range.material,
                self.materials.len(),
            )
        })
    }
}

fn textures_of(material: &Material) -> [Option<TextureRef>; 5] {
    [
        material.base_color_texture,
        material.metallic_roughness_texture,
        material.normal_texture,
        material.occlusion_texture,
        material.emissive_texture,
    ]
}

fn exists(
    (what, index): (&'static str, usize),
    target: &'static str,
    to: Option<u32>,
    count: usize,
) -> Result<()> {
    match to {
        Some(to) if to as usize >= count => Err(Error::BadReference {
            what,
            index,
            target,
            to: to as usize,
            problem: "does not exist",
        }),
        _ => Ok(()),
    }
}
