//! Where the vertex that stands for a group goes.

use super::border::Border;
use super::grid::differ;
use super::groups::Groups;
use crate::mesh::TriMesh;
use glam::{DMat3, DMat4, DVec3, Vec3, Vec3A, Vec4};
use rayon::prelude::*;
use std::ops::Range;

/// Positions of all points and how far off they are.
pub(super) struct Placed {
    /// Position of every point, model units.
    pub positions: Vec<Vec3>,
    /// Estimate of the error, model units.
    pub error: f64,
}

/// A mesh, grouped.
#[derive(Clone, Copy)]
pub(super) struct Surface<'a> {
    pub mesh: &'a TriMesh,
    pub groups: &'a Groups,
    /// Its open borders, if there are any.
    pub border: Option<&'a Border<'a>>,
}

/// Places every point where the planes of its triangles (and the lines of its
/// borders) meet best, within the cell of side `cell` that `cell_of` gives for
/// its first vertex; those without a cell and those of one position only stay.
pub(super) fn place(
    surface: Surface<'_>,
    cell: f64,
    cell_of: impl Fn(u32) -> Option<[DVec3; 2]> + Sync,
) -> Placed {
    let Surface { mesh, groups, .. } = surface;
    let blocks = blocks(groups.points);
    let extents = match blocks.len() {
        0 | 1 => vec![[0, u32::MAX]; mesh.triangles.len().div_ceil(CHUNK)],
        _ => extents(mesh, groups),
    };
    let per_unit = (1.0 / cell) as f32;
    let place_block = |block: Range<u32>| {
        let sums = Block::new(surface, block.clone(), per_unit).summed(&extents);
        let placed = sums.iter().zip(block).map(|(sum, p)| {
            let walls = cell_of(groups.first_vertex[p as usize]);
            sum.place(walls, cell)
        });
        placed.collect::<Vec<(Vec3, f64)>>()
    };
    let placed: Vec<(Vec3, f64)> = blocks.into_par_iter().flat_map_iter(place_block).collect();
    Placed {
        error: placed.iter().map(|p| p.1).fold(0.0, f64::max),
        positions: placed.into_iter().map(|p| p.0).collect(),
    }
}

/// Triangles in a row that share an entry of [`extents`].
const CHUNK: usize = 1024;

/// One block of points a thread: each adds up the sums of its own points in
/// the order of the triangles, so that they do not depend on the blocks.
fn blocks(points: usize) -> Vec<Range<u32>> {
    let size = points.div_ceil(rayon::current_num_threads()).max(256);
    (0..points)
        .step_by(size)
        .map(|first| first as u32..(first + size).min(points) as u32)
        .collect()
}

/// Least and greatest point of every chunk of triangles.
fn extents(mesh: &TriMesh, groups: &Groups) -> Vec<[u32; 2]> {
    let of_chunk = |chunk: &[[u32; 3]]| {
        let points = chunk.iter().flatten().map(|&v| groups.point_of[v as usize]);
        points.fold([u32::MAX, 0], |[least, greatest], p| {
            [least.min(p), greatest.max(p)]
        })
    };
    mesh.triangles.par_chunks(CHUNK).map(of_chunk).collect()
}

/// The sums of a range of points.
struct Block<'a> {
    surface: Surface<'a>,
    points: Range<u32>,
    per_unit: f32,
    sums: Vec<Sums>,
}

impl<'a> Block<'a> {
    fn new(surface: Surface<'a>, points: Range<u32>, per_unit: f32) -> Self {
        let Surface { mesh, groups, .. } = surface;
        let first = &groups.first_vertex[points.start as usize..points.end as usize];
        let sum = |&v: &u32| Sums::new(mesh.positions[v as usize]);
        Self {
            surface,
            points,
            per_unit,
            sums: first.iter().map(sum).collect(),
        }
    }

    fn summed(mut self, extents: &[[u32; 2]]) -> Vec<Sums> {
        let triangles = &self.surface.mesh.triangles;
        for (chunk, &[least, greatest]) in triangles.chunks(CHUNK).zip(extents) {
            if least < self.points.end && greatest >= self.points.start {
                chunk.iter().for_each(|&t| self.add(t));
            }
        }
        self.sums
    }

    /// Adds a triangle to the points of the block among its corners.
    fn add(&mut self, triangle: [u32; 3]) {
        let Surface {
            mesh,
            groups,
            border,
        } = self.surface;
        let points = triangle.map(|v| groups.point_of[v as usize]);
        if !points.iter().any(|p| self.points.contains(p)) {
            return;
        }
        let corners = triangle.map(|v| Vec3A::from(mesh.positions[v as usize]));
        let sides = [1, 2].map(|k| (corners[k] - corners[0]) * self.per_unit);
        let normal = sides[0].cross(sides[1]);
        let two_areas = normal.length();
        if !(two_areas > 0.0 && two_areas < f32::INFINITY) {
            return;
        }
        let normal = normal / two_areas;
        let alive = differ(&points);
        for (k, point) in points.into_iter().enumerate() {
            if points[..k].contains(&point) || !self.points.contains(&point) {
                continue;
            }
            // 1 for the corners that are this point's.
            let own = points.map(|p| f32::from(u8::from(p == point)));
            let sum = &mut self.sums[(point - self.points.start) as usize];
            let first = (corners[0] - sum.origin) * self.per_unit;
            sum.alive |= alive;
            sum.add_corners(first, sides, own, two_areas);
            let share = (own[0] + own[1] + own[2]) / 3.0;
            sum.add_plane(normal, first, two_areas * share);
        }
        if let Some(border) = border {
            (0..3)
                .filter(|&k| border.has(triangle[k], triangle[(k + 1) % 3]))
                .for_each(|k| self.add_border(points, corners, normal, k));
        }
    }

    /// Adds the plane that stands on a triangle's edge from corner `k`.
    fn add_border(&mut self, points: [u32; 3], corners: [Vec3A; 3], normal: Vec3A, k: usize) {
        let ends = [k, (k + 1) % 3];
        let edge = (corners[ends[1]] - corners[ends[0]]) * self.per_unit;
        let length = edge.length();
        let outward = (edge / length).cross(normal);
        if !outward.is_finite() {
            return;
        }
        for end in ends.map(|k| points[k]) {
            if self.points.contains(&end) {
                let sum = &mut self.sums[(end - self.points.start) as usize];
                let through = (corners[ends[0]] - sum.origin) * self.per_unit;
                sum.add_plane(outward, through, BORDER * length);
            }
        }
    }
}

/// What a point's triangles add up to, relative to one of its vertices and in
/// cells: so numbers stay about 1, and single precision is enough. The sums
/// are the inner loop.
struct Sums {
    /// The quadric, times twice the area: A and -b, -b and c.
    planes: [Vec4; 4],
    /// Corners, weighted by the areas of their triangles; the weight in w.
    corners: Vec4,
    /// Squares of their coordinates, weighted likewise.
    squares: Vec3A,
    origin: Vec3A,
    /// Whether a triangle is left at it.
    alive: bool,
}

/// Weight of a border as long as a cell, in cell faces.
const BORDER: f32 = 1.0;
/// Share of the pull to the mean, where the planes leave a direction open.
const PULL: f64 = 1e-3;

impl Sums {
    fn new(origin: Vec3) -> Self {
        Self {
            planes: [Vec4::ZERO; 4],
            corners: Vec4::ZERO,
            squares: Vec3A::ZERO,
            origin: origin.into(),
            alive: false,
        }
    }

    /// Adds those of a triangle's corners that are its own: the first, and the
    /// two at the ends of `sides` from there.
    fn add_corners(&mut self, first: Vec3A, sides: [Vec3A; 2], own: [f32; 3], weight: f32) {
        let [a, b, c] = own.map(|own| own * weight);
        let [second, third] = sides.map(|side| first + side);
        let sum = first * a + second * b + third * c;
        self.corners += sum.extend(a + b + c);
        self.squares += first * first * a + second * second * b + third * third * c;
    }

    fn add_plane(&mut self, normal: Vec3A, through: Vec3A, weight: f32) {
        let plane = normal.extend(-normal.dot(through));
        let weighted = plane * weight;
        self.planes[0] += plane * weighted.x;
        self.planes[1] += plane * weighted.y;
        self.planes[2] += plane * weighted.z;
        self.planes[3] += plane * weighted.w;
    }

    /// The position and how far it is off, model units; `walls` are the
    /// corners of the cell.
    fn place(&self, walls: Option<[DVec3; 2]>, cell: f64) -> (Vec3, f64) {
        // Points of one position stay where they are, to the bit.
        let Some(walls) = walls.filter(|_| self.squares != Vec3A::ZERO) else {
            return (self.origin.into(), 0.0);
        };
        let origin = Vec3::from(self.origin).as_dvec3();
        let walls = walls.map(|w| (w - origin) / cell);
        let mean = self.corners.truncate().as_dvec3() / f64::from(self.corners.w);
        let best = self.best(mean);
        let inside = mean + (best - mean) * share_within(mean, best, walls);
        let position = (inside * cell + origin).as_vec3();
        let off = cell
            * if self.alive {
                self.off(inside)
            } else {
                self.radius(mean)
            };
        if position.is_finite() && off.is_finite() {
            (position, off)
        } else {
            (self.origin.into(), 0.0)
        }
    }

    /// Least sum of squared distances to the planes.
    fn best(&self, mean: DVec3) -> DVec3 {
        let [x, y, z, linear] = self.planes.map(|row| row.truncate().as_dvec3());
        let pull = PULL * (x.x + y.y + z.z);
        let matrix = DMat3::from_cols(x, y, z) + DMat3::from_diagonal(DVec3::splat(pull));
        let best = matrix.inverse() * (mean * pull - linear);
        if best.is_finite() { best } else { mean }
    }

    /// Root mean square distance from the planes.
    fn off(&self, place: DVec3) -> f64 {
        let rows = self.planes.map(Vec4::as_dvec4);
        let place = place.extend(1.0);
        let sum = place.dot(DMat4::from_cols_array_2d(&rows.map(|r| r.to_array())) * place);
        let weight = rows[0].x + rows[1].y + rows[2].z;
        (sum / weight).max(0.0).sqrt()
    }

    /// Root mean square distance of the corners from their mean.
    fn radius(&self, mean: DVec3) -> f64 {
        let squares = f64::from(self.squares.element_sum()) / f64::from(self.corners.w);
        (squares - mean.length_squared()).max(0.0).sqrt()
    }
}

/// How far one can go from `from`, inside the cell, towards `to`, `0..=1`.
fn share_within(from: DVec3, to: DVec3, [min, max]: [DVec3; 2]) -> f64 {
    let step = to - from;
    let along = |k: usize| {
        let wall = if step[k] > 0.0 { max[k] } else { min[k] };
        let room = (wall - from[k]) / step[k];
        if room.is_finite() { room.max(0.0) } else { 1.0 }
    };
    along(0).min(along(1)).min(along(2)).min(1.0)
}
