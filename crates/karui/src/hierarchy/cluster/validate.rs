//! What must hold in a cluster DAG.

use super::angle::Angle;
use super::split::edge_key;
use super::{Bounds, Cluster, ClusterDag, Group};
use crate::error::{Error, Result};
use crate::mesh::{PositionIds, TriMesh};
use rayon::prelude::*;

fn ensure(holds: bool, rule: &'static str, index: usize) -> Result<()> {
    if holds {
        return Ok(());
    }
    Err(Error::Broken { rule, index })
}

impl ClusterDag {
    /// Checks all that can be checked without the mesh: indices, that clusters
    /// and groups name each other, that what is coarser comes later, and that
    /// errors, spheres and cones grow from the finer to the coarser.
    ///
    /// # Errors
    /// [`Error::Broken`] with the first cluster or group where a rule does not
    /// hold.
    pub fn validate(&self) -> Result<()> {
        let (mut vertex, mut corner, mut first) = (0u64, 0u64, 0u64);
        for (i, c) in self.clusters.iter().enumerate() {
            let starts = (u64::from(c.first_vertex), u64::from(c.first_triangle));
            let follows = starts == (vertex, corner);
            ensure(follows, "clusters follow each other", i)?;
            vertex += u64::from(c.vertices);
            corner += u64::from(c.triangles);
        }
        let there = (self.vertices.len() as u64, self.corners.len() as u64);
        let whole = (vertex, corner) == there;
        ensure(whole, "clusters have all vertices and triangles", 0)?;
        for (i, g) in self.groups.iter().enumerate() {
            ensure(
                u64::from(g.first) == first && g.count > 0,
                "groups follow each other",
                i,
            )?;
            first += u64::from(g.count);
        }
        ensure(
            first as usize == self.members.len(),
            "groups have all members",
            0,
        )?;
        (0..self.clusters.len()).try_for_each(|i| self.check_cluster(i))?;
        (0..self.groups.len()).try_for_each(|i| self.check_group(i))?;
        self.check_roots()
    }

    fn check_cluster(&self, i: usize) -> Result<()> {
        let c = &self.clusters[i];
        ensure(c.triangles > 0, "a cluster has a triangle", i)?;
        ensure(c.range < self.input.ranges, "a range exists", i)?;
        let vertices = self.vertices_of(i as u32);
        let ascend = vertices.windows(2).all(|w| w[0] < w[1]);
        ensure(ascend, "vertices of a cluster ascend", i)?;
        let exist = vertices.last().is_some_and(|&v| v < self.input.vertices);
        ensure(exist, "vertices exist", i)?;
        let named = self.corners_of(i as u32).iter().flatten();
        let inside = named.into_iter().all(|&v| v < c.vertices);
        ensure(inside, "corners are vertices of the cluster", i)?;
        let groups = self.groups.len() as u32;
        let known = |group: Option<u32>| group.is_none_or(|g| g < groups);
        ensure(known(c.own) && known(c.parent), "groups exist", i)?;
        let tight = Bounds {
            error: 0.0,
            sphere: c.sphere,
            cone: c.cone,
        };
        ensure(is_sound(&tight), "bounds are finite, axes of length 1", i)?;
        ensure(
            self.is_at_its_level(c),
            "a cluster is one level above its group",
            i,
        )?;
        let later = c.parent.is_none_or(|p| c.own.is_none_or(|o| o < p));
        ensure(later, "what is coarser comes later", i)?;
        let (own, parent) = (self.own(i as u32), self.parent(i as u32));
        ensure(own.error < parent.error, "errors grow", i)?;
        let nested = c.parent.is_none() || parent.sphere.holds(&own.sphere);
        ensure(nested, "spheres hold what is finer", i)?;
        ensure(opens(&own, &parent), "cones hold what is finer", i)
    }

    fn is_at_its_level(&self, cluster: &Cluster) -> bool {
        let below = cluster
            .own
            .map(|g| self.groups[g as usize].level.saturating_add(1));
        below.unwrap_or(0) == cluster.level
    }

    fn check_group(&self, i: usize) -> Result<()> {
        let Group { bounds, level, .. } = &self.groups[i];
        ensure(is_sound(bounds), "bounds are finite, axes of length 1", i)?;
        let members = self.members(i as u32);
        let ascend = members.windows(2).all(|w| w[0] < w[1]);
        ensure(ascend, "members ascend", i)?;
        let is_own = |&c: &u32| {
            let cluster = self.clusters.get(c as usize);
            cluster.is_some_and(|c| c.parent == Some(i as u32))
        };
        ensure(members.iter().all(is_own), "members name their group", i)?;
        let levels = members.iter().map(|&c| self.clusters[c as usize].level);
        ensure(
            levels.max() == Some(*level),
            "a group has its members' level",
            i,
        )
    }

    fn check_roots(&self) -> Result<()> {
        let is_root = |c: &u32| self.clusters[*c as usize].parent.is_none();
        ensure(
            self.ids().filter(is_root).eq(self.roots.iter().copied()),
            "roots are listed",
            0,
        )?;
        let inner = self.clusters.len() - self.roots.len();
        ensure(
            inner == self.members.len(),
            "a cluster is in its parent alone",
            0,
        )
    }

    /// As [`ClusterDag::validate`], and checks against the mesh that it was
    /// built of: that level 0 is the mesh, that spheres hold their vertices and
    /// that no cut has a crack. For that, what was made of a group must have
    /// the rim that the group has, but for edges between vertices that lie on
    /// the mesh's own border, on edges of more than two triangles or of twice
    /// the same.
    ///
    /// # Errors
    /// [`Error::OtherMesh`], [`Error::Broken`].
    pub fn validate_for(&self, mesh: &TriMesh) -> Result<()> {
        self.check_input(mesh)?;
        mesh.validate()?;
        self.validate()?;
        let inside = |c: u32| {
            let sphere = self.clusters[c as usize].sphere;
            let center = sphere.center.as_dvec3();
            let distance = |&v: &u32| mesh.positions[v as usize].as_dvec3().distance(center);
            let mut distances = self.vertices_of(c).iter().map(distance);
            distances.all(|d| d <= f64::from(sphere.radius))
        };
        let odd = self.ids().into_par_iter().find_first(|&c| !inside(c));
        ensure(
            odd.is_none(),
            "spheres hold their vertices",
            odd.unwrap_or(0) as usize,
        )?;
        self.check_level_0(mesh)?;
        self.check_rims(mesh)
    }

    fn check_level_0(&self, mesh: &TriMesh) -> Result<()> {
        let range_of = mesh.range_of_triangles();
        let own = mesh.triangles.iter().zip(range_of);
        let mut expected: Vec<_> = own.map(|(&t, range)| (range, t)).collect();
        let fine = self.ids().filter(|&c| self.clusters[c as usize].level == 0);
        let mut found: Vec<_> = fine
            .flat_map(|c| {
                let range = self.clusters[c as usize].range;
                self.triangles_of(c).map(move |t| (range, t))
            })
            .collect();
        expected.par_sort_unstable();
        found.par_sort_unstable();
        ensure(expected == found, "level 0 is the mesh", 0)
    }

    fn check_rims(&self, mesh: &TriMesh) -> Result<()> {
        let ids = PositionIds::of_mesh(mesh);
        let loose = loose_ends(&ids.triangles(&mesh.triangles), ids.count);
        let mut made: Vec<Vec<u32>> = vec![Vec::new(); self.groups.len()];
        for c in self.ids() {
            if let Some(own) = self.clusters[c as usize].own {
                made[own as usize].push(c);
            }
        }
        let rim = |clusters: &[u32]| {
            let triangles = clusters.iter().flat_map(|&c| self.triangles_of(c));
            let triangles: Vec<_> = triangles
                .map(|t| t.map(|v| ids.of_vertex[v as usize]))
                .collect();
            let mut rim = rim(&triangles);
            rim.retain(|e| !(loose[(e >> 32) as usize] && loose[*e as u32 as usize]));
            rim
        };
        let differs = |&g: &usize| rim(self.members(g as u32)) != rim(&made[g]);
        let odd = (0..self.groups.len()).into_par_iter().find_first(differs);
        ensure(
            odd.is_none(),
            "what is made of a group has its rim",
            odd.unwrap_or(0),
        )
    }
}

fn is_sound(bounds: &Bounds) -> bool {
    let Bounds {
        error,
        sphere,
        cone,
    } = bounds;
    let sizes = [*error, sphere.radius];
    let good = sizes.iter().all(|s| s.is_finite() && *s >= 0.0);
    let unit = (cone.axis.length() - 1.0).abs() < 1e-3;
    good && unit && sphere.center.is_finite() && (-1.0..=1.0).contains(&cone.cos)
}

/// Whether the parent's cone holds the own one, but for rounding.
fn opens(own: &Bounds, parent: &Bounds) -> bool {
    let reach = Angle::between(own.cone.unit(), parent.cone.unit());
    reach.plus(own.cone.angle()).cos >= f64::from(parent.cone.cos) - 1e-6
}

/// Edges with an odd number of triangles: the border of these triangles, which
/// no turn of a triangle changes, so that surfaces of one side have one as well.
fn rim(triangles: &[[u32; 3]]) -> Vec<u64> {
    let edges = edges(triangles);
    let same = edges.chunk_by(|x, y| x.0 == y.0);
    let odd = same.filter(|same| same.len() % 2 == 1);
    odd.map(|same| same[0].0).collect()
}

/// Edges of triangles that have three different corners, and the third corner,
/// ascending.
fn edges(triangles: &[[u32; 3]]) -> Vec<(u64, u32)> {
    let is_whole = |[a, b, c]: &&[u32; 3]| a != b && b != c && c != a;
    let whole = triangles.iter().filter(is_whole);
    let sides = whole.flat_map(|&[a, b, c]| [(a, b, c), (b, c, a), (c, a, b)]);
    let mut edges: Vec<_> = sides.map(|(a, b, c)| (edge_key(a, b), c)).collect();
    edges.par_sort_unstable();
    edges
}

/// Ends of edges that have not two triangles, or twice the same.
fn loose_ends(triangles: &[[u32; 3]], positions: usize) -> Vec<bool> {
    let edges = edges(triangles);
    let mut loose = vec![false; positions];
    let same = edges.chunk_by(|x, y| x.0 == y.0);
    let odd = same.filter(|same| same.len() != 2 || same[0] == same[1]);
    for edge in odd.map(|same| same[0].0) {
        loose[(edge >> 32) as usize] = true;
        loose[edge as u32 as usize] = true;
    }
    loose
}
