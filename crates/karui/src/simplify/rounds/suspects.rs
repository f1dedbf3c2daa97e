//! Finds triangles that oppose the input without an index over all of it:
//! nearly all of them disagree with the input's normals that their corners
//! stand for. Only what is near to those that do is indexed.

use super::level::Level;
use super::mend::normal;
use crate::error::Result;
use crate::geom::{closest_point, normal_times_two_areas};
use crate::mesh::TriMesh;
use crate::spatial::{Bvh, Facings, Normals};
use glam::{DVec3, UVec3, Vec3};
use rayon::prelude::*;

/// Cosine to the input's normals below which a triangle is suspect, as the
/// share of these that agree.
const SUSPECT: f32 = 0.5;
/// Most cells an axis of the grid in which they are marked.
const CELLS: u32 = 256;
/// Sides of a triangle in a cell, about, if the surface were a square.
const WIDE: f32 = 4.0;
/// A box over more cells than this is taken to touch a marked one.
const MANY: u32 = 64;
/// Where the input is first looked for, in longest sides of a suspect.
const CLOSE: f32 = 0.25;

/// The suspects of a level that do oppose the triangle of `mesh`, the input,
/// nearest to them; `scale` is what a model unit is in scaled ones.
///
/// # Errors
/// As [`Bvh::build_quick`].
pub(crate) fn suspects_against(level: &Level, mesh: &TriMesh, scale: f32) -> Result<Vec<u32>> {
    let corners = |t: u32| level.triangle[t as usize].map(|p| level.place(p) / scale);
    let open = suspects(level).into_iter().map(|t| Suspect {
        triangle: t,
        corners: corners(t),
        source: mesh.corners(level.source_of(t) as usize),
    });
    let mut open: Vec<Suspect> = open.collect();
    let mut against = Vec::new();
    // The input is close to nearly all, so that little of it is indexed first.
    for reach in [Suspect::close, Suspect::far] {
        let mut grid = Grid::over(mesh);
        open.iter().for_each(|s| grid.mark(s.center(), reach(s)));
        let near = grid.marked_of(mesh);
        if near.triangles.is_empty() {
            continue;
        }
        let near = Bvh::build_quick(&near)?;
        let facings = Facings::of(&near);
        open.retain(|suspect| {
            if suspect.clearly_agrees(&near, &facings, reach(suspect)) {
                return false;
            }
            let (opposed, distance) = suspect.stands_to(&near);
            let known = distance <= f64::from(reach(suspect));
            against.extend((known && opposed).then_some(suspect.triangle));
            !known
        });
    }
    against.sort_unstable();
    Ok(against)
}

/// A triangle, in model units.
struct Suspect {
    triangle: u32,
    corners: [Vec3; 3],
    /// A triangle of the input that is not far away.
    source: [DVec3; 3],
}

impl Suspect {
    fn center(&self) -> Vec3 {
        let [a, b, c] = self.corners;
        (a + b + c) / 3.0
    }

    /// How far away the input nearly always is at most.
    fn close(&self) -> f32 {
        let [a, b, c] = self.corners;
        let longest = (a.distance(b)).max(b.distance(c)).max(c.distance(a));
        self.far().min(CLOSE * longest)
    }

    /// How far away it is at most: the triangle it has come from, which as a sliver may have
    /// all its corners far away.
    fn far(&self) -> f32 {
        let center = self.center();
        let margin = 4.0 * f32::EPSILON * center.length();
        self.source_distance() * (1.0 + 1e-5) + margin
    }

    fn source_distance(&self) -> f32 {
        let center = self.center().as_dvec3();
        center.distance(closest_point(center, self.source)) as f32
    }

    /// Whether the input is known to be within `reach` and faces as the suspect does all
    /// around, so that the nearest does, too. Where very many triangles meet in a point, that
    /// is told sooner than which of them is nearest.
    fn clearly_agrees(&self, index: &Bvh, facings: &Facings, reach: f32) -> bool {
        let distance = self.source_distance();
        let [a, b, c] = self.corners;
        let normal = (b - a).cross(c - a).normalize_or_zero();
        distance <= reach
            && normal != Vec3::ZERO
            && facings.agree(index, self.center(), distance, Normals::NONE.with(normal))
    }

    /// Whether it opposes the triangle nearest to its centre, and how far away
    /// that is.
    fn stands_to(&self, index: &Bvh) -> (bool, f64) {
        let [a, b, c] = self.corners.map(|p| p.as_dvec3());
        let hit = index.closest((a + b + c) / 3.0);
        let theirs = normal_times_two_areas(index.corners(hit.slot));
        let opposed = normal_times_two_areas([a, b, c]).dot(theirs) < 0.0;
        (opposed, hit.distance_squared.sqrt())
    }
}

fn suspects(level: &Level) -> Vec<u32> {
    let is_suspect = |&t: &u32| {
        let points = level.triangle[t as usize];
        let normal = normal(points.map(|p| level.place(p))).normalize_or_zero();
        points.iter().any(|&p| {
            let facing = level.facing[p as usize];
            facing.truncate().dot(normal) < SUSPECT * facing.w
        })
    };
    // The input itself stands for nothing else.
    let count = match level.facing.is_empty() {
        true => 0,
        false => level.triangle.len() as u32,
    };
    (0..count).into_par_iter().filter(is_suspect).collect()
}

/// Boxes, as marks on the cells of a grid.
struct Grid {
    marks: Vec<u64>,
    /// Cells an axis.
    cells: u32,
    origin: Vec3,
    /// Cells in a model unit, by axis.
    scale: Vec3,
}

impl Grid {
    fn over(mesh: &TriMesh) -> Self {
        let bounds = mesh.bounds();
        let cells = (mesh.triangles.len() as f32).sqrt() / WIDE;
        let cells = (cells as u32).clamp(4, CELLS);
        let scale = cells as f32 / bounds.size();
        Self {
            marks: vec![0; cells.pow(3).div_ceil(u64::BITS) as usize],
            cells,
            origin: bounds.min,
            // A side without length has one cell.
            scale: Vec3::select(scale.is_finite_mask(), scale, Vec3::ZERO),
        }
    }

    #[inline(always)]
    fn cell(&self, place: Vec3) -> UVec3 {
        let cell = (place - self.origin) * self.scale;
        cell.clamp(Vec3::ZERO, Vec3::splat((self.cells - 1) as f32))
            .as_uvec3()
    }

    /// Marks the box around a sphere and the cells beside it.
    fn mark(&mut self, center: Vec3, reach: f32) {
        let first = self.cell(center - reach).saturating_sub(UVec3::ONE);
        let last = (self.cell(center + reach) + 1).min(UVec3::splat(self.cells - 1));
        for at in self.between(first, last) {
            self.marks[at / 64] |= 1 << (at % 64);
        }
    }

    /// Whether a triangle may touch one of the boxes.
    #[inline]
    fn may_touch(&self, [a, b, c]: [Vec3; 3]) -> bool {
        let (min, max) = (a.min(b).min(c), a.max(b).max(c));
        let first = self.cell(min);
        // What is smaller than a cell is at most in the next.
        if ((max - min) * self.scale).max_element() < 1.0 {
            let UVec3 { x, y, z } = first;
            return self.is_marked(((z * self.cells + y) * self.cells + x) as usize);
        }
        let last = self.cell(max);
        (last - first + 1).element_product() > MANY
            || self.between(first, last).any(|at| self.is_marked(at))
    }

    fn is_marked(&self, at: usize) -> bool {
        self.marks[at / 64] >> (at % 64) & 1 != 0
    }

    /// Numbers of the cells between two.
    fn between(&self, first: UVec3, last: UVec3) -> impl Iterator<Item = usize> + use<> {
        let cells = self.cells;
        (first.z..=last.z).flat_map(move |z| {
            (first.y..=last.y).flat_map(move |y| {
                let row = (z * cells + y) * cells;
                (first.x..=last.x).map(move |x| (row + x) as usize)
            })
        })
    }

    /// The triangles that may touch one of the boxes.
    fn marked_of(&self, mesh: &TriMesh) -> TriMesh {
        let corners = |t: &[u32; 3]| t.map(|v| mesh.positions[v as usize]);
        let all = mesh.triangles.par_iter().map(corners);
        let marked: Vec<[Vec3; 3]> = all.filter(|&t| self.may_touch(t)).collect();
        let count = marked.len() as u32;
        let triangles = (0..count).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        TriMesh::new(marked.into_flattened(), triangles)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;
    use glam::Vec4;

    /// A level that is the mesh, each of its points standing for itself.
    fn level(mesh: &TriMesh) -> Level<'_> {
        let mut facing = vec![Vec4::ZERO; mesh.positions.len()];
        for &triangle in &mesh.triangles {
            let cross = normal(triangle.map(|v| mesh.positions[v as usize]));
            for v in triangle {
                facing[v as usize] += cross.extend(cross.length());
            }
        }
        Level {
            position: mesh.positions.as_slice().into(),
            triangle: mesh.triangles.as_slice().into(),
            scale: 1.0,
            facing,
            ..Level::default()
        }
    }

    #[test]
    fn triangles_turned_over_are_found_and_no_others() {
        for mesh in [shapes::terrain(40, 40, 3), shapes::torus(1.0, 0.4, 48, 24)] {
            let mut level = level(&mesh);
            assert!(suspects_against(&level, &mesh, 1.0).unwrap().is_empty());
            let turned = [5, 700, 701, 1900];
            for &t in &turned {
                level.triangle.to_mut()[t as usize].swap(1, 2);
            }
            assert_eq!(suspects_against(&level, &mesh, 1.0).unwrap(), turned);
        }
    }

    #[test]
    fn what_is_far_from_the_input_is_found_too() {
        let mesh = shapes::terrain(40, 40, 3);
        let mut level = level(&mesh);
        level.triangle.to_mut()[9].swap(0, 1);
        let lift = 0.3 * mesh.bounds().size().x * Vec3::Y;
        for v in mesh.triangles[9] {
            level.position.to_mut()[v as usize] += lift;
        }
        let found = suspects_against(&level, &mesh, 1.0).unwrap();
        let index = Bvh::build(&mesh).unwrap();
        let all = (0..mesh.triangles.len() as u32).filter(|&t| {
            let corners = level.triangle[t as usize].map(|p| level.place(p));
            let suspect = Suspect {
                triangle: t,
                corners,
                source: [DVec3::ZERO; 3],
            };
            suspect.stands_to(&index).0
        });
        assert_eq!(found, all.collect::<Vec<_>>());
        assert!(found.contains(&9), "{found:?}");
    }
}
