//! All instances in the world's space, their vertices and triangles in one list.

use super::model::Model;
use crate::error::{Error, Result};
use crate::geom::{Aabb, Mat4, Vec3};
use crate::mesh::{MaterialRange, NormalWeight, PositionIds, TriMesh, vertex_normals};

/// Triangles of one instance and one material.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part<'a> {
    pub mesh: &'a TriMesh,
    pub instance: u32,
    /// Index of the mesh in the model.
    pub mesh_index: u32,
    /// First of the instance's vertices in [`Geometry::positions`].
    pub first_vertex: u32,
    /// First of the part's triangles in [`Geometry::triangles`].
    pub first_triangle: u32,
    /// The same triangle in the mesh.
    pub first_of_mesh: u32,
    pub count: u32,
    pub material: Option<u32>,
    /// Whether the instance is mirrored, and fronts seem backs.
    pub mirrored: bool,
}

#[derive(Debug, Clone, Default)]
pub(super) struct Geometry<'a> {
    pub positions: Vec<Vec3>,
    /// Of length 1, or zero where there is none.
    pub normals: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
    /// Part of every triangle.
    pub part_of: Vec<u32>,
    pub parts: Vec<Part<'a>>,
    pub bounds: Aabb,
}

impl<'a> Geometry<'a> {
    pub(super) fn new(model: &Model<'a>) -> Result<Self> {
        check_size(model)?;
        let mut normals: Vec<Option<Vec<Vec3>>> = vec![None; model.meshes.len()];
        let mut all = Self::default();
        for (i, instance) in model.instances.iter().enumerate() {
            let m = instance.mesh as usize;
            let mesh = model.meshes[m];
            let normals = match &normals[m] {
                Some(known) => known,
                None => normals[m].insert(normals_of(mesh)?),
            };
            let world_from_mesh = instance.world_from_mesh;
            all.add_parts(mesh, (i as u32, instance.mesh), world_from_mesh);
            all.add_vertices(mesh, normals, world_from_mesh)?;
        }
        all.bounds = Aabb::of(
            all.triangles
                .iter()
                .flatten()
                .map(|&v| all.positions[v as usize]),
        );
        Ok(all)
    }

    fn add_parts(&mut self, mesh: &'a TriMesh, (instance, mesh_index): (u32, u32), matrix: Mat4) {
        let first_vertex = self.positions.len() as u32;
        for MaterialRange {
            first,
            count,
            material,
            ..
        } in mesh.ranges_or_whole()
        {
            let first_triangle = self.triangles.len() as u32;
            let part = self.parts.len() as u32;
            let range = first as usize..(first + count) as usize;
            let shifted = mesh.triangles[range]
                .iter()
                .map(|t| t.map(|v| v + first_vertex));
            self.triangles.extend(shifted);
            self.part_of.resize(self.triangles.len(), part);
            self.parts.push(Part {
                mesh,
                instance,
                mesh_index,
                first_vertex,
                first_triangle,
                first_of_mesh: first,
                count,
                material,
                mirrored: turns_inside_out(matrix),
            });
        }
    }

    fn add_vertices(&mut self, mesh: &TriMesh, normals: &[Vec3], matrix: Mat4) -> Result<()> {
        if matrix == Mat4::IDENTITY {
            self.positions.extend(&mesh.positions);
            self.normals.extend(normals);
            return Ok(());
        }
        let start = self.positions.len();
        self.positions
            .extend(mesh.positions.iter().map(|&p| placed(matrix, p)));
        if let Some(index) = self.positions[start..].iter().position(|p| !p.is_finite()) {
            let what = "placed position".into();
            return Err(Error::NotFinite { what, index });
        }
        let [x, y, z] = normal_columns(matrix);
        let turned = |n: &Vec3| unit_or_zero(x * n.x + y * n.y + z * n.z);
        self.normals.extend(normals.iter().map(turned));
        Ok(())
    }
}

/// Vertices and triangles with all instances have to be countable by 32 bits.
fn check_size(model: &Model<'_>) -> Result<()> {
    let total = |len: fn(&TriMesh) -> usize| {
        let lens = model.instances.iter();
        lens.fold(0usize, |sum, i| {
            sum.saturating_add(len(model.meshes[i.mesh as usize]))
        })
    };
    let limit = u32::MAX as usize - 1;
    for (what, found) in [
        ("vertices", total(|m| m.positions.len())),
        ("triangles", total(|m| m.triangles.len())),
    ] {
        if found > limit {
            return Err(Error::TooLarge { what, found, limit });
        }
    }
    Ok(())
}

/// The mesh's own normals as far as they are good, else smooth ones by area:
/// weights by angle would need an arc tangent, which differs between machines.
fn normals_of(mesh: &TriMesh) -> Result<Vec<Vec3>> {
    match &mesh.attributes.normals {
        Some(own) => Ok(own.iter().map(|&n| unit_or_zero(n)).collect()),
        None => vertex_normals(mesh, &PositionIds::of_mesh(mesh), NormalWeight::Area),
    }
}

/// Zero, too, for what is not finite.
fn unit_or_zero(n: Vec3) -> Vec3 {
    let length = n.length();
    let unit = n * (1.0 / length);
    if unit.is_finite() { unit } else { Vec3::ZERO }
}

/// Components one by one: a matrix's own product may sum in another order on
/// another machine.
fn placed(m: Mat4, p: Vec3) -> Vec3 {
    let axis = |k: usize| {
        let [x, y, z, w] = [m.x_axis, m.y_axis, m.z_axis, m.w_axis].map(|c| f64::from(c[k]));
        (x * f64::from(p.x) + y * f64::from(p.y) + z * f64::from(p.z) + w) as f32
    };
    Vec3::new(axis(0), axis(1), axis(2))
}

fn columns(m: Mat4) -> [Vec3; 3] {
    [m.x_axis, m.y_axis, m.z_axis].map(|c| Vec3::new(c.x, c.y, c.z))
}

/// Columns of the cofactor matrix, which takes normals along up to a factor; it
/// needs no inverse, so a flattened instance has normals as well.
fn normal_columns(m: Mat4) -> [Vec3; 3] {
    let [x, y, z] = columns(m);
    let sign = if turns_inside_out(m) { -1.0 } else { 1.0 };
    [y.cross(z) * sign, z.cross(x) * sign, x.cross(y) * sign]
}

fn turns_inside_out(m: Mat4) -> bool {
    let [x, y, z] = columns(m).map(Vec3::as_dvec3);
    x.cross(y).dot(z) < 0.0
}
