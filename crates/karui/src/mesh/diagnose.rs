//! What is unusual about the topology of a mesh.

use super::disjoint_sets::DisjointSets;
use super::edges::{Corners, EdgeTable, TriangleCorners, is_proper};
use super::{PositionIds, TriMesh, components};
use crate::error::{Error, Result};
use crate::geom;
use rayon::prelude::*;

/// Counts that describe the surface of a mesh, vertices at one position taken
/// as one. Degenerate triangles take no part in edges, fans and components.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TopologyReport {
    /// Vertices as stored.
    pub vertices: usize,
    /// Distinct positions.
    pub positions: usize,
    /// Triangles as stored.
    pub triangles: usize,
    /// Edges of the triangles that are not degenerate.
    pub edges: usize,
    /// Edges with one triangle.
    pub boundary_edges: usize,
    /// Connected sets of boundary edges; on a manifold, its holes.
    pub boundary_loops: usize,
    /// Edges with more than two triangles.
    pub nonmanifold_edges: usize,
    /// Edges whose two triangles have opposite orientation.
    pub inconsistent_edges: usize,
    /// Positions where the triangles form more than one fan, those joined by a
    /// non-manifold edge counting as one.
    pub nonmanifold_vertices: usize,
    /// Parts not joined by a common position.
    pub components: usize,
    /// Triangles with two corners at one position.
    pub degenerate: usize,
    /// Other triangles whose area is exactly 0.
    pub zero_area: usize,
    /// Triangles whose three positions an earlier triangle has too, whatever
    /// the orientation.
    pub duplicate_faces: usize,
    /// Vertices no triangle uses.
    pub unreferenced_vertices: usize,
    /// No boundary edges.
    pub closed: bool,
    /// No non-manifold edges and vertices.
    pub manifold: bool,
    /// No inconsistent edges.
    pub oriented: bool,
    /// Positions in use - edges + triangles, degenerate ones apart.
    pub euler_characteristic: i64,
    /// Parts of the first UV set not joined by an edge with equal UVs on both
    /// sides; `None` without UVs.
    pub uv_charts: Option<usize>,
    /// Sum of the triangles' areas, square model units.
    pub area: f64,
    /// Enclosed volume, cubic model units, negative if turned inside out;
    /// `None` unless closed, manifold along its edges and oriented.
    pub volume: Option<f64>,
}

/// Examines the topology of `mesh` over [`PositionIds`].
///
/// # Errors
/// [`Error::IndexOutOfRange`], [`Error::TooLarge`] or, for the first UV set,
/// [`Error::LengthMismatch`].
pub fn diagnose(mesh: &TriMesh) -> Result<TopologyReport> {
    mesh.validate_indices()?;
    diagnose_with(mesh, &PositionIds::of_mesh(mesh))
}

/// Like [`diagnose`] with vertices linked by `ids`, for instance those that
/// [`repair`](super::repair) returns.
///
/// # Errors
/// As [`diagnose`]; [`Error::LengthMismatch`] if `ids` belong to another mesh.
pub fn diagnose_with(mesh: &TriMesh, ids: &PositionIds) -> Result<TopologyReport> {
    ids.validate_for(mesh)?;
    let limit = u32::MAX as usize / 3;
    if mesh.triangles.len() > limit {
        let found = mesh.triangles.len();
        return Err(Error::TooLarge {
            what: "triangles",
            found,
            limit,
        });
    }
    let triangles = ids.triangles(&mesh.triangles);
    let mut report = TopologyReport {
        vertices: mesh.positions.len(),
        positions: ids.count,
        triangles: triangles.len(),
        degenerate: triangles.iter().filter(|&&t| !is_proper(t)).count(),
        duplicate_faces: count_duplicates(&triangles),
        unreferenced_vertices: count_unreferenced(&mesh.triangles, mesh.positions.len()),
        ..TopologyReport::default()
    };
    let table = EdgeTable::new(&TriangleCorners(&triangles), ids.count);
    report.count_edges(&triangles, &table, ids.count);
    report.count_fans(&triangles, &table, ids.count);
    report.uv_charts = count_uv_charts(mesh, &triangles, &table)?;
    report.measure(mesh, &triangles);
    Ok(report)
}

impl TopologyReport {
    fn count_edges(&mut self, triangles: &[[u32; 3]], table: &EdgeTable, positions: usize) {
        let corners = TriangleCorners(triangles);
        let mut loops = DisjointSets::new(positions);
        let mut on_boundary = vec![false; positions];
        for edge in table.iter() {
            match *edge {
                [c] => {
                    let [a, b] = corners.edge(c);
                    loops.unite(a, b);
                    on_boundary[a as usize] = true;
                    on_boundary[b as usize] = true;
                    self.boundary_edges += 1;
                }
                [c, d] if corners.vertex(c) == corners.vertex(d) => self.inconsistent_edges += 1,
                [_, _] => {}
                _ => self.nonmanifold_edges += 1,
            }
        }
        let names_a_loop = |p: &u32| on_boundary[*p as usize] && loops.find(*p) == *p;
        self.boundary_loops = (0..positions as u32).filter(names_a_loop).count();
        self.edges = table.len();
        self.closed = self.boundary_edges == 0;
        self.oriented = self.inconsistent_edges == 0;
    }

    fn count_fans(&mut self, triangles: &[[u32; 3]], table: &EdgeTable, positions: usize) {
        let corners = TriangleCorners(triangles);
        let mut fans = fans_across(triangles, table, |_| true);
        let mut fans_at = vec![0u32; positions];
        let mut faces = 0;
        for c in (0..corners.len() as u32).filter(|&c| corners.is_used(c)) {
            faces += usize::from(c % 3 == 0);
            fans_at[corners.vertex(c) as usize] += u32::from(fans.find(c) == c);
        }
        self.nonmanifold_vertices = fans_at.iter().filter(|&&fans| fans > 1).count();
        self.manifold = self.nonmanifold_vertices == 0 && self.nonmanifold_edges == 0;
        let used = fans_at.iter().filter(|&&fans| fans > 0).count();
        self.euler_characteristic = used as i64 - self.edges as i64 + faces as i64;
        let proper: Vec<[u32; 3]> = triangles
            .iter()
            .copied()
            .filter(|&t| is_proper(t))
            .collect();
        self.components = components::of_triangles(&proper, positions).count;
    }

    fn measure(&mut self, mesh: &TriMesh, triangles: &[[u32; 3]]) {
        // Near the mesh, so that little is lost by cancellation.
        let origin = mesh.bounds().center().as_dvec3();
        let mut six_volumes = 0.0;
        for (t, &ids) in triangles.iter().enumerate() {
            let corners = mesh.corners(t);
            let area = geom::area(corners);
            self.zero_area += usize::from(area == 0.0 && is_proper(ids));
            self.area += area;
            let [a, b, c] = corners.map(|p| p - origin);
            six_volumes += a.dot(b.cross(c));
        }
        let encloses = self.closed && self.oriented && self.nonmanifold_edges == 0;
        self.volume = encloses.then_some(six_volumes / 6.0);
    }
}

/// Joins the corners at the same vertex of triangles that share an edge, for
/// edges that `joins` accepts. Names of sets are corner numbers.
pub(crate) fn fans_across(
    triangles: &[[u32; 3]],
    table: &EdgeTable,
    joins: impl Fn(&[u32]) -> bool,
) -> DisjointSets {
    let corners = TriangleCorners(triangles);
    let mut fans = DisjointSets::new(corners.len());
    for edge in table.iter().filter(|edge| joins(edge)) {
        for pair in edge.windows(2) {
            let (c, d) = (pair[0], pair[1]);
            let (c_next, d_next) = (corners.next(c), corners.next(d));
            let same_way = corners.vertex(c) == corners.vertex(d);
            let (c_at_d, c_next_at) = if same_way { (d, d_next) } else { (d_next, d) };
            fans.unite(c, c_at_d);
            fans.unite(c_next, c_next_at);
        }
    }
    fans
}

fn count_duplicates(triangles: &[[u32; 3]]) -> usize {
    let sorted = |&(mut t): &[u32; 3]| {
        t.sort_unstable();
        t
    };
    let mut keys: Vec<[u32; 3]> = triangles.par_iter().map(sorted).collect();
    keys.par_sort_unstable();
    keys.windows(2).filter(|pair| pair[0] == pair[1]).count()
}

fn count_unreferenced(triangles: &[[u32; 3]], vertices: usize) -> usize {
    let mut used = vec![false; vertices];
    for &v in triangles.as_flattened() {
        used[v as usize] = true;
    }
    used.into_iter().filter(|used| !used).count()
}

fn count_uv_charts(
    mesh: &TriMesh,
    triangles: &[[u32; 3]],
    table: &EdgeTable,
) -> Result<Option<usize>> {
    let Some(uvs) = mesh.attributes.uvs.first() else {
        return Ok(None);
    };
    if uvs.len() != mesh.positions.len() {
        return Err(Error::LengthMismatch {
            what: "uv set 0".into(),
            expected: mesh.positions.len(),
            found: uvs.len(),
        });
    }
    let corners = TriangleCorners(triangles);
    let uv = |c: u32| uvs[mesh.triangles.as_flattened()[c as usize] as usize];
    // The UVs of an edge, at its lesser end first.
    let edge_uvs = |c: u32| {
        let [a, b] = corners.edge(c);
        let [first, last] = if a < b {
            [c, corners.next(c)]
        } else {
            [corners.next(c), c]
        };
        [uv(first), uv(last)]
    };
    let mut charts = DisjointSets::new(triangles.len());
    for edge in table.iter() {
        for (i, &c) in edge.iter().enumerate().take(MAX_FACES_AT_EDGE) {
            let equal = |&&d: &&u32| edge_uvs(c) == edge_uvs(d);
            if let Some(&d) = edge[..i].iter().find(equal) {
                charts.unite(c / 3, d / 3);
            }
        }
    }
    let names_a_chart = |t: &u32| is_proper(triangles[*t as usize]) && charts.find(*t) == *t;
    Ok(Some(
        (0..triangles.len() as u32).filter(names_a_chart).count(),
    ))
}

/// Beyond so many triangles at one edge, comparing all pairs of their UVs
/// would take too long; the rest count as charts of their own.
const MAX_FACES_AT_EDGE: usize = 1000;
