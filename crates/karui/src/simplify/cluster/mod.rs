//! Vertex clustering: the surface on a grid, for targets that topology forbids.
//!
//! Everything within a cell of a uniform grid that hangs together becomes one
//! vertex, placed where the planes of its triangles meet best. Nothing is ever
//! in the way of it, so any count is reached; what is smaller than a cell
//! vanishes, and the surface may touch itself.
//!
//! - J. Rossignac, P. Borrel: Multi-resolution 3D approximations for rendering
//!   complex scenes, 1993.
//! - P. Lindstrom: Out-of-Core Simplification of Large Polygonal Models,
//!   SIGGRAPH 2000.
//! - A. Kapoulkine: meshoptimizer, `meshopt_simplifySloppy`, for the search of
//!   the grid by counting.

mod border;
mod grid;
mod groups;
mod output;
mod place;
mod search;

use super::{Stop, Stopped, check_stop, same_length, target};
use crate::error::Result;
use crate::mesh::{PositionIds, TriMesh};
use crate::progress::{Progress, Silent, step};
use border::Border;
use grid::Grid;
use groups::Groups;
use place::Placed;
use std::fmt;

/// Options of [`cluster`].
#[derive(Clone, Copy)]
pub struct ClusterOptions<'a> {
    /// When to stop. Default: never, that is, at the coarsest grid that leaves
    /// a triangle.
    pub stop: Stop,
    /// Vertices that do not move and are joined with no other; those at the
    /// same position count as one. They go only if no triangle is left at them.
    pub locks: Option<&'a [bool]>,
    /// Told about the work and asked whether to go on.
    pub progress: &'a dyn Progress,
}

impl Default for ClusterOptions<'_> {
    fn default() -> Self {
        Self {
            stop: Stop::default(),
            locks: None,
            progress: &Silent,
        }
    }
}

impl fmt::Debug for ClusterOptions<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ClusterOptions")
            .field("stop", &self.stop)
            .field("locks", &self.locks.map(<[bool]>::len))
            .finish_non_exhaustive()
    }
}

/// A clustered mesh and how it came about.
#[derive(Debug, Clone)]
pub struct Clustered {
    /// The coarser mesh.
    pub mesh: TriMesh,
    /// Estimate of the distance to the input, model units: the largest root
    /// mean square distance of a vertex to the planes it stands for, or the
    /// radius of what vanished in one cell if that is larger. The true
    /// distance is what [`metrics`](crate::metrics) measures.
    pub error: f64,
    /// [`Stopped::Target`], [`Stopped::ErrorBound`], or [`Stopped::Exhausted`]
    /// if a coarser grid would leave nothing.
    pub stopped: Stopped,
    /// Length of a cell's side, model units; 0 if nothing was joined.
    pub cell: f64,
    /// Positions joined with others.
    pub joined: usize,
}

/// Joins the vertices of `mesh` that share a cell of a uniform grid and hang
/// together within it, on the finest grid that meets `options.stop`.
///
/// The result has at most as many triangles as asked for and close to that,
/// unless the error bound stops it before or nothing at all would be left.
/// Unlike [`simplify`](super::simplify()) it keeps no topology: parts smaller
/// than a cell vanish, thin ones may fold, triangles may turn over. Attributes
/// are those of the input's nearest point, never mixed across a seam.
/// Triangles without area and duplicates are left out. Takes time linear in
/// the triangles; the result is the same for any number of threads.
///
/// # Errors
/// What [`TriMesh::validate`] finds;
/// [`Error::BadOption`](crate::Error::BadOption) for a stop out of its range,
/// [`Error::LengthMismatch`](crate::Error::LengthMismatch) for locks of another
/// length than the vertices, [`Error::Cancelled`](crate::Error::Cancelled).
///
/// # Examples
/// ```
/// use karui::{mesh::shapes, simplify::{ClusterOptions, Stop, cluster}};
///
/// let sphere = shapes::icosphere(5);
/// let coarse = cluster(&sphere, &ClusterOptions {
///     stop: Stop::triangles(1000),
///     ..Default::default()
/// })?;
/// assert!((900..=1000).contains(&coarse.mesh.triangles.len()));
/// # Ok::<(), karui::Error>(())
/// ```
pub fn cluster(mesh: &TriMesh, options: &ClusterOptions<'_>) -> Result<Clustered> {
    mesh.validate()?;
    check_stop(&options.stop)?;
    same_length("locks", options.locks.map(<[bool]>::len), mesh)?;
    let wanted = target(mesh, &options.stop);
    if mesh.triangles.len() <= wanted.triangles {
        return Ok(unchanged(mesh));
    }
    step(options.progress, STAGE, 0.0)?;
    let ids = PositionIds::of_mesh(mesh);
    let grid = Grid::new(mesh, &ids, options.locks);
    step(options.progress, STAGE, 0.2)?;
    let border = Border::of(mesh, &ids);
    let trial = |scale| Trial::new(mesh, &ids, &grid, border.as_ref(), scale);
    let (mut best, mut stopped) = search::by_target(mesh, &grid, wanted.triangles, trial);
    step(options.progress, STAGE, 0.7)?;
    if best.placed.error > wanted.error {
        (best, stopped) = (
            search::by_error(best, wanted.error, trial),
            Stopped::ErrorBound,
        );
    }
    step(options.progress, STAGE, 0.9)?;
    let clustered = Clustered {
        mesh: output::output(mesh, &best.groups, &best.placed, &best.kept),
        error: best.placed.error,
        stopped,
        cell: grid.cell_size(best.scale),
        joined: ids.count.saturating_sub(best.groups.points),
    };
    step(options.progress, STAGE, 1.0)?;
    Ok(clustered)
}

const STAGE: &str = "clustering";

/// What one grid makes of the mesh.
struct Trial {
    scale: u32,
    groups: Groups,
    placed: Placed,
    /// Triangles that are left.
    kept: Vec<u32>,
}

impl Trial {
    fn new(
        mesh: &TriMesh,
        ids: &PositionIds,
        grid: &Grid,
        border: Option<&Border<'_>>,
        scale: u32,
    ) -> Self {
        let mut keys = Vec::new();
        grid.keys(scale, &mut keys);
        let groups = Groups::of(mesh, ids, &keys);
        let walls_of = |v: u32| grid.cell_box(keys[v as usize], scale);
        let surface = place::Surface {
            mesh,
            groups: &groups,
            border,
        };
        let placed = place::place(surface, grid.cell_size(scale), walls_of);
        Self {
            scale,
            kept: output::kept(mesh, &groups, &placed),
            groups,
            placed,
        }
    }
}

fn unchanged(mesh: &TriMesh) -> Clustered {
    Clustered {
        mesh: mesh.clone(),
        error: 0.0,
        stopped: Stopped::Target,
        cell: 0.0,
        joined: 0,
    }
}
