//! The mesh that a DAG is made of, as groups see it.

use crate::error::Result;
use crate::mesh::{Attribute, AttributeValues, Attributes, PositionIds, TriMesh};
use crate::simplify::{Normals, classes};
use glam::{DVec3, Vec3};

/// The mesh, and which of its vertices are one.
pub(super) struct Source<'a> {
    pub mesh: &'a TriMesh,
    pub ids: PositionIds,
    /// Vertex that stands for every vertex: the first that is equal to it.
    pub canonical: Vec<u32>,
    /// Whether positions are all there is to a vertex.
    bare: bool,
    /// Where breaks in the normals are no seams, all vertices by the one that
    /// stands for them.
    others: Option<Others>,
}

/// Vertices by the one that stands for them: those of `v` are
/// `vertices[starts[v]..starts[v + 1]]`, ascending.
struct Others {
    starts: Vec<u32>,
    vertices: Vec<u32>,
}

impl Others {
    fn of(canonical: &[u32]) -> Self {
        let mut vertices: Vec<u32> = (0..canonical.len() as u32).collect();
        vertices.sort_by_key(|&v| canonical[v as usize]);
        let first = |v: u32| vertices.partition_point(|&w| canonical[w as usize] < v) as u32;
        Self {
            starts: (0..=canonical.len() as u32).map(first).collect(),
            vertices,
        }
    }

    fn at(&self, canonical: u32) -> &[u32] {
        let [first, end] = [0, 1].map(|k| self.starts[canonical as usize + k] as usize);
        &self.vertices[first..end]
    }
}

impl<'a> Source<'a> {
    /// # Errors
    /// What [`TriMesh::validate`] finds.
    pub fn of(mesh: &'a TriMesh) -> Result<Self> {
        mesh.validate()?;
        let ids = PositionIds::of_mesh(mesh);
        let bare = mesh.attributes == Attributes::default() && mesh.ranges.len() <= 1;
        let (canonical, kept) = if bare {
            let first = ids.first_vertices();
            let of = ids.of_vertex.iter().map(|&p| first[p as usize]);
            (of.collect(), true)
        } else {
            let (class, normals) = classes(mesh, &ids);
            (class.of_vertex, normals == Normals::Kept)
        };
        Ok(Self {
            mesh,
            ids,
            others: (!kept).then(|| Others::of(&canonical)),
            canonical,
            bare,
        })
    }

    pub fn place(&self, vertex: u32) -> Vec3 {
        self.mesh.positions[vertex as usize]
    }

    /// Position ids of the corners.
    pub fn linked(&self, triangle: [u32; 3]) -> [u32; 3] {
        triangle.map(|v| self.ids.of_vertex[v as usize])
    }

    /// Unit normal of a triangle; zero if it has none.
    pub fn normal(&self, triangle: [u32; 3]) -> DVec3 {
        let [a, b, c] = triangle.map(|v| self.place(v).as_dvec3());
        (b - a).cross(c - a).normalize_or_zero()
    }

    /// The triangle with the vertices whose normals fit it best, of those that
    /// are one but for their normals.
    pub fn shaded(&self, triangle: [u32; 3]) -> [u32; 3] {
        let (Some(others), Some(normals)) = (&self.others, &self.mesh.attributes.normals) else {
            return triangle;
        };
        let normal = self.normal(triangle).as_vec3();
        let fit = |v: u32| normals[v as usize].dot(normal);
        triangle.map(|v| {
            let all = others.at(v).iter().copied();
            all.fold(v, |best, v| if fit(v) > fit(best) { v } else { best })
        })
    }

    /// A mesh of these vertices without triangles; what a vertex shows comes
    /// with it, and its number among them if there is anything to show.
    pub fn local(&self, vertices: &[u32]) -> TriMesh {
        let mut mesh = TriMesh::new(taken(&self.mesh.positions, vertices), Vec::new());
        if self.bare {
            return mesh;
        }
        let from = &self.mesh.attributes;
        let normals = from.normals.as_ref().filter(|_| self.others.is_none());
        mesh.attributes = Attributes {
            normals: normals.map(|n| taken(n, vertices)),
            uvs: from.uvs.iter().map(|s| taken(s, vertices)).collect(),
            colors: from.colors.iter().map(|s| taken(s, vertices)).collect(),
            skins: from.skins.iter().map(|s| taken(s, vertices)).collect(),
            custom: vec![Attribute {
                name: "number".into(),
                components: 1,
                values: AttributeValues::U32((0..vertices.len() as u32).collect()),
            }],
            ..Attributes::default()
        };
        mesh
    }
}

fn taken<T: Copy>(values: &[T], vertices: &[u32]) -> Vec<T> {
    vertices.iter().map(|&v| values[v as usize]).collect()
}

/// For every vertex of `coarse` the vertex of the local mesh that it is; none
/// if one is not among them.
pub(super) fn numbers(local: &TriMesh, coarse: &TriMesh) -> Option<Vec<u32>> {
    if let Some(number) = coarse.attributes.custom.first() {
        return match &number.values {
            AttributeValues::U32(numbers) => Some(numbers.clone()),
            _ => None,
        };
    }
    // Adding zero turns -0 into 0 and changes nothing else.
    let key = |p: &Vec3| p.to_array().map(|x| (x + 0.0).to_bits());
    let keyed = local.positions.iter().zip(0..);
    let mut known: Vec<([u32; 3], u32)> = keyed.map(|(p, i)| (key(p), i)).collect();
    known.sort_unstable();
    let find = |p: &Vec3| {
        let at = known.binary_search_by_key(&key(p), |k| k.0).ok()?;
        Some(known[at].1)
    };
    coarse.positions.iter().map(find).collect()
}
