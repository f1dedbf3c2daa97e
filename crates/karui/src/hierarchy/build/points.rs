//! What a build knows of every vertex before the first collapse.
//!
//! A point is a vertex of the topology: all vertices at one position whose
//! triangles form one fan. Vertices of one point differ where a seam runs.

use crate::error::{Error, Result};
use crate::geom;
use crate::hierarchy::options::{BuildCounts, HierarchyOptions};
use crate::hierarchy::surface::{Half, Moves, NONE, Sides, Surface, next, prev};
use crate::mesh::{
    Attribute, AttributeValues, NormalWeight, PositionIds, RepairOptions, Repaired, TriMesh,
    repair, vertex_normals,
};
use crate::simplify::Quadric;
use glam::DVec3;
use rayon::prelude::*;

/// The input as a build sees it.
pub(super) struct Points {
    /// Faces between points.
    pub surface: Surface,
    /// Vertex of the input at every corner.
    pub vertex: Vec<u32>,
    /// Triangle of the input that every face is.
    pub triangle_of_face: Vec<u32>,
    /// Material range of every face.
    pub range: Vec<u32>,
    pub points: Vec<Point>,
    /// Unit normal of every vertex of the input.
    pub normal: Vec<DVec3>,
    /// Planes through the borders and seams at every point, upright on their
    /// faces; empty if there are none at all.
    pub edges: Vec<Quadric>,
    /// By which single precision is fit for the cross products of short edges.
    pub scale: f64,
    pub counts: BuildCounts,
}

/// What a price is made of, side by side: most of a build's time goes by
/// waiting for it.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(super) struct Point {
    pub position: DVec3,
    /// A corner there; [`NONE`] if the point has gone or never had one.
    pub corner: u32,
    /// Number of faces.
    pub degree: u32,
    /// Factor to the cost.
    pub weight: f32,
    pub border: bool,
    /// Whether a border or seam ends there or runs through.
    pub on_edge: bool,
    pub locked: bool,
    /// Those of the faces.
    pub planes: Quadric,
}

impl Point {
    const NEW: Self = Self {
        position: DVec3::ZERO,
        corner: NONE,
        degree: 0,
        weight: 1.0,
        border: false,
        on_edge: false,
        locked: false,
        planes: Quadric::ZERO,
    };
}

/// Diagonals of the mesh in a unit of single precision.
const UNITS: f64 = 1e4;

impl Points {
    pub fn new(mesh: &TriMesh, options: &HierarchyOptions<'_>) -> Result<Self> {
        let options_of_repair = RepairOptions {
            drop_unreferenced: false,
            ..RepairOptions::default()
        };
        let repaired = repair(&numbered(mesh), &options_of_repair)?;
        if repaired.mesh.triangles.len() >= (1 << 31) / 3 {
            return Err(Error::TooLarge {
                what: "triangles",
                found: repaired.mesh.triangles.len(),
                limit: (1 << 31) / 3,
            });
        }
        let mut points = Self::of(mesh, &repaired, options)?;
        points.count_faces();
        points.add_planes(&repaired);
        points.add_edges(&repaired);
        Ok(points)
    }

    fn of(mesh: &TriMesh, repaired: &Repaired, options: &HierarchyOptions<'_>) -> Result<Self> {
        let at_corner = repaired
            .ids
            .triangles(&repaired.mesh.triangles)
            .into_flattened();
        let triangle_of_face = kept(repaired);
        let range_of = mesh.range_of_triangles();
        let vertex = triangle_of_face
            .iter()
            .flat_map(|&t| mesh.triangles[t as usize]);
        let mut all = Self {
            vertex: vertex.collect(),
            range: triangle_of_face
                .iter()
                .map(|&t| range_of[t as usize])
                .collect(),
            points: vec![Point::NEW; repaired.ids.count],
            normal: normals(mesh)?,
            edges: Vec::new(),
            scale: UNITS / mesh.bounds().diagonal().max(f64::MIN_POSITIVE),
            counts: BuildCounts {
                dropped: mesh.triangles.len() - triangle_of_face.len(),
                split_edges: repaired.counts.split_edges,
                split_vertices: repaired.counts.split_vertices,
                coarsest: 0,
            },
            surface: connect(&at_corner, repaired.ids.count),
            triangle_of_face,
        };
        all.place(mesh, options);
        all.lock_split();
        Ok(all)
    }

    /// Position, weight and lock of every point, from its vertices.
    fn place(&mut self, mesh: &TriMesh, options: &HierarchyOptions<'_>) {
        for (c, (&v, half)) in self.vertex.iter().zip(&self.surface.halves).enumerate() {
            let (v, point) = (v as usize, &mut self.points[half.start as usize]);
            let weight = options.weights.map_or(1.0, |w| w[v]);
            let first = point.corner == NONE;
            if first {
                point.corner = c as u32;
                point.position = mesh.positions[v].as_dvec3();
            }
            point.weight = if first {
                weight
            } else {
                point.weight.max(weight)
            };
            point.locked |= options.locks.is_some_and(|l| l[v]);
        }
    }

    /// Points that lie where another does are held, or a crack would open.
    fn lock_split(&mut self) {
        let mut used: Vec<&mut Point> = self
            .points
            .iter_mut()
            .filter(|p| p.corner != NONE)
            .collect();
        let places: Vec<_> = used.iter().map(|p| p.position.as_vec3()).collect();
        let ids = PositionIds::of(&places);
        let mut points_at = vec![0u32; ids.count];
        ids.of_vertex
            .iter()
            .for_each(|&id| points_at[id as usize] += 1);
        for (point, &id) in used.iter_mut().zip(&ids.of_vertex) {
            point.locked |= points_at[id as usize] > 1;
        }
    }

    fn count_faces(&mut self) {
        for h in 0..self.vertex.len() as u32 {
            self.at_mut(h).degree += 1;
            if self.surface.opposite(h) == NONE {
                self.at_mut(h).border = true;
                self.at_mut(next(h)).border = true;
            }
        }
    }

    fn add_planes(&mut self, repaired: &Repaired) {
        for f in 0..self.range.len() {
            let corners = repaired.mesh.corners(f);
            if let Some(n) = geom::normal_times_two_areas(corners).try_normalize() {
                let plane = Quadric::plane(n, n.dot(corners[0]), 1.0);
                for h in 3 * f as u32..3 * f as u32 + 3 {
                    self.at_mut(h).planes += plane;
                }
            }
        }
    }

    fn add_edges(&mut self, repaired: &Repaired) {
        for h in 0..self.vertex.len() as u32 {
            if self.is_inner(h) {
                continue;
            }
            if self.edges.is_empty() {
                self.edges = vec![Quadric::ZERO; self.points.len()];
            }
            let corners = repaired.mesh.corners(h as usize / 3);
            let [a, b] = [h, next(h)].map(|c| corners[c as usize % 3]);
            let upright = geom::normal_times_two_areas(corners).cross(b - a);
            let plane = upright
                .try_normalize()
                .map(|n| Quadric::plane(n, n.dot(a), 1.0));
            for c in [h, next(h)] {
                self.at_mut(c).on_edge = true;
                self.edges[self.surface.start(c) as usize] += plane.unwrap_or_default();
            }
        }
    }

    /// The point at a corner.
    #[inline]
    pub fn at(&self, corner: u32) -> &Point {
        &self.points[self.surface.start(corner) as usize]
    }

    fn at_mut(&mut self, corner: u32) -> &mut Point {
        &mut self.points[self.surface.start(corner) as usize]
    }

    /// Whether neither a border nor a seam of vertices or materials runs along
    /// a half-edge.
    pub fn is_inner(&self, h: u32) -> bool {
        let other = self.surface.opposite(h);
        let vertex = |h: u32| self.vertex[h as usize];
        other != NONE
            && vertex(h) == vertex(next(other))
            && vertex(next(h)) == vertex(other)
            && self.range[h as usize / 3] == self.range[other as usize / 3]
    }

    /// The corners at a point in order, and whether they go all around. Faces
    /// that are hidden are not among them if `first` is in one that is not.
    pub fn around(&self, first: u32, corners: &mut Vec<u32>) -> bool {
        let opposite = |h: u32| self.surface.opposite(h);
        let mut start = first;
        if self.at(first).border {
            // To where the fan begins.
            while opposite(start) != NONE {
                start = next(opposite(start));
            }
        }
        corners.clear();
        let mut at = start;
        loop {
            corners.push(at);
            at = opposite(prev(at));
            if at == NONE {
                return false;
            }
            if at == start {
                return true;
            }
        }
    }
}

/// The triangles of the input that are still there after a repair of a mesh
/// that [`numbered`] made.
fn kept(repaired: &Repaired) -> Vec<u32> {
    match repaired.mesh.face_attributes.first().map(|a| &a.values) {
        Some(AttributeValues::U32(numbers)) => numbers.clone(),
        _ => (0..repaired.mesh.triangles.len() as u32).collect(),
    }
}

/// The geometry alone, with the number of every triangle.
fn numbered(mesh: &TriMesh) -> TriMesh {
    let number = Attribute {
        name: "triangle".into(),
        components: 1,
        values: AttributeValues::U32((0..mesh.triangles.len() as u32).collect()),
    };
    TriMesh {
        face_attributes: vec![number],
        ..TriMesh::new(mesh.positions.clone(), mesh.triangles.clone())
    }
}

fn normals(mesh: &TriMesh) -> Result<Vec<DVec3>> {
    let stored = mesh.attributes.normals.as_deref().unwrap_or_default();
    let computed = vertex_normals(mesh, &PositionIds::of_mesh(mesh), NormalWeight::Area)?;
    let good = |n: &glam::Vec3| n.as_dvec3().try_normalize();
    let unit = |(v, own): (usize, &glam::Vec3)| {
        let own = own.as_dvec3().normalize_or(DVec3::Z);
        stored.get(v).and_then(good).unwrap_or(own)
    };
    Ok(computed.par_iter().enumerate().map(unit).collect())
}

/// The half-edges of a manifold surface, from the points at its corners.
fn connect(at_corner: &[u32], points: usize) -> Surface {
    let mut starts = vec![0u32; points + 1];
    for &p in at_corner {
        starts[p as usize + 1] += 1;
    }
    for p in 0..points {
        starts[p + 1] += starts[p];
    }
    let mut fill = starts.clone();
    let mut leaving = vec![0u32; at_corner.len()];
    for (h, &p) in (0u32..).zip(at_corner) {
        leaving[fill[p as usize] as usize] = h;
        fill[p as usize] += 1;
    }
    let half = |h: u32| {
        let from = at_corner[next(h) as usize] as usize;
        let start = at_corner[h as usize];
        let candidates = &leaving[starts[from] as usize..starts[from + 1] as usize];
        let ends_here = |&&k: &&u32| at_corner[next(k) as usize] == start;
        let opposite = candidates.iter().find(ends_here).copied().unwrap_or(NONE);
        Half { start, opposite }
    };
    let halves = (0..at_corner.len() as u32).into_par_iter().map(half);
    Surface {
        halves: halves.collect(),
    }
}

impl Points {
    /// Collapses `point` and returns the point that stays.
    pub fn collapse(&mut self, point: u32, half_edge: u32) -> u32 {
        let sides = self.surface.sides(half_edge);
        let kept = self.surface.moves(sides).left[1];
        let moves = Moves::new(sides, |h| self.vertex[h as usize]);
        self.move_anchors(sides, kept);
        let (vertex, anchor) = (&mut self.vertex, &mut self.points[kept as usize].corner);
        self.surface.collapse(half_edge, |c, _| {
            let v = &mut vertex[c as usize];
            *v = moves.kept(*v);
            *anchor = c;
        });
        let hidden = sides.faces().count() as u32;
        let (p, k) = (point as usize, kept as usize);
        let Point { degree, planes, .. } = self.points[p];
        self.points[p].corner = NONE;
        self.points[k].degree = self.points[k].degree + degree - 2 * hidden;
        self.points[k].planes += planes;
        if let Some(&edges) = self.edges.get(p) {
            self.edges[k] += edges;
        }
        kept
    }

    /// Gives the points of the faces to be hidden corners elsewhere.
    fn move_anchors(&mut self, sides: Sides, kept: u32) {
        for (h, is_left) in [(sides.left, true), (sides.right, false)] {
            if h == NONE {
                continue;
            }
            let apex = self.surface.start(prev(h)) as usize;
            let [after, before] = [next(h), prev(h)].map(|k| self.surface.opposite(k));
            // Left: `after` runs from the apex to the kept point. Right: it runs
            // from the apex to the removed one, `before` from kept to apex.
            let at_apex = match (after, before) {
                (NONE, before) => next(before),
                (after, _) => after,
            };
            self.points[apex].degree -= 1;
            self.points[apex].corner = at_apex;
            let at_kept = if is_left { after } else { before };
            if at_kept != NONE {
                let corner = if is_left { next(at_kept) } else { at_kept };
                self.points[kept as usize].corner = corner;
            }
        }
    }

    /// The faces with the vertices of the input, before any collapse.
    pub fn drawn(&self) -> Surface {
        let halves = self.surface.halves.iter().zip(&self.vertex);
        let drawn = halves.map(|(half, &start)| Half { start, ..*half });
        Surface {
            halves: drawn.collect(),
        }
    }
}
