//! A cage with its positions and what else it carries.

use super::cage::{Cage, not_finite};
use super::options::{Boundary, CreaseMethod, FaceVaryingRule, SubdivOptions, TriangleRule};
use super::rational;
use crate::error::{Error, Result};
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

    /// Checks the cage, and that there is as much of everything else as it asks for.
    ///
    /// # Errors
    /// As [`Cage::validate`]; [`Error::LengthMismatch`] and [`Error::NotFinite`] for positions,
    /// weights, colours and texture coordinates, [`Error::IndexOutOfRange`] for indices of these,
    /// [`Error::BadOption`] for weights that are not more than 0.
    pub fn validate(&self) -> Result<()> {
        self.cage.validate()?;
        let vertices = self.cage.vertices;
        check("positions", vertices, &self.positions, |p| p.is_finite())?;
        if let Some(weights) = &self.weights {
            rational::check(weights, vertices)?;
        }
        if let Some(colors) = &self.colors {
            check("colors", vertices, colors, |c| c.is_finite())?;
        }
        let Some(uvs) = &self.uvs else { return Ok(()) };
        let count = uvs.values.len();
        check("texture coordinates", count, &uvs.values, |uv| {
            uv.is_finite()
        })?;
        let corners = self.cage.indices.len();
        check("texture indices", corners, &uvs.indices, |_| true)?;
        match uvs.indices.iter().position(|&i| i as usize >= count) {
            None => Ok(()),
            Some(corner) => Err(Error::IndexOutOfRange {
                face: self
                    .cage
                    .offsets
                    .partition_point(|&first| first as usize <= corner)
                    - 1,
                index: uvs.indices[corner],
                vertices: count,
            }),
        }
    }
}

fn check<T>(
    what: &'static str,
    expected: usize,
    values: &[T],
    finite: impl Fn(&T) -> bool,
) -> Result<()> {
    if values.len() != expected {
        return Err(Error::LengthMismatch {
            what: what.into(),
            expected,
            found: values.len(),
        });
    }
    match values.iter().position(|value| !finite(value)) {
        Some(index) => Err(not_finite(what, index)),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> ControlMesh {
        ControlMesh {
            cage: Cage {
                vertices: 4,
                offsets: vec![0, 4],
                indices: vec![0, 1, 2, 3],
                ..Cage::default()
            },
            positions: vec![Vec3::ZERO; 4],
            colors: Some(vec![Vec4::ONE; 4]),
            uvs: Some(FaceVarying {
                values: vec![Vec2::ZERO; 2],
                indices: vec![0, 1, 1, 0],
            }),
            ..ControlMesh::default()
        }
    }

    #[test]
    fn what_does_not_fit_the_cage_is_refused() {
        square().validate().unwrap();
        type Damage = fn(&mut ControlMesh, &mut FaceVarying);
        let damages: [(Damage, &str); 7] = [
            (|m, _| m.cage.indices[1] = 4, "4"),
            (|m, _| m.positions.truncate(3), "3"),
            (|m, _| m.positions[2].y = f32::NAN, "2"),
            (|m, _| m.colors = Some(Vec::new()), "0"),
            (|_, uvs| uvs.values[1].x = f32::INFINITY, "1"),
            (|_, uvs| uvs.indices.truncate(3), "3"),
            (|_, uvs| uvs.indices[3] = 9, "9"),
        ];
        for (damage, number) in damages {
            let mut mesh = square();
            let mut uvs = mesh.uvs.take().unwrap();
            damage(&mut mesh, &mut uvs);
            mesh.uvs = Some(uvs);
            let told = mesh.validate().unwrap_err().to_string();
            assert!(told.contains(number), "{told}");
        }
    }
}
