//! Level by level from the mesh to the root.

use super::bounds::{Bounds, Cone, Sphere, grown};
use super::groups::groups;
use super::options::ClusterDagOptions;
use super::patch::{Loss, coarsen};
use super::source::Source;
use super::split::{Limits, Surface, split};
use super::{Cluster, ClusterDag, Group, Input};
use crate::error::{Error, Result};
use crate::mesh::TriMesh;
use crate::progress::step;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// No group has the position yet.
const NOBODY: u32 = u32::MAX;
/// Several groups have it.
const SEVERAL: u32 = u32::MAX - 1;
/// Groups between two looks at the progress.
const TASK: usize = 256;
/// Most clusters of a group when smaller ones are stuck.
const LARGEST: usize = 128;

/// As [`ClusterDag::build`].
pub(super) fn build(mesh: &TriMesh, options: &ClusterDagOptions<'_>) -> Result<ClusterDag> {
    options.check()?;
    let source = Source::of(mesh)?;
    let mut builder = Builder::new(&source, options)?;
    builder.first_level()?;
    while builder.next_level()? {}
    Ok(builder.into_dag())
}

struct Builder<'a> {
    source: &'a Source<'a>,
    options: &'a ClusterDagOptions<'a>,
    limits: Limits,
    /// Most clusters of a group.
    most: usize,
    /// Which parts may go.
    loss: Loss,
    dag: ClusterDag,
    /// Clusters that no group has yet.
    pending: Vec<u32>,
    /// Group of the pending clusters at every position.
    owner: Vec<u32>,
}

/// A cluster before it has its place among all.
struct Draft {
    vertices: Vec<u32>,
    corners: Vec<[u8; 3]>,
    range: u32,
    sphere: Sphere,
    cone: Cone,
}

/// What a group has become.
struct Made {
    bounds: Bounds,
    drafts: Vec<Draft>,
}

impl<'a> Builder<'a> {
    fn new(source: &'a Source<'a>, options: &'a ClusterDagOptions<'a>) -> Result<Self> {
        let mesh = source.mesh;
        // Triangles of all levels are counted in 32 bits.
        let limit = u32::MAX as usize / 3;
        if mesh.triangles.len() > limit {
            return Err(Error::TooLarge {
                what: "triangles",
                found: mesh.triangles.len(),
                limit,
            });
        }
        let input = Input {
            vertices: mesh.positions.len() as u32,
            triangles: mesh.triangles.len() as u32,
            ranges: mesh.ranges.len().max(1) as u32,
        };
        Ok(Self {
            source,
            options,
            limits: Limits {
                triangles: options.max_triangles,
                vertices: options.max_vertices,
            },
            most: options.group_size,
            loss: Loss::LITTLE,
            dag: ClusterDag::empty(input),
            pending: Vec::new(),
            owner: vec![NOBODY; source.ids.count],
        })
    }

    fn first_level(&mut self) -> Result<()> {
        step(self.options.progress, "clusters", 0.0)?;
        let mesh = self.source.mesh;
        let ranges = mesh.ranges_or_whole();
        let parts = ranges.iter().zip(0..);
        let part = |(range, i): (&crate::mesh::MaterialRange, u32)| {
            self.drafts(i, &mesh.triangles[range.triangles()])
        };
        let drafts: Vec<Vec<Draft>> = parts.map(part).collect();
        for draft in drafts.into_iter().flatten() {
            let id = self.dag.push(draft, None, 0);
            self.pending.push(id);
        }
        step(self.options.progress, "clusters", 1.0)
    }

    /// Splits triangles of one material range.
    fn drafts(&self, range: u32, triangles: &[[u32; 3]]) -> Vec<Draft> {
        let source = self.source;
        let all = triangles.par_iter().with_min_len(4096);
        let linked: Vec<[u32; 3]> = all.clone().map(|&t| source.linked(t)).collect();
        let middle = |t: &[u32; 3]| t.map(|v| source.place(v) / 3.0).into_iter().sum::<Vec3>();
        let middles: Vec<Vec3> = all.map(middle).collect();
        let surface = Surface {
            triangles,
            linked: &linked,
            middles: &middles,
        };
        let chosen = (0..triangles.len() as u32).collect();
        let clusters = split(&surface, chosen, self.limits);
        let draft = |own: &Vec<u32>| {
            let own: Vec<[u32; 3]> = own.iter().map(|&t| triangles[t as usize]).collect();
            Draft::of(source, range, &own)
        };
        clusters.par_iter().with_min_len(32).map(draft).collect()
    }

    /// Groups, simplifies and splits what is pending; whether something came
    /// of it.
    fn next_level(&mut self) -> Result<bool> {
        if self.pending.len() < 2 {
            return Ok(false);
        }
        let groups = self.groups();
        self.own(&groups);
        let mut pending = Vec::new();
        let mut progressed = false;
        let total = groups.len().max(1) as f32;
        for (i, task) in groups.chunks(TASK).enumerate() {
            let share = (i * TASK) as f32 / total;
            step(self.options.progress, "levels", share)?;
            let made: Vec<Option<Made>> = task
                .par_iter()
                .map(|group| self.made(group))
                .collect::<Result<_>>()?;
            for (group, made) in task.iter().zip(made) {
                progressed |= made.is_some();
                match made {
                    Some(made) => pending.extend(self.dag.push_group(group, made)),
                    None => {
                        self.dag.stuck += 1;
                        pending.extend(group);
                    }
                }
            }
        }
        self.disown();
        pending.sort_unstable();
        self.pending = pending;
        Ok(progressed || self.insist())
    }

    /// Other means for what is stuck, one after another; whether there are any.
    fn insist(&mut self) -> bool {
        if self.most < LARGEST {
            self.most = LARGEST;
        } else if self.loss.is_little() {
            self.loss = Loss::MUCH;
        } else {
            return false;
        }
        true
    }

    fn groups(&self) -> Vec<Vec<u32>> {
        let pending = self.pending.par_iter();
        let linked = |&c: &u32| {
            let triangles = self.dag.triangles_of(c);
            triangles.map(|t| self.source.linked(t)).collect()
        };
        let triangles: Vec<Vec<[u32; 3]>> = pending.map(linked).collect();
        let middle = |&c: &u32| self.dag.clusters[c as usize].sphere.center;
        let middles: Vec<Vec3> = self.pending.iter().map(middle).collect();
        let mut groups = groups(&triangles, &middles, self.most);
        for c in groups.iter_mut().flatten() {
            *c = self.pending[*c as usize];
        }
        groups
    }

    /// Notes which positions are in one group and which in several.
    fn own(&mut self, groups: &[Vec<u32>]) {
        for (group, clusters) in (0..).zip(groups) {
            for &v in clusters.iter().flat_map(|&c| self.dag.vertices_of(c)) {
                let owner = &mut self.owner[self.source.ids.of_vertex[v as usize] as usize];
                *owner = match *owner {
                    NOBODY => group,
                    known if known == group => group,
                    _ => SEVERAL,
                };
            }
        }
    }

    fn disown(&mut self) {
        for &v in self.pending.iter().flat_map(|&c| self.dag.vertices_of(c)) {
            self.owner[self.source.ids.of_vertex[v as usize] as usize] = NOBODY;
        }
    }

    /// Simplifies one group; none if it is stuck.
    fn made(&self, group: &[u32]) -> Result<Option<Made>> {
        let range = |c: u32| self.dag.clusters[c as usize].range;
        let mut ranged: Vec<(u32, u32)> = group.iter().map(|&c| (range(c), c)).collect();
        ranged.sort_unstable();
        let is_shared = |p: u32| self.owner[p as usize] == SEVERAL;
        let (source, dag) = (self.source, &self.dag);
        let coarse = coarsen(source, dag, &ranged, is_shared, self.options, self.loss)?;
        let Some(coarse) = coarse else {
            return Ok(None);
        };
        let bounds: Vec<Bounds> = group.iter().map(|&c| self.dag.own(c)).collect();
        let error = bounds
            .iter()
            .map(|b| f64::from(b.error))
            .fold(0.0, f64::max);
        let drafts = coarse.parts.iter().flat_map(|(range, triangles)| {
            let shaded: Vec<_> = triangles.iter().map(|&t| self.source.shaded(t)).collect();
            self.drafts(*range, &shaded)
        });
        Ok(Some(Made {
            bounds: Bounds {
                error: grown(error + coarse.deviation),
                sphere: Sphere::joined(&bounds.iter().map(|b| b.sphere).collect::<Vec<_>>()),
                cone: Cone::joined(&bounds.iter().map(|b| b.cone).collect::<Vec<_>>()),
            },
            drafts: drafts.collect(),
        }))
    }

    fn into_dag(self) -> ClusterDag {
        let mut dag = self.dag;
        let is_root = |c: &u32| dag.clusters[*c as usize].parent.is_none();
        dag.roots = dag.ids().filter(is_root).collect();
        dag
    }
}

impl Draft {
    fn of(source: &Source<'_>, range: u32, triangles: &[[u32; 3]]) -> Self {
        let mut vertices: Vec<u32> = triangles.iter().flatten().copied().collect();
        vertices.sort_unstable();
        vertices.dedup();
        let number = |v: u32| vertices.partition_point(|&known| known < v) as u8;
        let normals: Vec<DVec3> = triangles.iter().map(|&t| source.normal(t)).collect();
        Self {
            corners: triangles.iter().map(|t| t.map(number)).collect(),
            sphere: Sphere::around(vertices.iter().map(|&v| source.place(v))),
            cone: Cone::around(normals.iter().copied()),
            vertices,
            range,
        }
    }
}

impl ClusterDag {
    pub(super) fn empty(input: Input) -> Self {
        Self {
            clusters: Vec::new(),
            groups: Vec::new(),
            members: Vec::new(),
            vertices: Vec::new(),
            corners: Vec::new(),
            roots: Vec::new(),
            input,
            stuck: 0,
        }
    }

    fn push(&mut self, draft: Draft, own: Option<u32>, level: u16) -> u32 {
        let cluster = Cluster {
            first_vertex: self.vertices.len() as u32,
            first_triangle: self.corners.len() as u32,
            vertices: draft.vertices.len() as u8,
            triangles: draft.corners.len() as u8,
            level,
            range: draft.range,
            own,
            parent: None,
            sphere: draft.sphere,
            cone: draft.cone,
        };
        self.vertices.extend(draft.vertices);
        self.corners.extend(draft.corners);
        self.clusters.push(cluster);
        self.clusters.len() as u32 - 1
    }

    /// Adds a group of these clusters and what has become of it.
    fn push_group(&mut self, clusters: &[u32], made: Made) -> Vec<u32> {
        let id = self.groups.len() as u32;
        let levels = clusters.iter().map(|&c| self.clusters[c as usize].level);
        let level = levels.max().unwrap_or(0);
        self.groups.push(Group {
            bounds: made.bounds,
            first: self.members.len() as u32,
            count: clusters.len() as u32,
            level,
        });
        self.members.extend(clusters);
        for &c in clusters {
            self.clusters[c as usize].parent = Some(id);
        }
        let push = |draft| self.push(draft, Some(id), level.saturating_add(1));
        made.drafts.into_iter().map(push).collect()
    }
}
