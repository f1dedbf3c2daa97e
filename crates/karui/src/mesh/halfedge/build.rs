//! Half-edges from faces.

use super::{Halfedge, NONE};
use crate::error::{Error, Result};
use crate::mesh::edges::{Corners, EdgeTable, TriangleCorners, is_proper};
use crate::mesh::{PolyMesh, PositionIds, TriMesh};

impl Halfedge {
    /// Connectivity of `triangles` over the vertices `0..vertices`.
    ///
    /// # Errors
    /// [`Error::IndexOutOfRange`], [`Error::TooLarge`],
    /// [`Error::DegenerateFace`], [`Error::NonManifoldEdge`],
    /// [`Error::InconsistentEdge`] or [`Error::NonManifoldVertex`], each naming
    /// the first element at fault. [`repair`](crate::mesh::repair) removes the
    /// last four.
    pub fn new(triangles: &[[u32; 3]], vertices: usize) -> Result<Self> {
        let is_bad = |&v: &u32| v as usize >= vertices;
        for (face, &t) in triangles.iter().enumerate() {
            if let Some(index) = t.into_iter().find(is_bad) {
                return Err(Error::IndexOutOfRange {
                    face,
                    index,
                    vertices,
                });
            }
            if !is_proper(t) {
                return Err(Error::DegenerateFace { face });
            }
        }
        build(&TriangleCorners(triangles), triangles.len(), vertices)
    }

    /// Connectivity of a mesh whose vertices are linked by `ids`: the vertices
    /// of the result are position ids, so a UV seam is no boundary.
    ///
    /// # Errors
    /// As [`Halfedge::new`]; [`Error::LengthMismatch`] if `ids` belong to
    /// another mesh.
    pub fn of_mesh(mesh: &TriMesh, ids: &PositionIds) -> Result<Self> {
        ids.validate_for(mesh)?;
        Self::new(&ids.triangles(&mesh.triangles), ids.count)
    }

    /// Connectivity of a polygon mesh over its vertices.
    ///
    /// # Errors
    /// As [`Halfedge::new`]; [`Error::LengthMismatch`] if the offsets do not
    /// fit the indices.
    pub fn of_poly_mesh(mesh: &PolyMesh) -> Result<Self> {
        let corners = PolyCorners::new(mesh)?;
        build(&corners, mesh.face_count(), mesh.positions.len())
    }
}

impl Corners for PolyCorners<'_> {
    fn len(&self) -> usize {
        self.mesh.indices.len()
    }

    fn vertex(&self, c: u32) -> u32 {
        self.mesh.indices[c as usize]
    }

    fn next(&self, c: u32) -> u32 {
        let face = self.face(c) as usize;
        let [first, end] = [self.mesh.offsets[face], self.mesh.offsets[face + 1]];
        if c + 1 == end { first } else { c + 1 }
    }

    fn face(&self, c: u32) -> u32 {
        self.face_of[c as usize]
    }

    fn is_used(&self, _: u32) -> bool {
        true
    }
}

struct PolyCorners<'a> {
    mesh: &'a PolyMesh,
    face_of: Vec<u32>,
}

impl<'a> PolyCorners<'a> {
    fn new(mesh: &'a PolyMesh) -> Result<Self> {
        let vertices = mesh.positions.len();
        let mut face_of = Vec::with_capacity(mesh.indices.len());
        for (face, range) in mesh.offsets.windows(2).enumerate() {
            let found = mesh.indices.get(range[0] as usize..range[1] as usize);
            let corners = found.ok_or_else(|| bad_offsets(mesh))?;
            if let Some(&index) = corners.iter().find(|&&v| v as usize >= vertices) {
                return Err(Error::IndexOutOfRange {
                    face,
                    index,
                    vertices,
                });
            }
            if !all_differ(corners) {
                return Err(Error::DegenerateFace { face });
            }
            face_of.extend(corners.iter().map(|_| face as u32));
        }
        if face_of.len() != mesh.indices.len() || mesh.offsets.first() != Some(&0) {
            return Err(bad_offsets(mesh));
        }
        Ok(Self { mesh, face_of })
    }
}

fn bad_offsets(mesh: &PolyMesh) -> Error {
    Error::LengthMismatch {
        what: "faces by `offsets`".into(),
        expected: mesh.indices.len(),
        found: mesh.offsets.last().map_or(0, |&end| end as usize),
    }
}

fn all_differ(corners: &[u32]) -> bool {
    let mut sorted: smallvec::SmallVec<[u32; 8]> = corners.into();
    sorted.sort_unstable();
    corners.len() >= 3 && sorted.windows(2).all(|w| w[0] != w[1])
}

fn build(mesh: &impl Corners, faces: usize, vertices: usize) -> Result<Halfedge> {
    at_most(u32::MAX as usize / 2, "face corners", mesh.len())?;
    at_most(u32::MAX as usize, "vertices", vertices)?;
    let edges = EdgeTable::new(mesh, vertices);
    let (mut topology, half_of_corner) = number_halves(mesh, &edges)?;
    topology.of_face = vec![NONE; faces];
    for c in (0..mesh.len() as u32).rev() {
        let (h, n) = (
            half_of_corner[c as usize],
            half_of_corner[mesh.next(c) as usize],
        );
        topology.next[h as usize] = n;
        topology.prev[n as usize] = h;
        topology.of_face[mesh.face(c) as usize] = h;
    }
    topology.anchor_vertices(vertices);
    topology.link_boundary()?;
    topology.check_fans()?;
    Ok(topology)
}

fn at_most(limit: usize, what: &'static str, found: usize) -> Result<()> {
    if found > limit {
        return Err(Error::TooLarge { what, found, limit });
    }
    Ok(())
}

/// Gives every edge its two numbers; also returns the half of every corner.
fn number_halves(mesh: &impl Corners, edges: &EdgeTable) -> Result<(Halfedge, Vec<u32>)> {
    let halves = 2 * edges.len();
    let mut topology = Halfedge {
        origin: Vec::with_capacity(halves),
        next: vec![NONE; halves],
        prev: vec![NONE; halves],
        face: Vec::with_capacity(halves),
        of_vertex: Vec::new(),
        of_face: Vec::new(),
    };
    let mut half_of_corner = vec![NONE; mesh.len()];
    for corners in edges.iter() {
        let (first, second) = pair(mesh, corners)?;
        half_of_corner[first as usize] = topology.origin.len() as u32;
        if let Some(second) = second {
            half_of_corner[second as usize] = topology.origin.len() as u32 + 1;
        }
        topology.origin.extend(mesh.edge(first));
        let second_face = second.map_or(NONE, |c| mesh.face(c));
        topology.face.extend([mesh.face(first), second_face]);
    }
    Ok((topology, half_of_corner))
}

/// The one or two corners of a manifold edge.
fn pair(mesh: &impl Corners, corners: &[u32]) -> Result<(u32, Option<u32>)> {
    let [a, b] = corners.first().map_or([NONE; 2], |&c| mesh.edge(c));
    match *corners {
        [c] => Ok((c, None)),
        [c, d] if mesh.vertex(d) == b => Ok((c, Some(d))),
        [c, d] => Err(Error::InconsistentEdge {
            a,
            b,
            first: mesh.face(c) as usize,
            second: mesh.face(d) as usize,
        }),
        _ => Err(Error::NonManifoldEdge {
            a,
            b,
            faces: corners.len(),
        }),
    }
}

impl Halfedge {
    fn anchor_vertices(&mut self, vertices: usize) {
        self.of_vertex = vec![NONE; vertices];
        for (h, &v) in self.origin.iter().enumerate().rev() {
            self.of_vertex[v as usize] = h as u32;
        }
    }

    /// Joins the halves without face into loops. Every vertex has as many of
    /// them coming as going, so a vertex with one always has a next.
    fn link_boundary(&mut self) -> Result<()> {
        let boundary = || (0..self.face.len()).filter(|&h| self.face[h] == NONE);
        let mut leaving = self.of_vertex.clone();
        for h in boundary() {
            let v = self.origin[h];
            let previous = std::mem::replace(&mut leaving[v as usize], h as u32);
            if self.face[previous as usize] == NONE && previous < h as u32 {
                return Err(Error::NonManifoldVertex { vertex: v });
            }
        }
        let followers: Vec<(usize, u32)> = boundary()
            .map(|h| (h, leaving[self.origin[h ^ 1] as usize]))
            .collect();
        for (h, follower) in followers {
            self.next[h] = follower;
            self.prev[follower as usize] = h as u32;
        }
        self.of_vertex = leaving;
        Ok(())
    }

    /// Whether going around each vertex meets all half-edges that leave it.
    fn check_fans(&self) -> Result<()> {
        let mut unseen = vec![0u32; self.of_vertex.len()];
        for &v in &self.origin {
            unseen[v as usize] += 1;
        }
        for (v, &leaving) in unseen.iter().enumerate() {
            let vertex = v as u32;
            if self.ring(super::VertexId(vertex)).count() != leaving as usize {
                return Err(Error::NonManifoldVertex { vertex });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::halfedge::{FaceId, VertexId};
    use glam::Vec3;

    /// A cube of six quads without its last `open` faces.
    fn quad_cube(open: usize) -> PolyMesh {
        let faces = [
            [0, 1, 3, 2],
            [4, 6, 7, 5],
            [0, 4, 5, 1],
            [2, 3, 7, 6],
            [0, 2, 6, 4],
            [1, 5, 7, 3],
        ];
        let mut mesh = PolyMesh {
            positions: vec![Vec3::ZERO; 8],
            ..PolyMesh::default()
        };
        faces[open..].iter().for_each(|f| mesh.push_face(f));
        mesh
    }

    #[test]
    fn quads_keep_their_corners() {
        let mesh = quad_cube(0);
        let topology = Halfedge::of_poly_mesh(&mesh).unwrap();
        topology.validate().unwrap();
        assert_eq!(topology.edge_count(), 12);
        assert_eq!(topology.euler_characteristic(), 2);
        for (f, face) in mesh.faces().enumerate() {
            let found: Vec<u32> = topology
                .face_vertices(FaceId(f as u32))
                .map(|v| v.0)
                .collect();
            assert_eq!(found, face);
        }
        for v in 0..8 {
            assert_eq!(topology.neighbors(VertexId(v)).count(), 3);
        }
    }

    #[test]
    fn holes_are_loops() {
        let topology = Halfedge::of_poly_mesh(&quad_cube(1)).unwrap();
        let [hole] = topology.boundary_loops()[..] else {
            panic!("one hole");
        };
        let around: Vec<u32> = topology
            .loop_from(hole)
            .map(|h| topology.origin(h).0)
            .collect();
        assert_eq!(around.len(), 4);
        assert!(
            [0, 1, 2, 3]
                .iter()
                .all(|&v| topology.is_boundary_vertex(VertexId(v)))
        );
        assert!(!topology.is_boundary_vertex(VertexId(4)));
        // Without two opposite faces the cube is a tube.
        assert_eq!(
            Halfedge::of_poly_mesh(&quad_cube(2))
                .unwrap()
                .boundary_loops()
                .len(),
            2
        );
    }

    #[test]
    fn more_vertices_than_ids_are_an_error() {
        let error = Halfedge::new(&[[0, 1, 2]], usize::MAX).unwrap_err();
        assert!(matches!(
            error,
            Error::TooLarge {
                what: "vertices",
                ..
            }
        ));
    }

    #[test]
    fn damaged_polygons_are_errors() {
        type Damage = fn(&mut PolyMesh);
        let damages: [Damage; 8] = [
            |m| m.offsets.clear(),
            |m| m.offsets[0] = 1,
            |m| m.offsets[2] = 0,
            |m| m.offsets[6] = u32::MAX,
            |m| m.indices.truncate(20),
            |m| m.indices[5] = 8,
            |m| m.indices[1] = 0,
            |m| m.push_face(&[0, 1]),
        ];
        for (i, damage) in damages.into_iter().enumerate() {
            let mut mesh = quad_cube(0);
            damage(&mut mesh);
            assert!(Halfedge::of_poly_mesh(&mesh).is_err(), "damage {i}");
        }
    }
}
