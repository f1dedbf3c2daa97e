//! Parts that nobody outside can see.

use super::group::Group;
use crate::error::Result;
use crate::geom::{DVec3, fibonacci_directions};
use crate::mesh::{AlphaMode, Components, PositionIds};
use crate::spatial::{Bvh, Ray};
use rayon::prelude::*;

/// Directions looked along; neighbours in the list are far apart.
const DIRECTIONS: u32 = 1024;
/// Rays from every point of a triangle at least.
const RAYS_A_POINT: usize = 4;
/// Rays from a part at least.
const RAYS_A_PART: usize = 2048;
/// Triangles from which on a part sends rays from their middles alone.
const MANY: usize = 2048;
/// How far points lie inside their triangle: a share of the way to its middle.
const INSIDE: f64 = 0.01;
/// What is nearer than this share of the diagonal is not in the way.
const NEAR: f64 = 1e-6;

/// Triangles of connected parts from which no ray gets out of the group.
///
/// Rays start in the middle of every triangle and, unless there are many, near its
/// corners, on both of its sides, at least 2048 a part. Only what is opaque stops them, and what is
/// one-sided only where it would stop the eye. A part that is seen through a hole so
/// small that none of the rays finds it is taken as hidden.
pub(super) fn hidden(group: &Group<'_>) -> Result<Vec<bool>> {
    let mesh = &group.mesh;
    let parts = Components::of(mesh, &PositionIds::of_mesh(mesh))?;
    if parts.count < 2 {
        return Ok(vec![false; mesh.triangles.len()]);
    }
    let eyes = Eyes::new(group)?;
    let (starts, triangles) = parts.groups();
    let is_hidden = |c: usize| {
        let part = &triangles[starts[c] as usize..starts[c + 1] as usize];
        !eyes.see(part)
    };
    let of_part: Vec<bool> = (0..parts.count).into_par_iter().map(is_hidden).collect();
    let of_triangle = parts.of_triangle.iter();
    Ok(of_triangle.map(|&c| of_part[c as usize]).collect())
}

/// How something stops rays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Cover {
    /// Not at all.
    None,
    /// Those that leave through the front.
    Front,
    Both,
}

struct Eyes<'a> {
    group: &'a Group<'a>,
    tree: &'a Bvh,
    /// Of every slot.
    covers: Vec<Cover>,
    slot_of: Vec<u32>,
    directions: Vec<DVec3>,
    least: f64,
}

impl<'a> Eyes<'a> {
    fn new(group: &'a Group<'a>) -> Result<Self> {
        let tree = group.tree()?;
        let covers = group.slots.iter().map(|slot| match slot.material() {
            None => Cover::Both,
            Some(m) if m.alpha_mode != AlphaMode::Opaque => Cover::None,
            Some(m) if m.double_sided => Cover::Both,
            Some(_) => Cover::Front,
        });
        let spread = fibonacci_directions(DIRECTIONS).into_iter();
        let spread: Vec<DVec3> = spread.map(|d| d.as_dvec3().normalize()).collect();
        // 387 has no divisor in common with 1024: every direction has its turn.
        let turn = |i: usize| spread[i * 387 % spread.len()];
        Ok(Self {
            group,
            least: NEAR * tree.bounds().diagonal(),
            tree,
            covers: covers.collect(),
            slot_of: group.mesh.range_of_triangles(),
            directions: (0..spread.len()).map(turn).collect(),
        })
    }

    /// Whether anything of a part is seen from outside.
    fn see(&self, part: &[u32]) -> bool {
        let points = if part.len() < MANY { 4 } else { 1 };
        let rays = RAYS_A_POINT.max(RAYS_A_PART.div_ceil(points * part.len()));
        let mut next = 0;
        part.iter().any(|&t| {
            self.points(t).into_iter().take(points).any(|origin| {
                let first = next;
                next += rays;
                (first..next).any(|i| self.is_free(origin, i))
            })
        })
    }

    fn points(&self, t: u32) -> [DVec3; 4] {
        let [a, b, c] = self.group.mesh.corners(t as usize);
        let middle = (a + b + c) / 3.0;
        let near = |corner: DVec3| corner.lerp(middle, INSIDE);
        [middle, near(a), near(b), near(c)]
    }

    fn is_free(&self, origin: DVec3, i: usize) -> bool {
        let ray = Ray {
            origin,
            direction: self.directions[i % self.directions.len()],
            least: self.least,
        };
        !self.tree.is_blocked(&ray, |t, front| {
            match self.covers[self.slot_of[t as usize] as usize] {
                Cover::None => false,
                Cover::Front => front,
                Cover::Both => true,
            }
        })
    }
}
