//! Every place where a mesh of a scene stands.

use super::{Node, Placements, Scene};
use crate::error::{Error, Result};
use crate::geom::Aabb;
use glam::{DMat4, DVec3, Mat4, Vec3};

/// Vertices or triangles that repeated meshes may be unfolded to, unless the
/// meshes have more by themselves: 64 Mi, some gigabytes.
const UNFOLDED: usize = 1 << 26;

/// A mesh that stands somewhere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instance {
    /// Index into [`Scene::nodes`].
    pub node: u32,
    /// Index into [`Scene::meshes`], as the node says it; only a valid scene
    /// has that mesh.
    pub mesh: u32,
    /// Which of the node's placements it is, if the node has any.
    pub placement: Option<u32>,
    /// Takes the mesh's space to the world's.
    pub world_from_mesh: DMat4,
}

impl Scene {
    /// Calls `each` with every instance: nodes depth-first from the roots, the
    /// placements of a node in their order. A node is visited once even if a
    /// damaged tree names it twice.
    ///
    /// Matrices are composed in `f64`, so that an object deep below nodes with
    /// large translations stands where it should.
    pub fn for_each_instance(&self, each: impl FnMut(Instance)) {
        self.iter_instances().for_each(each);
    }

    /// The instances that [`Scene::for_each_instance`] visits, one at a time:
    /// a million cost no memory.
    pub fn iter_instances(&self) -> impl Iterator<Item = Instance> + '_ {
        Walk::new(self).flat_map(|(n, world_from_node)| {
            let node = &self.nodes[n as usize];
            let mesh = node.mesh.unwrap_or_default();
            let count = if node.mesh.is_some() {
                node.placement_count()
            } else {
                0
            };
            (0..count).map(move |i| Instance {
                node: n,
                mesh,
                placement: node.placements.is_some().then_some(i as u32),
                world_from_mesh: node.placed(world_from_node, i),
            })
        })
    }

    /// Every placed mesh: node index and the matrix that takes the mesh's
    /// space to the world's, in the order of [`Scene::for_each_instance`]. A
    /// node with [`Node::placements`] is listed once for each, 80 bytes;
    /// [`Scene::iter_instances`] needs no list.
    #[must_use]
    pub fn instances(&self) -> Vec<(u32, Mat4)> {
        let rounded = |i: Instance| (i.node, i.world_from_mesh.as_mat4());
        self.iter_instances().map(rounded).collect()
    }

    /// Number of instances.
    #[must_use]
    pub fn instance_count(&self) -> usize {
        let counts = Walk::new(self).map(|(n, _)| {
            let node = &self.nodes[n as usize];
            node.mesh.map_or(0, |_| node.placement_count())
        });
        counts.fold(0, usize::saturating_add)
    }

    /// Bytes that all [`Node::placements`] take; those that nodes share are
    /// counted once.
    #[must_use]
    pub fn placement_memory(&self) -> usize {
        let mut known: Vec<&std::sync::Arc<Placements>> = self
            .nodes
            .iter()
            .filter_map(|n| n.placements.as_ref())
            .collect();
        known.sort_by_key(|p| std::sync::Arc::as_ptr(p));
        known.dedup_by_key(|p| std::sync::Arc::as_ptr(p));
        known.iter().map(|p| p.memory()).sum()
    }

    /// Box around all placed meshes in the world's space; skins, which would
    /// move their meshes, are left aside.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        let boxes: Vec<Aabb> = self.meshes.iter().map(|m| m.mesh.bounds()).collect();
        let mut bounds = Aabb::EMPTY;
        self.for_each_instance(|instance| {
            let m = instance.mesh as usize;
            let Some(named) = self.meshes.get(m).filter(|_| !boxes[m].is_empty()) else {
                return;
            };
            let place = |p: Vec3| instance.world_from_mesh.transform_point3(p.as_dvec3());
            // What lies within the box so far cannot widen it.
            if !corners(boxes[m]).all(|p| holds(bounds, place(p))) {
                let placed = named.mesh.positions.iter().map(|&p| place(p).as_vec3());
                bounds = placed.fold(bounds, Aabb::with);
            }
        });
        bounds
    }

    /// Checks that a copy of each mesh for each of its instances would have at
    /// most 2^26 vertices and triangles, or as many as the meshes themselves.
    ///
    /// # Errors
    /// [`Error::Unfolds`].
    pub fn check_unfolded(&self) -> Result<()> {
        let [vertices, triangles] = self.unfolded();
        let alone = |len: fn(&super::TriMesh) -> usize| {
            let lens = self.meshes.iter().map(|m| len(&m.mesh));
            lens.sum::<usize>().max(UNFOLDED)
        };
        let within = |what, found: usize, limit: usize| {
            if found <= limit {
                return Ok(());
            }
            Err(Error::Unfolds { what, found, limit })
        };
        within("vertices", vertices, alone(|m| m.positions.len()))?;
        within("triangles", triangles, alone(|m| m.triangles.len()))
    }

    /// Vertices and triangles of all instances.
    #[must_use]
    pub fn unfolded(&self) -> [usize; 2] {
        let mut sum = [0usize; 2];
        for (n, _) in Walk::new(self) {
            let node = &self.nodes[n as usize];
            let mesh = node.mesh.and_then(|m| self.meshes.get(m as usize));
            let Some(mesh) = mesh.map(|m| &m.mesh) else {
                continue;
            };
            for (sum, len) in sum
                .iter_mut()
                .zip([mesh.positions.len(), mesh.triangles.len()])
            {
                *sum = sum.saturating_add(len.saturating_mul(node.placement_count()));
            }
        }
        sum
    }
}

impl Node {
    /// How often the node shows its mesh, if it has one.
    #[must_use]
    pub fn placement_count(&self) -> usize {
        self.placements.as_ref().map_or(1, |p| p.len())
    }

    fn placed(&self, world_from_node: DMat4, i: usize) -> DMat4 {
        match &self.placements {
            Some(placements) => world_from_node * placements.matrix_f64(i),
            None => world_from_node,
        }
    }
}

fn corners(of: Aabb) -> impl Iterator<Item = Vec3> {
    let pick = move |i: usize, bit: usize| if i & bit == 0 { of.min } else { of.max };
    (0..8).map(move |i| Vec3::new(pick(i, 1).x, pick(i, 2).y, pick(i, 4).z))
}

fn holds(bounds: Aabb, point: DVec3) -> bool {
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    point.cmpge(min).all() && point.cmple(max).all()
}

/// Nodes below the roots with the matrices that take their space to the
/// world's, depth-first, each once.
struct Walk<'a> {
    scene: &'a Scene,
    seen: Vec<bool>,
    stack: Vec<(u32, DMat4)>,
}

impl<'a> Walk<'a> {
    fn new(scene: &'a Scene) -> Self {
        let roots = scene.roots.iter().rev();
        Self {
            scene,
            seen: vec![false; scene.nodes.len()],
            stack: roots.map(|&r| (r, DMat4::IDENTITY)).collect(),
        }
    }
}

impl Iterator for Walk<'_> {
    type Item = (u32, DMat4);

    fn next(&mut self) -> Option<Self::Item> {
        while let Some((n, world_from_parent)) = self.stack.pop() {
            let Some(node) = self.scene.nodes.get(n as usize) else {
                continue;
            };
            if std::mem::replace(&mut self.seen[n as usize], true) {
                continue;
            }
            let world_from_node = world_from_parent * node.transform.matrix_f64();
            let children = node.children.iter().rev();
            self.stack.extend(children.map(|&c| (c, world_from_node)));
            return Some((n, world_from_node));
        }
        None
    }
}

#[cfg(test)]
mod tests;
