//! From a control mesh to a mesh: positions, normals, colours, texture coordinates.

use super::control_mesh::ControlMesh;
use super::options::SubdivOptions;
use super::rational;
use super::refinement::Refinement;
use crate::error::Result;
use crate::mesh::{PolyMesh, TriMesh};
use crate::progress::Progress;
use glam::{Vec2, Vec4};
use std::array::from_fn;

/// What a surface is made of.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct SurfaceOptions {
    /// Vertices lie where infinitely many steps would put them, so that levels of one cage
    /// lie on one surface; so do their colours and texture coordinates. Default `false`: where the steps leave them.
    pub on_limit: bool,
    /// Normals of the limit surface. Default `false`: none.
    pub normals: bool,
}

/// A surface.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Subdivided {
    /// The mesh, its vertices split at seams of texture coordinates.
    pub mesh: PolyMesh,
    /// Faces before holes were left out and quads across creases cut.
    pub faces: usize,
}

/// Refines `control` with what its file says in place of `options`. Faces of holes are left
/// out, as are vertices of no face; quads that √2 folds across creases become two triangles.
///
/// # Errors
/// As [`Refinement::new`], [`Refinement::evaluate`], [`Refinement::face_varying`] and
/// [`Refinement::limits`]; [`Error::LengthMismatch`](crate::Error::LengthMismatch),
/// [`Error::NotFinite`](crate::Error::NotFinite) or
/// [`Error::BadOption`](crate::Error::BadOption) for weights that are not one a vertex, finite
/// and more than 0.
pub fn subdivide(
    control: &ControlMesh,
    options: &SubdivOptions,
    surface: SurfaceOptions,
    progress: &dyn Progress,
) -> Result<Subdivided> {
    let options = control.rules.apply(*options);
    let refinement = Refinement::with_progress(&control.cage, &options, progress)?;
    let mut mesh = PolyMesh::default();
    place(control, &refinement, surface, &mut mesh)?;
    if let Some(colors) = &control.colors {
        let colors: Vec<[f32; 4]> = colors.iter().map(Vec4::to_array).collect();
        let colors = values(&refinement, &colors, surface.on_limit)?.into_iter();
        let clamped = colors.map(|c| Vec4::from(c).clamp(Vec4::ZERO, Vec4::ONE));
        mesh.attributes.colors.push(clamped.collect());
    }
    push_faces(control, &refinement, &mut mesh);
    let corners = match &control.uvs {
        Some(uvs) => {
            let cage: Vec<[f32; 2]> = uvs.values.iter().map(Vec2::to_array).collect();
            let charts = refinement.face_varying(&uvs.indices, cage.len())?;
            let values = values(&charts, &cage, surface.on_limit)?.into_iter();
            split_at_seams(
                &mut mesh,
                &refinement,
                &charts,
                values.map(Vec2::from).collect(),
            )
        }
        None => refinement.corners().to_vec(),
    };
    let faces = (0..refinement.faces().count()).filter(|&f| !refinement.is_hole(f));
    for f in faces {
        let corners = &corners[refinement.faces().corners(f)];
        match *corners {
            [a, b, c, d] if refinement.is_folded(f) => {
                mesh.push_face(&[a, b, c]);
                mesh.push_face(&[a, c, d]);
            }
            _ => mesh.push_face(corners),
        }
    }
    drop_unused(&mut mesh);
    Ok(Subdivided {
        mesh,
        faces: refinement.faces().count(),
    })
}

/// Positions and normals.
fn place(
    control: &ControlMesh,
    refinement: &Refinement,
    surface: SurfaceOptions,
    mesh: &mut PolyMesh,
) -> Result<()> {
    if surface.on_limit || surface.normals {
        let limits = rational::limits(control, refinement)?;
        mesh.positions = limits.positions;
        mesh.attributes.normals = surface.normals.then_some(limits.normals);
    }
    if !surface.on_limit {
        mesh.positions = rational::positions(control, refinement)?;
    }
    Ok(())
}

/// Values after the last step, or where they go in the limit.
fn values<const N: usize>(
    refinement: &Refinement,
    cage: &[[f32; N]],
    on_limit: bool,
) -> Result<Vec<[f32; N]>> {
    if !on_limit {
        return refinement.evaluate(cage);
    }
    let mut to = vec![[0.0; N]; refinement.vertex_count()];
    for first in (0..N).step_by(3) {
        let three = |value: &[f32; N]| from_fn(|i| value.get(first + i).copied().unwrap_or(0.0));
        let limits = refinement.limits(&cage.iter().map(three).collect::<Vec<[f32; 3]>>())?;
        for (to, limit) in to.iter_mut().zip(limits.positions) {
            let to = to[first..].iter_mut();
            to.zip(limit.to_array()).for_each(|(to, limit)| *to = limit);
        }
    }
    Ok(to)
}

/// The materials of the faces that stay.
fn push_faces(control: &ControlMesh, refinement: &Refinement, mesh: &mut PolyMesh) {
    let materials = &control.face_materials;
    if materials.is_empty() {
        return;
    }
    for (f, parent) in refinement.parents().into_iter().enumerate() {
        if !refinement.is_hole(f) {
            let material = materials.get(parent as usize).copied().flatten();
            let times = if refinement.is_folded(f) { 2 } else { 1 };
            mesh.face_materials.extend([material; 2].iter().take(times));
        }
    }
}

/// Makes the vertices of the charts those of the mesh; returns its corners.
fn split_at_seams(
    mesh: &mut PolyMesh,
    refinement: &Refinement,
    charts: &Refinement,
    uvs: Vec<Vec2>,
) -> Vec<u32> {
    let mut source = vec![0; uvs.len()];
    for (&chart, &vertex) in charts.corners().iter().zip(refinement.corners()) {
        source[chart as usize] = vertex;
    }
    mesh.positions = source.iter().map(|&v| mesh.positions[v as usize]).collect();
    mesh.attributes.gather(&source);
    mesh.attributes.uvs.push(uvs);
    charts.corners().to_vec()
}

/// Drops vertices of no face.
fn drop_unused(mesh: &mut PolyMesh) {
    let mut whole = TriMesh::new(std::mem::take(&mut mesh.positions), Vec::new());
    whole.attributes = std::mem::take(&mut mesh.attributes);
    let mut new_index = vec![u32::MAX; whole.positions.len()];
    mesh.indices.iter().for_each(|&v| new_index[v as usize] = 0);
    let mut kept = Vec::new();
    for (v, new) in new_index
        .iter_mut()
        .enumerate()
        .filter(|(_, new)| **new == 0)
    {
        *new = kept.len() as u32;
        kept.push(v as u32);
    }
    if kept.len() < new_index.len() {
        whole.gather_vertices(&kept);
        mesh.indices
            .iter_mut()
            .for_each(|v| *v = new_index[*v as usize]);
    }
    (mesh.positions, mesh.attributes) = (whole.positions, whole.attributes);
}
