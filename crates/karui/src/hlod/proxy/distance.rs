//! How far a stand-in is from what it stands for.

use super::group::Group;
use crate::error::Result;
use crate::geom::{DVec3, Vec3};
use crate::mesh::TriMesh;
use crate::spatial::{Bvh, Hit};
use rayon::prelude::*;

/// Pieces of a triangle that reach no farther from their middle than this share of
/// the group's diagonal are not looked into.
const FINEST: f64 = 1.0 / 128.0;
/// Vertices or triangles a task takes, in a row so that one hit helps to find the next.
const CHUNK: usize = 1024;

/// Largest distance found between the members and a stand-in, both ways, model
/// units. From a piece of a triangle nothing is farther than from its middle by more
/// than it reaches from there: pieces that could hold something farther than is known
/// are cut in four, down to 1/128 of the group's diagonal, which is how much may be
/// missed. Both have triangles.
pub(super) fn distance(group: &Group<'_>, proxy: &TriMesh) -> Result<f64> {
    let finest = group.bounds().diagonal() * FINEST;
    let there = farthest(&group.mesh, &Bvh::build_quick(proxy)?, finest);
    let back = farthest(proxy, group.tree()?, finest);
    Ok(there.max(back))
}

fn farthest(from: &TriMesh, to: &Bvh, finest: f64) -> f64 {
    let corners = farthest_corner(from, to);
    let chunks = from.triangles.len().div_ceil(CHUNK);
    let of_chunk = |chunk: usize| {
        let mut probe = Probe {
            farthest: corners,
            ..Probe::new(to)
        };
        let first = chunk * CHUNK;
        for t in first..from.triangles.len().min(first + CHUNK) {
            probe.search(from.corners(t), finest);
        }
        probe.farthest
    };
    let chunks = (0..chunks).into_par_iter().map(of_chunk);
    chunks.reduce(|| corners, f64::max)
}

fn farthest_corner(from: &TriMesh, to: &Bvh) -> f64 {
    let mut used = vec![false; from.positions.len()];
    let corners = from.triangles.iter().flatten();
    corners.for_each(|&v| used[v as usize] = true);
    let chunks = from.positions.par_chunks(CHUNK).zip(used.par_chunks(CHUNK));
    let of_chunk = |(positions, used): (&[Vec3], &[bool])| {
        let mut probe = Probe::new(to);
        for (p, _) in positions.iter().zip(used).filter(|(_, used)| **used) {
            probe.visit(p.as_dvec3());
        }
        probe.farthest
    };
    chunks.map(of_chunk).reduce(|| 0.0, f64::max)
}

struct Probe<'a> {
    to: &'a Bvh,
    near: Option<Hit>,
    /// Largest distance so far.
    farthest: f64,
    /// Pieces still to be looked into.
    pieces: Vec<[DVec3; 3]>,
}

impl<'a> Probe<'a> {
    fn new(to: &'a Bvh) -> Self {
        Self {
            to,
            near: None,
            farthest: 0.0,
            pieces: Vec::new(),
        }
    }

    fn visit(&mut self, p: DVec3) -> f64 {
        let hit = match &self.near {
            Some(near) => self.to.closest_near(p, near),
            None => self.to.closest(p),
        };
        self.near = Some(hit);
        let distance = hit.distance_squared.sqrt();
        self.farthest = self.farthest.max(distance);
        distance
    }

    fn search(&mut self, triangle: [DVec3; 3], finest: f64) {
        self.pieces.push(triangle);
        while let Some([a, b, c]) = self.pieces.pop() {
            let middle = (a + b + c) / 3.0;
            let reach = [a, b, c].map(|p| p.distance(middle));
            let reach = reach[0].max(reach[1]).max(reach[2]);
            if reach > finest && self.visit(middle) + reach > self.farthest {
                let [d, e, f] = [(b + c) * 0.5, (c + a) * 0.5, (a + b) * 0.5];
                self.pieces
                    .extend([[a, f, e], [f, b, d], [e, d, c], [d, e, f]]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;
    use crate::metrics::{SurfaceDistanceOptions, surface_distance};

    #[test]
    fn as_large_as_the_metric_says() {
        for (name, mesh) in shapes::zoo() {
            let proxy = shapes::cube(1);
            if mesh.triangles.is_empty() {
                continue;
            }
            let look = Default::default();
            let member = super::super::Member {
                mesh: &mesh,
                world_from_mesh: crate::geom::DMat4::IDENTITY,
                look: &look,
                objects: super::super::Objects::One(0),
                error: 0.0,
            };
            let group = Group::new(&[member]).unwrap();
            let found = distance(&group, &proxy).unwrap();
            let options = SurfaceDistanceOptions::default();
            let exact = surface_distance(&group.mesh, &proxy, &options)
                .unwrap()
                .max();
            assert!(
                (found - exact).abs() < 0.03 * exact + 1e-9,
                "{name} {found} {exact}"
            );
        }
    }
}
