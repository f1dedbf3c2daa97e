//! All instances in the world's space, their vertices and triangles numbered
//! through. Only normals that meshes do not have are made; nothing is copied.

use super::model::{Instance, Model};
use crate::error::{Error, Result};
use crate::geom::{Aabb, Mat4, Vec3};
use crate::mesh::{MaterialRange, NormalWeight, PositionIds, TriMesh, vertex_normals};
use std::ops::Range;

/// Triangles of one instance and one material.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part<'a> {
    pub mesh: &'a TriMesh,
    pub instance: u32,
    /// Index of the mesh in the model.
    pub mesh_index: u32,
    /// Number of its first triangle among those of all parts.
    pub first_triangle: u32,
    /// The same triangle in the mesh.
    pub first_of_mesh: u32,
    pub count: u32,
    pub material: Option<u32>,
    /// Whether the instance is mirrored, and fronts seem backs.
    pub mirrored: bool,
}

/// A mesh where it stands. It is not copied: vertices are placed when they are
/// asked for.
#[derive(Debug, Clone)]
pub(super) struct Placed<'a> {
    mesh: &'a TriMesh,
    /// Index of the mesh in the model.
    mesh_index: u32,
    /// Number of its first vertex among those of all instances.
    first_vertex: u32,
    /// `None` for the identity, which changes nothing, not even by rounding.
    world_from_mesh: Option<Mat4>,
}

impl Placed<'_> {
    #[inline]
    fn position(&self, v: usize) -> Vec3 {
        let p = self.mesh.positions[v];
        self.world_from_mesh.map_or(p, |m| placed(m, p))
    }
}

/// Triangles are numbered through all instances, and so are vertices.
#[derive(Debug, Clone, Default)]
pub(super) struct Geometry<'a> {
    /// By number of the first vertex, ascending.
    placed: Vec<Placed<'a>>,
    /// Of every mesh that stands somewhere: of length 1, or zero where there is
    /// none.
    normals: Vec<Option<Vec<Vec3>>>,
    /// By number of the first triangle, ascending; none is empty.
    pub parts: Vec<Part<'a>>,
    /// Part of every [`BLOCK`]th triangle.
    blocks: Vec<u32>,
    pub triangles: usize,
    pub vertices: usize,
    pub bounds: Aabb,
}

/// Triangles from one to the next of which the part is kept.
const BLOCK: usize = 64;

impl<'a> Geometry<'a> {
    pub(super) fn new(model: &Model<'a>) -> Result<Self> {
        check_size(model)?;
        let mut all = Self {
            normals: vec![None; model.meshes.len()],
            ..Self::default()
        };
        let mut used: Vec<Option<Vec<u32>>> = vec![None; model.meshes.len()];
        for (i, instance) in model.instances.iter().enumerate() {
            let m = instance.mesh as usize;
            let mesh = model.meshes[m];
            if all.normals[m].is_none() {
                all.normals[m] = Some(normals_of(mesh)?);
            }
            all.add_parts(mesh, (i as u32, instance.mesh), instance.world_from_mesh);
            all.add_vertices(mesh, instance, used[m].get_or_insert_with(|| used_by(mesh)))?;
        }
        Ok(all)
    }

    fn add_parts(&mut self, mesh: &'a TriMesh, (instance, mesh_index): (u32, u32), matrix: Mat4) {
        let ranges = mesh.ranges_or_whole();
        for MaterialRange {
            first,
            count,
            material,
            ..
        } in ranges.into_iter().filter(|range| range.count > 0)
        {
            let part = self.parts.len() as u32;
            let first_triangle = self.triangles as u32;
            self.triangles += count as usize;
            self.blocks.resize(self.triangles.div_ceil(BLOCK), part);
            self.parts.push(Part {
                mesh,
                instance,
                mesh_index,
                first_triangle,
                first_of_mesh: first,
                count,
                material,
                mirrored: turns_inside_out(matrix),
            });
        }
    }

    /// Adds an instance; `used` are the vertices that its triangles have.
    fn add_vertices(&mut self, mesh: &'a TriMesh, instance: &Instance, used: &[u32]) -> Result<()> {
        let matrix = instance.world_from_mesh;
        let placed = Placed {
            mesh,
            mesh_index: instance.mesh,
            first_vertex: self.vertices as u32,
            world_from_mesh: (matrix != Mat4::IDENTITY).then_some(matrix),
        };
        let mut places = (0..mesh.positions.len()).map(|v| placed.position(v));
        if let Some(index) = places.position(|p| !p.is_finite()) {
            let what = "placed position".into();
            return Err(Error::NotFinite { what, index });
        }
        let places = used.iter().map(|&v| placed.position(v as usize));
        self.bounds = places.fold(self.bounds, Aabb::with);
        self.vertices += mesh.positions.len();
        self.placed.push(placed);
        Ok(())
    }

    /// Part that triangle `t` is of.
    #[inline]
    pub(super) fn part_of(&self, t: u32) -> &Part<'a> {
        let mut part = self.blocks[t as usize / BLOCK] as usize;
        while t - self.parts[part].first_triangle >= self.parts[part].count {
            part += 1;
        }
        &self.parts[part]
    }

    /// Index of the part of the first triangle of a block.
    pub(super) fn part_before(&self, t: usize) -> usize {
        self.blocks[t / BLOCK] as usize
    }

    /// Vertices of triangle `t`, as numbered through all instances.
    #[inline]
    pub(super) fn vertices_of(&self, t: u32) -> [u32; 3] {
        let part = self.part_of(t);
        let first = self.placed[part.instance as usize].first_vertex;
        part.triangle(t).map(|v| v + first)
    }

    /// Corners of triangle `t` in the world.
    pub(super) fn positions_of(&self, t: u32) -> [Vec3; 3] {
        let part = self.part_of(t);
        let placed = &self.placed[part.instance as usize];
        part.triangle(t).map(|v| placed.position(v as usize))
    }

    /// Normals at the corners of triangle `t` in the world; of length 1 or zero.
    pub(super) fn normals_of(&self, t: u32) -> [Vec3; 3] {
        let part = self.part_of(t);
        let placed = &self.placed[part.instance as usize];
        let own = self.normals[placed.mesh_index as usize].as_deref();
        let own = own.unwrap_or_default();
        let own = part.triangle(t).map(|v| own[v as usize]);
        let Some(matrix) = placed.world_from_mesh else {
            return own;
        };
        let [x, y, z] = normal_columns(matrix);
        own.map(|n| unit_or_zero(x * n.x + y * n.y + z * n.z))
    }

    /// Number of the first vertex of a part's instance.
    pub(super) fn first_vertex(&self, part: &Part<'_>) -> u32 {
        self.placed[part.instance as usize].first_vertex
    }

    /// Vertices `range`, as numbered through all instances, in the world.
    pub(super) fn positions(&self, range: Range<usize>) -> impl Iterator<Item = Vec3> + '_ {
        let after = |v: usize| {
            self.placed
                .partition_point(|p| p.first_vertex as usize <= v)
        };
        let first = after(range.start).saturating_sub(1);
        self.placed[first..].iter().flat_map(move |placed| {
            let start = placed.first_vertex as usize;
            let end = range.end.min(start + placed.mesh.positions.len());
            (range.start.max(start)..end).map(move |v| placed.position(v - start))
        })
    }
}

impl Part<'_> {
    /// Triangle `t` of all in the vertices of the mesh.
    #[inline]
    pub(super) fn triangle(&self, t: u32) -> [u32; 3] {
        self.mesh.triangles[(t - self.first_triangle + self.first_of_mesh) as usize]
    }
}

/// Vertices that some triangle has, ascending.
fn used_by(mesh: &TriMesh) -> Vec<u32> {
    let mut used = vec![false; mesh.positions.len()];
    for &v in mesh.triangles.iter().flatten() {
        used[v as usize] = true;
    }
    let all = 0..mesh.positions.len() as u32;
    all.filter(|&v| used[v as usize]).collect()
}

/// Vertices or triangles that repeated meshes may have: 16 bytes each in every
/// picture, 4 GiB.
const REPEATED: usize = 1 << 28;

/// Vertices and triangles with all instances have to be countable by 32 bits,
/// and a picture has to fit into memory.
fn check_size(model: &Model<'_>) -> Result<()> {
    let total = |len: fn(&TriMesh) -> usize| {
        let lens = model.instances.iter();
        lens.fold(0usize, |sum, i| {
            sum.saturating_add(len(model.meshes[i.mesh as usize]))
        })
    };
    let check = |what, len: fn(&TriMesh) -> usize| {
        let (found, limit) = (total(len), u32::MAX as usize - 1);
        if found > limit {
            return Err(Error::TooLarge { what, found, limit });
        }
        let alone: usize = model.meshes.iter().map(|m| len(m)).sum();
        let limit = alone.max(REPEATED);
        if found > limit {
            return Err(Error::Unfolds { what, found, limit });
        }
        Ok(())
    };
    check("vertices", |m| m.positions.len())?;
    check("triangles", |m| m.triangles.len())
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
