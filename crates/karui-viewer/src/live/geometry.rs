//! The vertices that sessions send from.

use glam::Vec3;
use karui::geom::Aabb;
use karui::mesh::{NormalWeight, PositionIds, TriMesh, vertex_normals};

/// Places and normals of all vertices of a model; sessions share it.
#[derive(Debug, Clone)]
pub struct Geometry {
    positions: Vec<Vec3>,
    /// Octahedral, two signed numbers of 16 bits.
    normals: Vec<[i16; 2]>,
    bounds: Aabb,
    triangles: usize,
}

impl Geometry {
    /// Those of a mesh: its own normals, else those of the triangles around each vertex.
    ///
    /// # Errors
    /// As [`vertex_normals`].
    pub fn of(mesh: &TriMesh) -> karui::Result<Self> {
        let made;
        let normals = match &mesh.attributes.normals {
            Some(normals) => normals,
            None => {
                made = vertex_normals(mesh, &PositionIds::of_mesh(mesh), NormalWeight::Angle)?;
                &made
            }
        };
        Ok(Self {
            positions: mesh.positions.clone(),
            normals: normals.iter().map(|&n| octahedral(n)).collect(),
            bounds: mesh.bounds(),
            triangles: mesh.triangles.len(),
        })
    }

    /// Number of vertices.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// Number of triangles of the mesh.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.triangles
    }

    /// Box around the mesh, model units.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    pub(super) fn vertex(&self, v: u32) -> (Vec3, [i16; 2]) {
        (self.positions[v as usize], self.normals[v as usize])
    }
}

/// A direction on the octahedron whose lower half is folded out to the corners of the
/// square (Z. Cigolle et al.: A Survey of Efficient Representations for Independent Unit
/// Vectors, 2014); +z for none.
pub(crate) fn octahedral(normal: Vec3) -> [i16; 2] {
    let sum = normal.x.abs() + normal.y.abs() + normal.z.abs();
    if !(sum > 0.0 && sum.is_finite()) {
        return [0, 0];
    }
    let [x, y] = [normal.x / sum, normal.y / sum];
    let sign = |v: f32| if v < 0.0 { -1.0 } else { 1.0 };
    let [x, y] = match normal.z < 0.0 {
        true => [(1.0 - y.abs()) * sign(x), (1.0 - x.abs()) * sign(y)],
        false => [x, y],
    };
    [x, y].map(|v| (v * 32767.0).round() as i16)
}

#[cfg(test)]
mod tests {
    use super::*;
    use karui::geom::fibonacci_directions;

    fn direction([x, y]: [i16; 2]) -> Vec3 {
        let [x, y] = [x, y].map(|v| f32::from(v) / 32767.0);
        let z = 1.0 - x.abs() - y.abs();
        let fold = (-z).max(0.0);
        Vec3::new(x - fold.copysign(x), y - fold.copysign(y), z).normalize()
    }

    #[test]
    fn directions_come_back() {
        for normal in fibonacci_directions(1000) {
            assert!(direction(octahedral(normal)).distance(normal) < 1e-4);
        }
        assert_eq!(direction(octahedral(Vec3::ZERO)), Vec3::Z);
        assert_eq!(direction(octahedral(Vec3::NAN)), Vec3::Z);
    }
}
