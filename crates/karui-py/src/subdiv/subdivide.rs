//! A smooth surface from a cage, for Python.

use super::control_mesh::ControlLike;
use super::options::{RuleNames, scheme};
use super::polygons::Polygons;
use crate::progress::run;
use karui::subdiv::{self as lib, SubdivOptions, SurfaceOptions};
use pyo3::prelude::*;
use std::sync::Arc;

/// Makes a smooth surface of a coarse mesh, its cage: a ControlMesh, a Mesh, Polygons, a pair
/// (positions, faces) of an array (n, 3), model units, and faces as rows of an array (m, k) or as
/// sequences, one each; a triple (positions, indices, offsets) as in ControlMesh; or a mesh of
/// trimesh or pyvista, of which only the shape is taken.
///
/// levels: number of steps. scheme: "catmull-clark"; "sqrt2", the same in two steps; "loop" or
/// "sqrt3" for triangles; or "bilinear", where nothing moves. boundary, where the surface ends:
/// "none" leaves out the faces there, "edge" makes smooth curves, "corner" also keeps vertices of
/// one face. crease_method: "uniform" or "chaikin". triangle_rule, of Catmull-Clark:
/// "catmull-clark" or "smooth". uv_rule, where texture coordinates stay linear: "none",
/// "corners-only", "corners-plus1", "corners-plus2", "boundaries" or "all". Without a rule it is
/// what the cage's file says, else "corner", "uniform", "catmull-clark" and "corners-plus1".
/// limit: vertices where infinitely many steps would put them. normals: those of the limit surface.
/// uvs: whether texture coordinates go along, which "sqrt3" and odd numbers of "sqrt2" steps refuse,
/// as "sqrt3" does limit and normals. max_faces: more are refused before any is made. progress:
/// called with a stage and a fraction; returning False cancels.
///
/// Colours go along, vertices are split at seams of texture coordinates, faces of holes are left
/// out. The result is the same for any number of threads. Raises InputError and Cancelled.
#[pyfunction]
#[pyo3(signature = (cage, levels=1, scheme="catmull-clark", *, boundary=None, crease_method=None,
    triangle_rule=None, uv_rule=None, limit=false, normals=false, uvs=true, max_faces=1 << 28,
    progress=None), text_signature = "(cage, levels=1, scheme='catmull-clark', *, boundary=None, \
    crease_method=None, triangle_rule=None, uv_rule=None, limit=False, normals=False, uvs=True, \
    max_faces=268435456, progress=None)")]
#[expect(
    clippy::too_many_arguments,
    reason = "they are keywords of a Python function"
)]
pub fn subdivide(
    py: Python<'_>,
    cage: ControlLike,
    levels: u32,
    scheme: &str,
    boundary: Option<&str>,
    crease_method: Option<&str>,
    triangle_rule: Option<&str>,
    uv_rule: Option<&str>,
    limit: bool,
    normals: bool,
    uvs: bool,
    max_faces: u64,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Polygons> {
    let names = RuleNames {
        boundary,
        crease_method,
        triangle_rule,
        uv_rule,
    };
    let mut cage = cage.0;
    let rules = names.over(cage.rules)?;
    if rules != cage.rules || (cage.uvs.is_some() && !uvs) {
        let changed = Arc::make_mut(&mut cage);
        changed.rules = rules;
        changed.uvs = changed.uvs.take().filter(|_| uvs);
    }
    let options = SubdivOptions {
        scheme: self::scheme(scheme)?,
        levels,
        max_faces,
        ..SubdivOptions::default()
    };
    let surface = SurfaceOptions {
        on_limit: limit,
        normals,
    };
    let made = run(py, progress, |progress| {
        lib::subdivide(&cage, &options, surface, progress)
    })?;
    Ok(Polygons::of(made.mesh))
}
