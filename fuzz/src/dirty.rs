//! Meshes as bad as they come, and options to match.

use arbitrary::{Arbitrary, Result, Unstructured};
use karui::{
    TriMesh,
    geom::{Vec2, Vec3, Vec4},
    mesh::{MaterialRange, SkinWeights},
    simplify::{AttributeWeights, Border, Cost, Placement, SimplifyOptions, Stop, Topology},
};

/// Largest number of vertices and triangles.
const LARGEST: usize = 200;

/// A mesh and what is to be done with it.
#[derive(Debug)]
pub struct Dirty {
    /// Corners on a coarse lattice, so that coincident vertices, slivers,
    /// folds and fans of any kind are common; now and then out of bounds.
    pub mesh: TriMesh,
    weights: Option<Vec<f32>>,
    locks: Option<Vec<bool>>,
    options: SimplifyOptions<'static>,
}

impl Dirty {
    /// The options, with the weights and locks.
    pub fn options(&self) -> SimplifyOptions<'_> {
        SimplifyOptions {
            weights: self.weights.as_deref(),
            locks: self.locks.as_deref(),
            ..self.options
        }
    }
}

impl<'a> Arbitrary<'a> for Dirty {
    fn arbitrary(u: &mut Unstructured<'a>) -> Result<Self> {
        let options = options(u)?;
        let vertices = u.int_in_range(0..=LARGEST)?;
        let mut mesh = TriMesh::new(many(u, vertices, position)?, Vec::new());
        spoil(u, &mut mesh)?;
        attributes(u, &mut mesh)?;
        let weights = optional(u, vertices, |u| choose(u, &[0.0, 1.0, 0.5, 1e6]))?;
        let locks = optional(u, vertices, |u| u.arbitrary())?;
        mesh.triangles = triangles(u, vertices)?;
        mesh.ranges = ranges(u, mesh.triangles.len())?;
        Ok(Self {
            mesh,
            weights,
            locks,
            options,
        })
    }
}

fn many<T>(
    u: &mut Unstructured,
    n: usize,
    f: fn(&mut Unstructured) -> Result<T>,
) -> Result<Vec<T>> {
    (0..n).map(|_| f(u)).collect()
}

fn optional<T>(
    u: &mut Unstructured,
    n: usize,
    f: fn(&mut Unstructured) -> Result<T>,
) -> Result<Option<Vec<T>>> {
    u.ratio(1, 4)?.then(|| many(u, n, f)).transpose()
}

fn choose<T: Copy>(u: &mut Unstructured, from: &[T]) -> Result<T> {
    u.choose(from).copied()
}

fn lattice(u: &mut Unstructured) -> Result<f32> {
    Ok(f32::from(u8::arbitrary(u)? % 16) / 4.0)
}

/// Sizes at which single precision runs out, and now and then no number at all.
fn spoil(u: &mut Unstructured, mesh: &mut TriMesh) -> Result<()> {
    let scale = choose(u, &[1.0, 1.0, 1.0, 1e-30, 1e-20, 1e18, 1e37])?;
    let offset = choose(u, &[0.0, 0.0, 0.0, 1e6, 3e7])?;
    for p in &mut mesh.positions {
        *p = *p * scale + offset;
    }
    if u.ratio(1, 32)? && !mesh.positions.is_empty() {
        let spoilt = u.choose_index(mesh.positions.len())?;
        mesh.positions[spoilt].y = choose(u, &[f32::NAN, f32::INFINITY])?;
    }
    Ok(())
}

fn position(u: &mut Unstructured) -> Result<Vec3> {
    Ok(Vec3::new(lattice(u)?, lattice(u)?, lattice(u)?))
}

fn normal(u: &mut Unstructured) -> Result<Vec3> {
    Ok((position(u)? - 2.0).normalize_or(Vec3::Z))
}

fn uv(u: &mut Unstructured) -> Result<Vec2> {
    Ok(Vec2::new(lattice(u)?, lattice(u)?))
}

fn color(u: &mut Unstructured) -> Result<Vec4> {
    Ok(position(u)?.extend(1.0))
}

fn skin(u: &mut Unstructured) -> Result<SkinWeights> {
    let first = f32::from(u8::arbitrary(u)?) / 255.0;
    let joints = [u16::from(u8::arbitrary(u)? % 4), 1, 2, 3];
    let weights = [first, 1.0 - first, 0.0, 0.0];
    Ok(SkinWeights { joints, weights })
}

fn attributes(u: &mut Unstructured, mesh: &mut TriMesh) -> Result<()> {
    let n = mesh.positions.len();
    mesh.attributes.normals = optional(u, n, normal)?;
    mesh.attributes.uvs.extend(optional(u, n, uv)?);
    mesh.attributes.uvs.extend(optional(u, n, uv)?);
    mesh.attributes.colors.extend(optional(u, n, color)?);
    mesh.attributes.skins.extend(optional(u, n, skin)?);
    Ok(())
}

/// Half of them reuse an edge of the one before, so that surfaces form.
fn triangles(u: &mut Unstructured, vertices: usize) -> Result<Vec<[u32; 3]>> {
    let largest = (vertices as u32).saturating_sub(1);
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    while !u.is_empty() && triangles.len() < LARGEST && vertices > 0 {
        let c = u.int_in_range(0..=largest)?;
        let [a, b] = match triangles.last() {
            Some(&[_, b, c]) if bool::arbitrary(u)? => [c, b],
            _ => [u.int_in_range(0..=largest)?, u.int_in_range(0..=largest)?],
        };
        triangles.push([a, b, c]);
    }
    if u.ratio(1, 64)? {
        triangles.push([0, 1, vertices as u32]);
    }
    Ok(triangles)
}

fn ranges(u: &mut Unstructured, triangles: usize) -> Result<Vec<MaterialRange>> {
    let mut ranges = Vec::new();
    let mut first = 0;
    while first < triangles && ranges.len() < 3 && u.ratio(1, 2)? {
        let count = u.int_in_range(0..=triangles - first)?;
        ranges.push(range(first, count, ranges.len()));
        first += count;
    }
    if first < triangles && !ranges.is_empty() {
        ranges.push(range(first, triangles - first, ranges.len()));
    }
    Ok(ranges)
}

fn range(first: usize, count: usize, material: usize) -> MaterialRange {
    MaterialRange {
        first: first as u32,
        count: count as u32,
        material: Some(material as u32),
        source: None,
    }
}

fn bound(u: &mut Unstructured) -> Result<Option<f64>> {
    if u.ratio(1, 64)? {
        return choose(u, &[Some(f64::NAN), Some(-1.0), Some(f64::INFINITY)]);
    }
    choose(u, &[None, None, None, Some(0.0), Some(1e-3), Some(0.5)])
}

fn influence(u: &mut Unstructured) -> Result<f64> {
    if u.ratio(1, 64)? {
        return choose(u, &[f64::NAN, -1.0, 1e300]);
    }
    choose(u, &[0.0, 1.0, 1.0, 100.0])
}

fn options(u: &mut Unstructured) -> Result<SimplifyOptions<'static>> {
    Ok(SimplifyOptions {
        stop: Stop {
            triangles: choose(u, &[None, Some(0), Some(1), Some(20), Some(usize::MAX)])?,
            ratio: bound(u)?,
            error: bound(u)?,
            relative_error: bound(u)?,
        },
        placement: choose(u, &[Placement::Optimal, Placement::HalfEdge])?,
        cost: choose(u, &[Cost::Memoryless, Cost::Accumulated])?,
        border: choose(u, &[Border::Preserve, Border::Lock, Border::Free])?,
        attributes: AttributeWeights {
            normal: influence(u)?,
            uv: influence(u)?,
            color: influence(u)?,
            skin: influence(u)?,
        },
        max_normal_turn: choose(u, &[1.2, 1.2, 1.2, 0.1, 1.57])?,
        pairs: bound(u)?,
        topology: choose(u, &[Topology::Simplify, Topology::Preserve])?,
        ..SimplifyOptions::default()
    })
}
