//! Whether every reference of a scene leads somewhere and its nodes are trees.

use super::{Material, Node, Scene, TextureRef, Transform};
use crate::error::{Error, Result};

const MISSING: &str = "does not exist";

impl Scene {
    /// Checks every mesh (see [`TriMesh::validate`](super::TriMesh::validate))
    /// and every reference; that no node is its own ancestor or has two
    /// parents; and that transforms and placements are finite.
    ///
    /// # Errors
    /// The first fault found: [`Error::BadReference`], [`Error::NotFinite`] or
    /// a mesh's own.
    pub fn validate(&self) -> Result<()> {
        self.validate_references()?;
        self.validate_tree()?;
        self.meshes.iter().try_for_each(|m| m.mesh.validate())
    }

    /// Only the part of [`Scene::validate`] that indexing relies on.
    fn validate_references(&self) -> Result<()> {
        let ranges = self.meshes.iter().enumerate();
        for (m, range) in ranges.flat_map(|(m, mesh)| mesh.mesh.ranges.iter().map(move |r| (m, r)))
        {
            exists("mesh", m, "material", range.material, self.materials.len())?;
        }
        for (m, texture) in self.materials.iter().enumerate().flat_map(texture_uses) {
            exists(
                "material",
                m,
                "texture",
                Some(texture.texture),
                self.textures.len(),
            )?;
        }
        for (t, texture) in self.textures.iter().enumerate() {
            exists("texture", t, "image", texture.image, self.images.len())?;
        }
        for (n, node) in self.nodes.iter().enumerate() {
            self.validate_node(n, node)?;
        }
        let mut roots = self.roots.iter().enumerate();
        roots.try_for_each(|(r, &node)| exists("root", r, "node", Some(node), self.nodes.len()))
    }

    fn validate_node(&self, n: usize, node: &Node) -> Result<()> {
        exists("node", n, "mesh", node.mesh, self.meshes.len())?;
        let lods = node.lods.iter().flat_map(|lods| &lods.nodes);
        for &other in node.children.iter().chain(lods.clone()) {
            exists("node", n, "node", Some(other), self.nodes.len())?;
        }
        if lods.clone().any(|&lod| lod as usize == n) {
            return Err(bad_node(n, n as u32, "is its own level of detail"));
        }
        if !is_finite(&node.transform) {
            return Err(Error::NotFinite {
                what: "transform of node".into(),
                index: n,
            });
        }
        node.placements.as_ref().map_or(Ok(()), |p| p.validate())
    }

    /// With at most one parent each, nodes form a cycle only where walking up
    /// never ends.
    fn validate_tree(&self) -> Result<()> {
        let mut parent: Vec<Option<usize>> = vec![None; self.nodes.len()];
        for (n, node) in self.nodes.iter().enumerate() {
            for &child in &node.children {
                if parent[child as usize].replace(n).is_some() {
                    return Err(bad_node(n, child, "has two parents"));
                }
            }
        }
        let mut walk_of = vec![usize::MAX; self.nodes.len()];
        for start in 0..self.nodes.len() {
            let mut n = start;
            while walk_of[n] == usize::MAX {
                walk_of[n] = start;
                match parent[n] {
                    Some(up) if walk_of[up] == start => {
                        return Err(bad_node(up, n as u32, "is its own ancestor"));
                    }
                    Some(up) => n = up,
                    None => break,
                }
            }
        }
        Ok(())
    }
}

fn exists(
    what: &'static str,
    index: usize,
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
            problem: MISSING,
        }),
        _ => Ok(()),
    }
}

fn bad_node(from: usize, to: u32, problem: &'static str) -> Error {
    Error::BadReference {
        what: "node",
        index: from,
        target: "node",
        to: to as usize,
        problem,
    }
}

fn texture_uses((m, material): (usize, &Material)) -> impl Iterator<Item = (usize, TextureRef)> {
    let all = [
        material.base_color_texture,
        material.metallic_roughness_texture,
        material.normal_texture,
        material.occlusion_texture,
        material.emissive_texture,
    ];
    all.into_iter().flatten().map(move |texture| (m, texture))
}

fn is_finite(transform: &Transform) -> bool {
    match transform {
        Transform::Trs {
            translation,
            rotation,
            scale,
        } => translation.is_finite() && rotation.is_finite() && scale.is_finite(),
        Transform::Matrix(matrix) => matrix.is_finite(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{LodLinks, Texture, Wrap, shapes};
    use glam::Mat4;

    type Fault = fn(&mut Scene);

    fn scene() -> Scene {
        let mut scene = Scene::from_mesh(shapes::loaded_sphere(3, 4));
        let texture = |texture| {
            Some(TextureRef {
                texture,
                uv_set: 0,
                transform: None,
            })
        };
        scene.materials = vec![Material::default(), Material::default()];
        scene.materials[1].normal_texture = texture(0);
        scene.textures = vec![Texture {
            image: None,
            wrap: [Wrap::Repeat; 2],
            nearest: false,
        }];
        scene.nodes[0].children = vec![1, 2];
        scene.nodes.extend([Node::default(), Node::default()]);
        scene.nodes[1].lods = Some(LodLinks {
            nodes: vec![2],
            coverage: vec![],
        });
        scene
    }

    #[test]
    fn faults_are_named() {
        let faults: [(&str, Fault); 12] = [
            ("mesh 0 refers to material 1, which does not exist", |s| {
                s.materials.truncate(1)
            }),
            (
                "material 1 refers to texture 0, which does not exist",
                |s| s.textures.clear(),
            ),
            ("texture 0 refers to image 5, which does not exist", |s| {
                s.textures[0].image = Some(5)
            }),
            ("node 0 refers to mesh 7, which does not exist", |s| {
                s.nodes[0].mesh = Some(7)
            }),
            ("node 2 refers to node 3, which does not exist", |s| {
                s.nodes[2].children = vec![3]
            }),
            ("root 1 refers to node 9, which does not exist", |s| {
                s.roots.push(9)
            }),
            (
                "node 1 refers to node 1, which is its own level of detail",
                |s| {
                    s.nodes[1].lods = Some(LodLinks {
                        nodes: vec![1],
                        coverage: vec![],
                    });
                },
            ),
            ("node 1 refers to node 2, which has two parents", |s| {
                s.nodes[1].children = vec![2]
            }),
            ("node 0 refers to node 1, which has two parents", |s| {
                s.nodes[0].children = vec![1, 1]
            }),
            ("node 0 refers to node 2, which is its own ancestor", |s| {
                s.nodes[2].children = vec![0]
            }),
            ("transform of node 2 is not finite", |s| {
                s.nodes[2].transform = Transform::Matrix(Mat4::NAN);
            }),
            ("position 0 is not finite", |s| {
                s.meshes[0].mesh.positions[0].x = f32::NAN
            }),
        ];
        scene().validate().unwrap();
        for (message, fault) in faults {
            let mut scene = scene();
            fault(&mut scene);
            assert_eq!(scene.validate().unwrap_err().to_string(), message);
        }
    }

    #[test]
    fn long_chains_are_walked_once() {
        let with_child = |n| Node {
            children: vec![n],
            ..Node::default()
        };
        let mut scene = Scene {
            nodes: (1..200_001).map(with_child).collect(),
            ..Scene::default()
        };
        scene.nodes.push(Node::default());
        scene.validate().unwrap();
        scene.nodes[200_000].children = vec![100_000];
        assert!(scene.validate().is_err());
        scene.nodes[200_000].children = vec![0];
        assert!(scene.validate().is_err());
    }
}
