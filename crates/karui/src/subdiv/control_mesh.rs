//! A cage with its positions and what else it carries.

use super::cage::Cage;
use super::options::{Boundary, CreaseMethod, FaceVaryingRule, SubdivOptions, TriangleRule};
use crate::mesh::{PolyMesh, PositionIds};
use glam::{Vec2, Vec3, Vec4};

/// A control mesh as a file holds it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ControlMesh {
    /// Connectivity and tags.
    pub cage: Cage,
    /// Position of every vertex, model units.
    pub positions: Vec<Vec3>,
    /// Weight of every vertex of a rational surface, more than 0; `None` if all are 1.
    pub weights: Option<Vec<f32>>,
    /// Colour of every vertex, linear RGBA.
    pub colors: Option<Vec<Vec4>>,
    /// Texture coordinates of every corner of a face.
    pub uvs: Option<FaceVarying>,
    /// Material of every face; empty if none has one.
    pub face_materials: Vec<Option<u32>>,
    /// What the file says about how to refine it.
    pub rules: Rules,
}

/// Values by corner: neighbouring faces may disagree at a vertex, which makes a seam.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FaceVarying {
    /// The values.
    pub values: Vec<Vec2>,
    /// Index of the value of every corner.
    pub indices: Vec<u32>,
}

/// Rules a file asks for; `None` where it says nothing.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Rules {
    /// What happens at boundaries.
    pub boundary: Option<Boundary>,
    /// How creases decay.
    pub creases: Option<CreaseMethod>,
    /// Edge points beside triangles.
    pub triangles: Option<TriangleRule>,
    /// How texture coordinates are refined.
    pub face_varying: Option<FaceVaryingRule>,
}

impl Rules {
    /// `options` with these rules in place of its own.
    #[must_use]
    pub fn apply(&self, options: SubdivOptions) -> SubdivOptions {
        SubdivOptions {
            boundary: self.boundary.unwrap_or(options.boundary),
            creases: self.creases.unwrap_or(options.creases),
            triangles: self.triangles.unwrap_or(options.triangles),
            face_varying: self.face_varying.unwrap_or(options.face_varying),
            ..options
        }
    }
}

impl ControlMesh {
    /// A polygon mesh as a control mesh. If it has texture coordinates or normals, vertices
    /// at one position become one, lest the surface tear at seams; the first one's colour is
    /// taken. Normals are left aside: the surface has its own.
    #[must_use]
    pub fn of_poly_mesh(mesh: &PolyMesh) -> Self {
        let attributes = &mesh.attributes;
        let split = attributes.normals.is_some() || !attributes.uvs.is_empty();
        let ids = if split {
            PositionIds::of(&mesh.positions)
        } else {
            PositionIds::distinct(mesh.positions.len())
        };
        let mut first = vec![u32::MAX; ids.count];
        for (v, &id) in ids.of_vertex.iter().enumerate() {
            let first = &mut first[id as usize];
            *first = (*first).min(v as u32);
        }
        let uvs = attributes.uvs.first().map(|values| FaceVarying {
            values: values.clone(),
            indices: mesh.indices.clone(),
        });
        let color = |colors: &Vec<Vec4>| first.iter().map(|&v| colors[v as usize]).collect();
        // An index out of range stays so, for the check to find.
        let id = |&v: &u32| ids.of_vertex.get(v as usize).copied().unwrap_or(v);
        Self {
            cage: Cage {
                vertices: ids.count,
                offsets: mesh.offsets.clone(),
                indices: mesh.indices.iter().map(id).collect(),
                ..Cage::default()
            },
            positions: first.iter().map(|&v| mesh.positions[v as usize]).collect(),
            weights: None,
            colors: attributes.colors.first().map(color),
            uvs,
            face_materials: mesh.face_materials.clone(),
            rules: Rules::default(),
        }
    }
}
