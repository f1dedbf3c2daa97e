//! How far a stand-in is from what it stands for.

use super::group::Group;
use crate::error::Result;
use crate::geom::{DVec3, Vec3};
use crate::mesh::TriMesh;
use crate::spatial::Bvh;
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
    let used = used(from);
    // Some corners tell how far others have to be to matter.
    let few = used.len().div_ceil(CHUNK).max(1);
    let some: Vec<Vec3> = used.iter().step_by(few).copied().collect();
    let some = farthest_corner(&some, to, 0.0);
    let corners = farthest_corner(&used, to, some);
    let chunks = from.triangles.len().div_ceil(CHUNK);
    let of_chunk = |chunk: usize| {
        let mut probe = Probe::new(to, corners);
        let first = chunk * CHUNK;
        for t in first..from.triangles.len().min(first + CHUNK) {
            probe.search(from.corners(t), finest);
        }
        probe.farthest
    };
    let chunks = (0..chunks).into_par_iter().map(of_chunk);
    chunks.reduce(|| corners, f64::max)
}

/// Corners of all triangles, each once.
fn used(mesh: &TriMesh) -> Vec<Vec3> {
    let mut used = vec![false; mesh.positions.len()];
    let corners = mesh.triangles.iter().flatten();
    corners.for_each(|&v| used[v as usize] = true);
    let used = mesh.positions.iter().zip(used);
    used.filter_map(|(p, used)| used.then_some(*p)).collect()
}

/// `least` if none is farther.
fn farthest_corner(corners: &[Vec3], to: &Bvh, least: f64) -> f64 {
    let of_chunk = |corners: &[Vec3]| {
        let mut probe = Probe::new(to, least);
        for p in corners {
            probe.is_beyond(p.as_dvec3(), 0.0);
        }
        probe.farthest
    };
    let chunks = corners.par_chunks(CHUNK).map(of_chunk);
    chunks.reduce(|| least, f64::max)
}

struct Probe<'a> {
    to: &'a Bvh,
    near: u32,
    /// Largest distance so far.
    farthest: f64,
    /// Pieces still to be looked into.
    pieces: Vec<[DVec3; 3]>,
}

impl<'a> Probe<'a> {
    fn new(to: &'a Bvh, farthest: f64) -> Self {
        Self {
            to,
            near: 0,
            farthest,
            pieces: Vec::new(),
        }
    }

    /// Whether something no farther than `reach` from here may be farther away than
    /// is known.
    fn is_beyond(&mut self, p: DVec3, reach: f64) -> bool {
        let enough = (self.farthest - reach).max(0.0);
        let hit = self.to.closest_or_within(p, self.near, enough * enough);
        self.near = hit.slot;
        let distance = hit.distance_squared.sqrt();
        self.farthest = self.farthest.max(distance);
        distance + reach > self.farthest
    }

    fn search(&mut self, triangle: [DVec3; 3], finest: f64) {
        self.pieces.push(triangle);
        while let Some([a, b, c]) = self.pieces.pop() {
            let middle = (a + b + c) / 3.0;
            let reach = [a, b, c].map(|p| p.distance(middle));
            let reach = reach[0].max(reach[1]).max(reach[2]);
            if reach > finest && self.is_beyond(middle, reach) {
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
