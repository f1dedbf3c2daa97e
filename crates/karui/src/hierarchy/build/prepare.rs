//! From a mesh to its [`Points`]: cut open what is not manifold, put what lies
//! together side by side, find the half-edges and what every point starts with.

use super::points::{Point, Points};
use crate::error::{Error, Result};
use crate::geom;
use crate::hierarchy::options::{BuildCounts, HierarchyOptions};
use crate::hierarchy::surface::{Half, NONE, Surface, next, prev};
use crate::mesh::{
    Attribute, AttributeValues, NormalWeight, PositionIds, RepairOptions, Repaired, TriMesh,
    repair, vertex_normals,
};
use crate::simplify::Quadric;
use crate::spatial::morton;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

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
        let normal = normals(mesh, &repaired)?;
        let faces = Faces::in_order(repaired);
        let mut all = Self::of(mesh, &faces, normal);
        let fans = Fans::new(&faces);
        all.surface = fans.connect(&faces.at_corner);
        let count = all.points.len() as u32;
        let point = |p: u32| all.point(p, fans.at(p), options);
        all.points = (0..count).into_par_iter().map(point).collect();
        let planes = |p: u32| fans.at(p).iter().map(|&c| all.plane(c)).sum();
        all.planes = (0..count).into_par_iter().map(planes).collect();
        if all.points.iter().any(|p| p.on_edge) {
            let edges = |p: u32| all.edges_at(fans.at(p));
            all.edges = (0..count).into_par_iter().map(edges).collect();
        }
        if all.counts.split_edges + all.counts.split_vertices > 0 {
            all.lock_split();
        }
        Ok(all)
    }

    /// All that is known of corners alone.
    fn of(mesh: &TriMesh, faces: &Faces, normal: Vec<DVec3>) -> Self {
        let range_of = mesh.range_of_triangles();
        let triangles = faces.triangle.par_iter();
        let vertex: Vec<[u32; 3]> = triangles.map(|&t| mesh.triangles[t as usize]).collect();
        let triangles = faces.triangle.par_iter();
        let at = |&place: &Vec3| Point {
            place,
            ..Point::NEW
        };
        Self {
            vertex: vertex.into_flattened(),
            range: triangles.map(|&t| range_of[t as usize]).collect(),
            triangle_of_face: faces.triangle.clone(),
            surface: Surface { halves: Vec::new() },
            points: faces.places.iter().map(at).collect(),
            planes: Vec::new(),
            edges: Vec::new(),
            normal,
            scale: UNITS / mesh.bounds().diagonal().max(f64::MIN_POSITIVE),
            counts: BuildCounts {
                dropped: mesh.triangles.len() - faces.triangle.len(),
                ..faces.counts
            },
        }
    }

    /// What is known of a point, and of these corners there.
    fn point(&self, p: u32, corners: &[u32], options: &HierarchyOptions<'_>) -> Point {
        let place = self.points[p as usize].place;
        let Some(&first) = corners.first() else {
            return Point {
                place,
                ..Point::NEW
            };
        };
        let vertices = corners.iter().map(|&c| self.vertex[c as usize] as usize);
        let edges = || corners.iter().flat_map(|&c| [c, prev(c)]);
        let weights = options
            .weights
            .map(|w| vertices.clone().map(|v| w[v]).fold(0.0, f32::max));
        Point {
            place,
            corner: first,
            degree: corners.len() as u32,
            weight: weights.unwrap_or(1.0),
            border: edges().any(|h| self.surface.opposite(h) == NONE),
            on_edge: edges().any(|h| !self.is_inner(h)),
            locked: options
                .locks
                .is_some_and(|l| vertices.clone().any(|v| l[v])),
        }
    }

    fn corners_of_face(&self, h: u32) -> [DVec3; 3] {
        [0, 1, 2].map(|k| self.at(h / 3 * 3 + k).position())
    }

    /// The plane of the face of a corner; nothing if it has no area.
    fn plane(&self, h: u32) -> Quadric {
        let corners = self.corners_of_face(h);
        let normal = geom::normal_times_two_areas(corners).try_normalize();
        normal.map_or(Quadric::ZERO, |n| Quadric::plane(n, n.dot(corners[0]), 1.0))
    }

    /// The planes through the borders and seams at a point.
    fn edges_at(&self, corners: &[u32]) -> Quadric {
        let edges = corners.iter().flat_map(|&c| [c, prev(c)]);
        let along = edges.filter(|&h| !self.is_inner(h));
        along.map(|h| self.upright(h)).sum()
    }

    /// The plane through an edge, upright on its face.
    fn upright(&self, h: u32) -> Quadric {
        let corners = self.corners_of_face(h);
        let [a, b] = [h, next(h)].map(|c| corners[c as usize % 3]);
        let upright = geom::normal_times_two_areas(corners).cross(b - a);
        let normal = upright.try_normalize();
        normal.map_or(Quadric::ZERO, |n| Quadric::plane(n, n.dot(a), 1.0))
    }

    /// Points that lie where another does are held, or a crack would open.
    fn lock_split(&mut self) {
        let used = self.points.iter_mut().filter(|p| p.corner != NONE);
        let mut used: Vec<&mut Point> = used.collect();
        let places: Vec<_> = used.iter().map(|p| p.place).collect();
        let ids = PositionIds::of(&places);
        let mut points_at = vec![0u32; ids.count];
        ids.of_vertex
            .iter()
            .for_each(|&id| points_at[id as usize] += 1);
        for (point, &id) in used.iter_mut().zip(&ids.of_vertex) {
            point.locked |= points_at[id as usize] > 1;
        }
    }
}

/// The faces of a repaired mesh, those that lie together side by side: most of a
/// build's time goes by waiting for memory.
struct Faces {
    /// Point at every corner.
    at_corner: Vec<u32>,
    /// Triangle of the input that every face is.
    triangle: Vec<u32>,
    /// Where every point is.
    places: Vec<Vec3>,
    counts: BuildCounts,
}

impl Faces {
    fn in_order(repaired: Repaired) -> Self {
        let mut places = vec![Vec3::ZERO; repaired.ids.count];
        for (&id, &place) in repaired.ids.of_vertex.iter().zip(&repaired.mesh.positions) {
            places[id as usize] = place;
        }
        let order = morton::order(&places);
        let mut rank = vec![0u32; order.len()];
        for (i, &p) in (0u32..).zip(&order) {
            rank[p as usize] = i;
        }
        let at_corner = repaired.ids.triangles(&repaired.mesh.triangles);
        let ranked = at_corner.par_iter().map(|t| t.map(|p| rank[p as usize]));
        let ranked: Vec<[u32; 3]> = ranked.collect();
        let first = |(f, t): (usize, &[u32; 3])| (t[0].min(t[1]).min(t[2]), f as u32);
        let mut faces: Vec<(u32, u32)> = ranked.par_iter().enumerate().map(first).collect();
        faces.par_sort_unstable();
        let kept = kept(&repaired);
        let at_corner: Vec<[u32; 3]> = faces.iter().map(|f| ranked[f.1 as usize]).collect();
        Self {
            at_corner: at_corner.into_flattened(),
            triangle: faces.iter().map(|f| kept[f.1 as usize]).collect(),
            places: order.iter().map(|&p| places[p as usize]).collect(),
            counts: BuildCounts {
                split_edges: repaired.counts.split_edges,
                split_vertices: repaired.counts.split_vertices,
                ..BuildCounts::default()
            },
        }
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

/// The triangles of the input that are still there after a repair of a mesh
/// that [`numbered`] made.
fn kept(repaired: &Repaired) -> Vec<u32> {
    match repaired.mesh.face_attributes.first().map(|a| &a.values) {
        Some(AttributeValues::U32(numbers)) => numbers.clone(),
        _ => (0..repaired.mesh.triangles.len() as u32).collect(),
    }
}

/// The unit normals of the mesh, computed where it has none.
fn normals(mesh: &TriMesh, repaired: &Repaired) -> Result<Vec<DVec3>> {
    let stored = mesh.attributes.normals.as_deref().unwrap_or_default();
    let stored: Vec<Option<DVec3>> = stored
        .par_iter()
        .map(|n| n.as_dvec3().try_normalize())
        .collect();
    if stored.len() == mesh.positions.len() {
        let all: Option<Vec<DVec3>> = stored.iter().copied().collect();
        if let Some(all) = all {
            return Ok(all);
        }
    }
    let is_whole = repaired.counts.split_edges + repaired.counts.split_vertices == 0;
    let ids = (!is_whole).then(|| PositionIds::of_mesh(mesh));
    let ids = ids.as_ref().unwrap_or(&repaired.ids);
    let computed = vertex_normals(mesh, ids, NormalWeight::Area)?;
    let unit = |(v, own): (usize, &Vec3)| {
        let own = || own.as_dvec3().normalize_or(DVec3::Z);
        stored.get(v).copied().flatten().unwrap_or_else(own)
    };
    Ok(computed.par_iter().enumerate().map(unit).collect())
}

/// The corners at every point, in their order.
struct Fans {
    starts: Vec<u32>,
    corners: Vec<u32>,
}

impl Fans {
    fn new(faces: &Faces) -> Self {
        let points = faces.places.len();
        let mut starts = vec![0u32; points + 1];
        for &p in &faces.at_corner {
            starts[p as usize + 1] += 1;
        }
        for p in 0..points {
            starts[p + 1] += starts[p];
        }
        let mut fill = starts.clone();
        let mut corners = vec![0u32; faces.at_corner.len()];
        for (h, &p) in (0u32..).zip(&faces.at_corner) {
            corners[fill[p as usize] as usize] = h;
            fill[p as usize] += 1;
        }
        Self { starts, corners }
    }

    fn at(&self, point: u32) -> &[u32] {
        let [first, end] = [0, 1].map(|k| self.starts[point as usize + k] as usize);
        &self.corners[first..end]
    }

    /// The half-edges of a manifold surface, from the points at its corners.
    fn connect(&self, at_corner: &[u32]) -> Surface {
        let half = |h: u32| {
            let start = at_corner[h as usize];
            let candidates = self.at(at_corner[next(h) as usize]);
            let ends_here = |&&k: &&u32| at_corner[next(k) as usize] == start;
            let opposite = candidates.iter().find(ends_here).copied().unwrap_or(NONE);
            Half { start, opposite }
        };
        let halves = (0..at_corner.len() as u32).into_par_iter().map(half);
        Surface {
            halves: halves.collect(),
        }
    }
}
