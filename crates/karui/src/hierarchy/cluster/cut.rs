//! A cut: the clusters that a view draws.
//!
//! From the roots down: where a group is not good enough, its clusters are
//! looked at. The time is that of what the cut lies above, not of the whole
//! graph.

use super::bounds::Bounds;
use super::view::{Judge, View};
use super::{Cluster, ClusterDag};
use crate::error::{Error, Result};
use crate::mesh::TriMesh;
use rayon::prelude::*;
use smallvec::SmallVec;

/// Clusters that together are the surface, each part of it once.
#[derive(Debug, Clone)]
pub struct Cut<'a> {
    dag: &'a ClusterDag,
    clusters: Vec<u32>,
    triangles: usize,
}

/// What is known of a group in one cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    /// Nothing yet.
    New,
    /// Its coarse clusters are drawn.
    Enough,
    /// It is not seen, nor anything below.
    Outside,
    /// Its own clusters are looked at.
    Open,
}

impl ClusterDag {
    /// The clusters of this view: each whose own group is good enough and whose
    /// parent group is not. Where nothing is culled, every edge of the surface
    /// has the triangles on both sides that it has in the mesh: no cracks.
    ///
    /// An error counts by its distance from the sphere of its group, whatever
    /// its direction: towards the corners of a wide picture it is somewhat
    /// larger on the screen. Culled groups are not looked into.
    ///
    /// # Errors
    /// [`Error::BadOption`] for a view that is not one: numbers that are not
    /// finite, an eye at its target.
    ///
    /// # Examples
    /// ```
    /// use karui::geom::{Camera, Vec3};
    /// use karui::hierarchy::cluster::{ClusterDag, ClusterDagOptions, View};
    /// use karui::mesh::shapes;
    ///
    /// let sphere = shapes::icosphere(5);
    /// let dag = ClusterDag::build(&sphere, &ClusterDagOptions::default())?;
    /// let mut camera = Camera::looking_at(sphere.bounds(), Vec3::Z, 0.8);
    /// let near = dag.cut(&View::new(camera))?;
    /// camera.eye *= 100.0;
    /// let far = dag.cut(&View::new(camera))?;
    /// assert!(far.triangle_count() * 20 < near.triangle_count());
    /// # Ok::<(), karui::Error>(())
    /// ```
    pub fn cut(&self, view: &View<'_>) -> Result<Cut<'_>> {
        let judge = Judge::new(view)?;
        let cut = self.cut_where(|b| judge.is_enough(b), |b| judge.is_outside(&b.sphere));
        if !view.frustum && !view.backfaces {
            return Ok(cut);
        }
        let is_seen = |c: &u32| {
            let Cluster { sphere, cone, .. } = &self.clusters[*c as usize];
            !judge.is_outside(sphere) && !judge.is_turned_away(sphere, cone)
        };
        let seen = cut.clusters.iter().copied().filter(is_seen);
        Ok(Cut::of(self, seen.collect()))
    }

    /// The coarsest clusters whose error is at most `error`, model units. With
    /// 0 that is the mesh, but for what can go without any error.
    #[must_use]
    pub fn cut_at(&self, error: f32) -> Cut<'_> {
        self.cut_where(|bounds| bounds.error <= error, |_| false)
    }

    /// The coarsest cut of at most so many triangles whose error is the same
    /// everywhere; the coarsest of all if that has more.
    #[must_use]
    pub fn cut_to(&self, triangles: usize) -> Cut<'_> {
        let mut errors: Vec<f32> = self.groups.iter().map(|g| g.bounds.error).collect();
        errors.push(0.0);
        errors.sort_unstable_by(f32::total_cmp);
        errors.dedup();
        let too_many = |error: &f32| self.cut_at(*error).triangles > triangles;
        let at = errors.partition_point(too_many).min(errors.len() - 1);
        self.cut_at(errors[at])
    }

    fn cut_where(
        &self,
        is_enough: impl Fn(&Bounds) -> bool,
        is_outside: impl Fn(&Bounds) -> bool,
    ) -> Cut<'_> {
        let mut walk = Walk {
            dag: self,
            state: vec![State::New; self.groups.len()],
            open: Vec::new(),
            drawn: vec![0; self.clusters.len().div_ceil(64)],
        };
        let judge = |bounds: &Bounds| {
            if is_outside(bounds) {
                State::Outside
            } else if is_enough(bounds) {
                State::Enough
            } else {
                State::Open
            }
        };
        walk.look(&self.roots, &judge);
        while let Some(group) = walk.open.pop() {
            walk.look(self.members(group), &judge);
        }
        Cut::of(self, walk.into_clusters())
    }
}

struct Walk<'a> {
    dag: &'a ClusterDag,
    state: Vec<State>,
    open: Vec<u32>,
    /// A bit a cluster.
    drawn: Vec<u64>,
}

impl Walk<'_> {
    fn look(&mut self, clusters: &[u32], judge: &impl Fn(&Bounds) -> State) {
        for &c in clusters {
            let state = match self.dag.clusters[c as usize].own {
                None => State::Enough,
                Some(group) => self.state_of(group, judge),
            };
            if state == State::Enough {
                self.drawn[c as usize / 64] |= 1 << (c % 64);
            }
        }
    }

    fn state_of(&mut self, group: u32, judge: &impl Fn(&Bounds) -> State) -> State {
        let state = &mut self.state[group as usize];
        if *state == State::New {
            *state = judge(&self.dag.groups[group as usize].bounds);
            if *state == State::Open {
                self.open.push(group);
            }
        }
        *state
    }

    fn into_clusters(self) -> Vec<u32> {
        let mut clusters = Vec::new();
        for (word, first) in self.drawn.iter().zip((0..).step_by(64)) {
            let mut rest = *word;
            while rest != 0 {
                clusters.push(first + rest.trailing_zeros());
                rest &= rest - 1;
            }
        }
        clusters
    }
}

impl<'a> Cut<'a> {
    fn of(dag: &'a ClusterDag, clusters: Vec<u32>) -> Self {
        let count = |&c: &u32| usize::from(dag.clusters[c as usize].triangles);
        Self {
            triangles: clusters.iter().map(count).sum(),
            dag,
            clusters,
        }
    }

    /// The clusters, ascending.
    #[must_use]
    pub fn clusters(&self) -> &[u32] {
        &self.clusters
    }

    /// Number of triangles.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.triangles
    }

    /// The triangles, an index buffer over the vertices of the mesh that the
    /// graph was built of; cluster by cluster.
    #[must_use]
    pub fn triangles(&self) -> Vec<[u32; 3]> {
        let mut triangles = Vec::with_capacity(self.triangles);
        // As many as a byte can name: no lookup needs to be checked.
        let mut table = [0; 256];
        for &c in &self.clusters {
            let vertices = self.dag.vertices_of(c);
            table[..vertices.len()].copy_from_slice(vertices);
            let corners = self.dag.corners_of(c).iter();
            triangles.extend(corners.map(|t| t.map(|v| table[usize::from(v)])));
        }
        triangles
    }

    /// Largest error of the clusters, model units: an upper estimate of the
    /// distance to the mesh where nothing is culled.
    #[must_use]
    pub fn error(&self) -> f32 {
        let errors = self.clusters.iter().map(|&c| self.dag.own(c).error);
        errors.fold(0.0, f32::max)
    }

    /// The cut as a mesh of its own, with the vertices that it uses and their
    /// attributes, triangles sorted by material range. `mesh` is the one that
    /// the graph was built of. Face attributes are left out.
    ///
    /// # Errors
    /// [`Error::OtherMesh`] if it is another.
    pub fn to_mesh(&self, mesh: &TriMesh) -> Result<TriMesh> {
        self.dag.check_input(mesh)?;
        let dag = self.dag;
        let mut by_range = self.clusters.clone();
        let range = |c: &u32| dag.clusters[*c as usize].range;
        by_range.sort_by_key(range);
        let used = by_range.iter().flat_map(|&c| dag.vertices_of(c));
        let mut vertices: Vec<u32> = used.copied().collect();
        vertices.par_sort_unstable();
        vertices.dedup();
        let number = |v: u32| vertices.partition_point(|&known| known < v) as u32;
        let mut cut = TriMesh {
            positions: vertices
                .iter()
                .map(|&v| mesh.positions[v as usize])
                .collect(),
            attributes: mesh.attributes.gathered(&vertices),
            ranges: mesh.ranges.clone(),
            ..TriMesh::default()
        };
        cut.ranges.iter_mut().for_each(|r| r.count = 0);
        for c in by_range {
            let own: SmallVec<[u32; 128]> = dag.vertices_of(c).iter().map(|&v| number(v)).collect();
            let corners = dag.corners_of(c).iter();
            cut.triangles
                .extend(corners.map(|t| t.map(|v| own[usize::from(v)])));
            if let Some(range) = cut.ranges.get_mut(range(&c) as usize) {
                range.count += u32::from(dag.clusters[c as usize].triangles);
            }
        }
        let mut first = 0;
        for range in &mut cut.ranges {
            range.first = first;
            first += range.count;
        }
        Ok(cut)
    }
}

impl ClusterDag {
    /// # Errors
    /// [`Error::OtherMesh`] for other counts than those of the mesh it was
    /// built of.
    pub(super) fn check_input(&self, mesh: &TriMesh) -> Result<()> {
        let checks = [
            (
                "number of vertices",
                mesh.positions.len(),
                self.input.vertices,
            ),
            (
                "number of triangles",
                mesh.triangles.len(),
                self.input.triangles,
            ),
            (
                "number of ranges",
                mesh.ranges.len().max(1),
                self.input.ranges,
            ),
        ];
        match checks
            .iter()
            .find(|(_, found, known)| *found != *known as usize)
        {
            Some(&(what, ..)) => Err(Error::OtherMesh { what }),
            None => Ok(()),
        }
    }
}
