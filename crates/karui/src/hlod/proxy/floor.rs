//! How few triangles simplification can leave.

use super::merged::{MergedOptions, simplify_options};
use crate::error::Result;
use crate::mesh::{Components, PositionIds, TriMesh};
use crate::simplify::{Stop, simplify};

/// Parts that are tried.
const SAMPLE: usize = 256;
/// Triangles that a part keeps at most, as far as is known without trying: with fewer
/// parts than one in so many, all may go well.
const PART: usize = 32;
/// How many times the triangles asked for have to be left before it is given up.
const SURE: f64 = 1.25;

/// Whether simplification is stopped by topology before there are `most` triangles:
/// every part keeps some, and of many parts one in so many tells how many.
pub(super) fn is_beyond_reach(
    mesh: &TriMesh,
    most: usize,
    options: &MergedOptions<'_>,
) -> Result<bool> {
    let parts = Components::of(mesh, &PositionIds::of_mesh(mesh))?;
    if parts.count < 2 * SAMPLE || parts.count <= most / PART {
        return Ok(false);
    }
    let step = parts.count / SAMPLE;
    let is_tried = |t: usize| (parts.of_triangle[t] as usize).is_multiple_of(step);
    let mut some = mesh.clone();
    some.retain_triangles(is_tried);
    some.remove_unreferenced_vertices();
    // Then trying is no cheaper than doing.
    if 2 * some.triangles.len() > mesh.triangles.len() {
        return Ok(false);
    }
    let tried = parts.count.div_ceil(step);
    let how = crate::SimplifyOptions {
        stop: Stop::triangles(tried),
        ..simplify_options(options)
    };
    let left = simplify(&some, &how)?.mesh.triangles.len();
    let all = left as f64 * parts.count as f64 / tried as f64;
    Ok(all > SURE * most as f64)
}
