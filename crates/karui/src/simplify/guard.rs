//! Looks back at the input's surface: how far a changed triangle has come,
//! and whether it shows its back where the input shows its front.

use super::candidate::{Candidate, Refusal};
use super::state::State;
use crate::error::Result;
use crate::geom::normal_times_two_areas;
use crate::mesh::TriMesh;
use crate::spatial::{Bvh, Hit};
use glam::DVec3;

/// The input and an index over it.
pub(crate) struct Guard<'a> {
    mesh: &'a TriMesh,
    index: Bvh,
}

impl<'a> Guard<'a> {
    /// Indexes the input.
    ///
    /// # Errors
    /// As [`Bvh::build`].
    pub fn new(mesh: &'a TriMesh) -> Result<Self> {
        Ok(Self {
            mesh,
            index: Bvh::build(mesh)?,
        })
    }

    /// The index over the input.
    pub fn index(&self) -> &Bvh {
        &self.index
    }

    /// Largest distance of the new vertex and the centroids of the changed
    /// triangles to the input, model units.
    pub fn check(&self, state: &State<'_>, c: &Candidate) -> Result<f64, Refusal> {
        let at_vertex = self.index.closest(c.place);
        let mut farthest = at_vertex.distance_squared;
        for (before, after) in state.places_changed(c) {
            let hit = self.index.closest_near(centroid(after), &at_vertex);
            farthest = farthest.max(hit.distance_squared);
            if self.opposes(after, &hit) && !self.opposed(before) {
                return Err(Refusal::Flips);
            }
        }
        Ok(farthest.sqrt())
    }

    fn opposed(&self, before: [DVec3; 3]) -> bool {
        self.opposes(before, &self.index.closest(centroid(before)))
    }

    fn opposes(&self, corners: [DVec3; 3], hit: &Hit) -> bool {
        let there = normal_times_two_areas(self.mesh.corners(hit.triangle as usize));
        normal_times_two_areas(corners).dot(there) < 0.0
    }
}

fn centroid([a, b, c]: [DVec3; 3]) -> DVec3 {
    (a + b + c) / 3.0
}
