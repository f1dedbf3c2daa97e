//! Other libraries: meshoptimizer by A. Kapoulkine, through the crate
//! `meshopt`, if built with the feature `peers`.

use super::super::clock::{Cost, Watch};
use super::contestants::MODES;
use super::inputs::Kind;
use crate::failure::Failure;
use anyhow::Result;
use karui::TriMesh;

/// A function of meshoptimizer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Peer {
    /// `meshopt_simplify`.
    Simplify,
    /// `meshopt_simplifyWithUpdate` without attributes.
    Update,
    /// `meshopt_simplifySloppy`.
    Sloppy,
    /// `meshopt_simplifyWithAttributes`.
    Attributes,
    /// `meshopt_simplifyWithUpdate` with attributes.
    AttributesUpdate,
}

const ALL: [Peer; 5] = [
    Peer::Simplify,
    Peer::Update,
    Peer::Sloppy,
    Peer::Attributes,
    Peer::AttributesUpdate,
];

/// Those that take part in a comparison of this kind.
pub fn of(kind: Kind) -> &'static [Peer] {
    match kind {
        Kind::Geometry => &ALL[..3],
        Kind::Attributes => &ALL[3..],
    }
}

/// The peer that ours of this name is put in relation to: the closest of them,
/// or the one as loose.
pub fn reference(kind: Kind, ours: &str) -> Peer {
    match kind {
        Kind::Geometry if is_loose(ours) => Peer::Sloppy,
        Kind::Geometry => Peer::Update,
        Kind::Attributes => Peer::AttributesUpdate,
    }
}

/// Whether two of these names promise the same: to keep the topology, or not.
pub fn are_alike(ours: &str, other: &str) -> bool {
    is_loose(ours) == (other == Peer::Sloppy.name())
}

fn is_loose(ours: &str) -> bool {
    MODES.iter().any(|m| m.name == ours && m.loose)
}

impl Peer {
    /// The peer of this name.
    pub fn named(name: &str) -> Option<Self> {
        ALL.into_iter().find(|p| p.name() == name)
    }

    /// Short, in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Simplify => "meshopt simplify",
            Self::Update => "meshopt update",
            Self::Sloppy => "meshopt sloppy",
            Self::Attributes => "meshopt attributes",
            Self::AttributesUpdate => "meshopt attributes+update",
        }
    }

    /// See [`Contestant::run`](super::contestants::Contestant::run).
    pub fn run(self, mesh: &TriMesh, triangles: usize, watch: Watch) -> Result<(TriMesh, Cost)> {
        require()?;
        run(self, mesh, triangles, watch)
    }
}

/// Refuses if this build has no peers.
pub fn require() -> Result<()> {
    if cfg!(feature = "peers") {
        return Ok(());
    }
    let message = "this build has no other libraries in it";
    let hint = "cargo run --release -p karui-cli --features peers -- bench simplify --peers";
    Err(Failure::input(message).hint(hint).into())
}

#[cfg(not(feature = "peers"))]
fn run(_: Peer, mesh: &TriMesh, _: usize, watch: Watch) -> Result<(TriMesh, Cost)> {
    // Never reached: `require` came before.
    Ok(watch.call(|| mesh.clone()))
}

#[cfg(feature = "peers")]
fn run(peer: Peer, mesh: &TriMesh, triangles: usize, watch: Watch) -> Result<(TriMesh, Cost)> {
    let work = calls::Work::new(mesh, triangles, watch);
    match peer {
        Peer::Simplify => work.simplify(),
        Peer::Update => work.update(Vec::new(), &[]),
        Peer::Sloppy => work.sloppy(),
        Peer::Attributes => work.attributes(),
        Peer::AttributesUpdate => work.attributes_update(),
    }
}

#[cfg(feature = "peers")]
mod calls {
    //! The calls, all to a triangle count without bound on the error.

    use super::{Cost, Result, TriMesh, Watch};
    use bytemuck::{cast_slice, cast_slice_mut};
    use glam::{Vec2, Vec3};
    use meshopt::{SimplifyOptions, VertexDataAdapter};

    /// Influence of a normal off by 1, as in the library's own programs, and
    /// of a texture coordinate off by 1, as if the texture covered the model.
    const NORMAL: [f32; 3] = [0.5; 3];
    const UV: [f32; 2] = [1.0; 2];

    /// The input of a call, copied so that the call may overwrite it.
    pub struct Work<'a> {
        mesh: &'a TriMesh,
        positions: Vec<Vec3>,
        indices: Vec<u32>,
        target: usize,
        watch: Watch,
    }

    impl<'a> Work<'a> {
        pub fn new(mesh: &'a TriMesh, triangles: usize, watch: Watch) -> Self {
            Self {
                mesh,
                positions: mesh.positions.clone(),
                indices: cast_slice(&mesh.triangles).to_vec(),
                target: 3 * triangles,
                watch,
            }
        }

        pub fn simplify(self) -> Result<(TriMesh, Cost)> {
            let vertices = self.vertices()?;
            let none = SimplifyOptions::None;
            let call =
                || meshopt::simplify(&self.indices, &vertices, self.target, f32::MAX, none, None);
            let (indices, cost) = self.watch.call(call);
            Ok((self.with(indices), cost))
        }

        pub fn sloppy(self) -> Result<(TriMesh, Cost)> {
            let vertices = self.vertices()?;
            let call =
                || meshopt::simplify_sloppy(&self.indices, &vertices, self.target, 1.0, None);
            let (indices, cost) = self.watch.call(call);
            Ok((self.with(indices), cost))
        }

        pub fn attributes(self) -> Result<(TriMesh, Cost)> {
            let vertices = self.vertices()?;
            let (values, weights) = interleaved(self.mesh);
            // The call reads a lock of every vertex, even if none is locked.
            let locks = vec![false; self.positions.len()];
            let call = || {
                meshopt::simplify_with_attributes_and_locks(
                    &self.indices,
                    &vertices,
                    &values,
                    &weights,
                    4 * weights.len(),
                    &locks,
                    self.target,
                    f32::MAX,
                    SimplifyOptions::None,
                    None,
                )
            };
            let (indices, cost) = self.watch.call(call);
            Ok((self.with(indices), cost))
        }

        pub fn attributes_update(self) -> Result<(TriMesh, Cost)> {
            let (values, weights) = interleaved(self.mesh);
            self.update(values, &weights)
        }

        pub fn update(mut self, mut values: Vec<f32>, weights: &[f32]) -> Result<(TriMesh, Cost)> {
            let call = || {
                meshopt::simplify_with_update(
                    &mut self.indices,
                    cast_slice_mut(&mut self.positions),
                    &mut values,
                    weights,
                    4 * weights.len(),
                    None,
                    self.target,
                    f32::MAX,
                    SimplifyOptions::None,
                    None,
                )
            };
            let (count, cost) = self.watch.call(call);
            let mut indices = std::mem::take(&mut self.indices);
            indices.truncate(count);
            let mut mesh = self.mesh.clone();
            mesh.positions = std::mem::take(&mut self.positions);
            put_back(&mut mesh, &values, weights.len());
            Ok((with_triangles(mesh, indices), cost))
        }

        fn vertices(&self) -> Result<VertexDataAdapter<'_>> {
            Ok(VertexDataAdapter::new(cast_slice(&self.positions), 12, 0)?)
        }

        fn with(&self, indices: Vec<u32>) -> TriMesh {
            with_triangles(self.mesh.clone(), indices)
        }
    }

    fn with_triangles(mut mesh: TriMesh, mut indices: Vec<u32>) -> TriMesh {
        indices.shrink_to_fit();
        let mut triangles = Vec::with_capacity(indices.len() / 3);
        triangles.extend(indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]));
        mesh.triangles = triangles;
        mesh.remove_unreferenced_vertices();
        mesh
    }

    /// Normals and texture coordinates, vertex by vertex, and their weights.
    fn interleaved(mesh: &TriMesh) -> (Vec<f32>, Vec<f32>) {
        let normals = mesh.attributes.normals.as_deref();
        let uvs = mesh.attributes.uvs.first().map(Vec::as_slice);
        let mut values = Vec::new();
        for v in 0..mesh.positions.len() {
            values.extend(normals.iter().flat_map(|n| n[v].to_array()));
            values.extend(uvs.iter().flat_map(|uv| uv[v].to_array()));
        }
        let mut weights = Vec::new();
        weights.extend(normals.iter().flat_map(|_| NORMAL));
        weights.extend(uvs.iter().flat_map(|_| UV));
        (values, weights)
    }

    /// The reverse of [`interleaved`]; normals get length 1, as the library
    /// tells its users to do.
    fn put_back(mesh: &mut TriMesh, values: &[f32], width: usize) {
        let mut uv_at = 0;
        if let Some(normals) = &mut mesh.attributes.normals {
            uv_at = 3;
            for (normal, of_vertex) in normals.iter_mut().zip(values.chunks_exact(width.max(1))) {
                *normal = Vec3::from_slice(of_vertex).normalize_or(*normal);
            }
        }
        if let Some(uvs) = mesh.attributes.uvs.first_mut() {
            for (uv, of_vertex) in uvs.iter_mut().zip(values.chunks_exact(width.max(1))) {
                *uv = Vec2::from_slice(&of_vertex[uv_at..]);
            }
        }
    }
}
