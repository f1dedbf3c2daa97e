//! The graph as bytes, little-endian: `KARUICLD`, the version, vertices,
//! triangles and ranges of the mesh and the failed attempts (`u32` each), then
//!
//! - a list of groups: error, sphere and cone (nine `f32`), the number of
//!   clusters made of it, a list of its members as distances;
//! - a list of clusters, those of level 0 first, then those made of every
//!   group: its material range, sphere and cone (eight `f32`), a list of its
//!   vertices (the first as difference from that of the cluster before, the
//!   others as distances), a list of triangles of three bytes each;
//! - a checksum of all that (`u64`).
//!
//! Lists begin with their length. Lengths, ids and distances are LEB128,
//! differences zigzag before that. What follows from the rest (levels, parents,
//! roots) is not written. About 8 bytes a triangle of the mesh.

use super::{Bounds, Cluster, ClusterDag, Cone, Group, Input, Sphere};
use crate::error::{Error, Result};
use crate::simplify::log::bytes::{put, zigzag};
use glam::Vec3;

const MAGIC: [u8; 8] = *b"KARUICLD";
const VERSION: u32 = 1;

impl ClusterDag {
    /// The graph as bytes, the same on every machine.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = Vec::with_capacity(64 + 4 * self.corners.len());
        out.extend(MAGIC);
        let Input {
            vertices,
            triangles,
            ranges,
        } = self.input;
        for word in [VERSION, vertices, triangles, ranges, self.stuck] {
            out.extend(word.to_le_bytes());
        }
        self.put_groups(&mut out);
        put(&mut out, self.clusters.len() as u64);
        let mut last = 0;
        for (c, cluster) in (0..).zip(&self.clusters) {
            put(&mut out, cluster.range.into());
            put_sphere(&mut out, &cluster.sphere);
            put_cone(&mut out, &cluster.cone);
            last = put_vertices(&mut out, self.vertices_of(c), last);
            put(&mut out, cluster.triangles.into());
            out.extend(self.corners_of(c).iter().flatten());
        }
        let sum = checksum(&out);
        out.extend(sum.to_le_bytes());
        out
    }

    fn put_groups(&self, out: &mut Vec<u8>) {
        let mut made = vec![0u64; self.groups.len()];
        for own in self.clusters.iter().filter_map(|c| c.own) {
            made[own as usize] += 1;
        }
        put(out, self.groups.len() as u64);
        for (g, made) in (0..).zip(made) {
            let Bounds {
                error,
                sphere,
                cone,
            } = &self.groups[g as usize].bounds;
            out.extend(error.to_le_bytes());
            put_sphere(out, sphere);
            put_cone(out, cone);
            put(out, made);
            let members = self.members(g);
            put(out, members.len() as u64);
            put_ascending(out, members, 0);
        }
    }

    /// Reads what [`Self::to_bytes`] has written, and checks that it holds
    /// together. Takes memory as the bytes are read, never on the word of a
    /// length.
    ///
    /// # Errors
    /// [`Error::BadClusters`] with the number of the byte, or of the cluster or
    /// group that breaks a rule.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        let mut bytes = Bytes { bytes, at: 0 };
        bytes.check_frame()?;
        let mut word = || bytes.word();
        let input = Input {
            vertices: word()?,
            triangles: word()?,
            ranges: word()?,
        };
        let stuck = word()?;
        let mut dag = Self::empty(input);
        dag.stuck = stuck;
        let made = bytes.groups(&mut dag)?;
        bytes.clusters(&mut dag)?;
        if bytes.at != bytes.bytes.len() {
            return Err(bytes.bad("there are bytes left over"));
        }
        dag.name_groups(&made)?;
        dag.validate().map_err(|error| match error {
            Error::Broken { rule, index } => Error::BadClusters {
                at: index,
                problem: rule,
            },
            other => other,
        })?;
        Ok(dag)
    }

    /// Gives clusters their own group, their parent and their level.
    fn name_groups(&mut self, made: &[u64]) -> Result<()> {
        const NOT_ALL: Error = Error::BadClusters {
            at: 0,
            problem: "clusters of groups are not those there are",
        };
        let all = made.iter().fold(0, |sum: u64, m| sum.saturating_add(*m));
        let fine = (self.clusters.len() as u64)
            .checked_sub(all)
            .ok_or(NOT_ALL)?;
        let mut next = fine as usize;
        for (g, &made) in made.iter().enumerate() {
            let Group { first, count, .. } = self.groups[g];
            let mut level = 0;
            for &c in &self.members[first as usize..][..count as usize] {
                let cluster = self.clusters.get_mut(c as usize).ok_or(NOT_ALL)?;
                cluster.parent = Some(g as u32);
                level = level.max(cluster.level);
            }
            self.groups[g].level = level;
            for cluster in &mut self.clusters[next..next + made as usize] {
                cluster.own = Some(g as u32);
                cluster.level = level.saturating_add(1);
            }
            next += made as usize;
        }
        let is_root = |c: &u32| self.clusters[*c as usize].parent.is_none();
        self.roots = self.ids().filter(is_root).collect();
        Ok(())
    }
}

/// Of all bytes, eight at a time.
fn checksum(bytes: &[u8]) -> u64 {
    let mix = |sum: u64, word: u64| {
        let mixed = (sum ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        mixed ^ mixed >> 29
    };
    let (words, rest) = bytes.as_chunks::<8>();
    let words = words.iter().map(|w| u64::from_le_bytes(*w));
    let rest = rest.iter().map(|&b| u64::from(b) | 0x100);
    words.chain(rest).fold(bytes.len() as u64, mix)
}

/// Every one as its distance from one more than the one before.
fn put_ascending(out: &mut Vec<u8>, ids: &[u32], mut next: u32) {
    for &id in ids {
        put(out, u64::from(id - next));
        next = id + 1;
    }
}

/// Returns the first vertex, for the next cluster.
fn put_vertices(out: &mut Vec<u8>, vertices: &[u32], last: u32) -> u32 {
    put(out, vertices.len() as u64);
    let Some((&first, rest)) = vertices.split_first() else {
        return last;
    };
    put(out, zigzag(first, last));
    put_ascending(out, rest, first + 1);
    first
}

fn put_sphere(out: &mut Vec<u8>, sphere: &Sphere) {
    let numbers = sphere.center.extend(sphere.radius).to_array();
    out.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
}

fn put_cone(out: &mut Vec<u8>, cone: &Cone) {
    let numbers = cone.axis.extend(cone.cos).to_array();
    out.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
}

/// Bytes being read.
struct Bytes<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Bytes<'_> {
    fn bad(&self, problem: &'static str) -> Error {
        Error::BadClusters {
            at: self.at,
            problem,
        }
    }

    /// Magic, version and checksum, which is cut off.
    fn check_frame(&mut self) -> Result<()> {
        if self.take()? != MAGIC {
            self.at = 0;
            return Err(self.bad("it does not begin with KARUICLD"));
        }
        if self.word()? != VERSION {
            return Err(self.bad("the version is not 1, the only one known"));
        }
        let rest = &self.bytes[self.at..];
        let sum = rest.last_chunk().ok_or(self.bad("it ends too early"))?;
        let body = &self.bytes[..self.bytes.len() - sum.len()];
        if checksum(body) != u64::from_le_bytes(*sum) {
            return Err(self.bad("the checksum is not that of the bytes"));
        }
        self.bytes = body;
        Ok(())
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N]> {
        let rest = &self.bytes[self.at..];
        let taken = rest.first_chunk().ok_or(self.bad("it ends too early"))?;
        self.at += N;
        Ok(*taken)
    }

    fn word(&mut self) -> Result<u32> {
        self.take().map(u32::from_le_bytes)
    }

    fn float(&mut self) -> Result<f32> {
        self.take().map(f32::from_le_bytes)
    }

    fn place(&mut self) -> Result<Vec3> {
        Ok(Vec3::new(self.float()?, self.float()?, self.float()?))
    }

    fn sphere(&mut self) -> Result<Sphere> {
        Ok(Sphere {
            center: self.place()?,
            radius: self.float()?,
        })
    }

    fn cone(&mut self) -> Result<Cone> {
        Ok(Cone {
            axis: self.place()?,
            cos: self.float()?,
        })
    }

    fn number(&mut self) -> Result<u64> {
        let mut number = 0;
        for shift in (0..42).step_by(7) {
            let [byte] = self.take()?;
            number |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Ok(number);
            }
        }
        Err(self.bad("a number has more than 42 bits"))
    }

    /// `start` and the number that follows.
    fn id(&mut self, start: i64) -> Result<u32> {
        let number = start.saturating_add(self.number()? as i64);
        u32::try_from(number).map_err(|_| self.bad("an id is out of range"))
    }

    /// The length of a list whose items take at least so many bytes.
    fn length(&mut self, bytes: usize) -> Result<usize> {
        let count = self.number()?;
        if count > ((self.bytes.len() - self.at) / bytes) as u64 {
            return Err(self.bad("a list is longer than what is left"));
        }
        Ok(count as usize)
    }

    /// Appends ids that ascend from `next` on.
    fn ascending(&mut self, count: usize, mut next: i64, to: &mut Vec<u32>) -> Result<()> {
        for _ in 0..count {
            let id = self.id(next)?;
            to.push(id);
            next = i64::from(id) + 1;
        }
        Ok(())
    }

    /// Returns how many clusters were made of each.
    fn groups(&mut self, dag: &mut ClusterDag) -> Result<Vec<u64>> {
        let mut made = Vec::new();
        for _ in 0..self.length(38)? {
            let bounds = Bounds {
                error: self.float()?,
                sphere: self.sphere()?,
                cone: self.cone()?,
            };
            made.push(self.number()?);
            let count = self.length(1)?;
            dag.groups.push(Group {
                bounds,
                first: dag.members.len() as u32,
                count: count as u32,
                level: 0,
            });
            self.ascending(count, 0, &mut dag.members)?;
        }
        Ok(made)
    }

    fn clusters(&mut self, dag: &mut ClusterDag) -> Result<()> {
        let mut last = 0;
        for _ in 0..self.length(39)? {
            let cluster = self.cluster(dag, last)?;
            last = dag.vertices[cluster.first_vertex as usize];
            dag.clusters.push(cluster);
        }
        Ok(())
    }

    fn cluster(&mut self, dag: &mut ClusterDag, last: u32) -> Result<Cluster> {
        let range = self.id(0)?;
        let (sphere, cone) = (self.sphere()?, self.cone()?);
        let (first_vertex, first_triangle) = (dag.vertices.len(), dag.corners.len());
        let vertices = self.small()?;
        let zigzag = self.number()?;
        let difference = (zigzag >> 1) as i64 ^ -((zigzag & 1) as i64);
        let first = u32::try_from(i64::from(last) + difference);
        let first = first.map_err(|_| self.bad("an id is out of range"))?;
        dag.vertices.push(first);
        let rest = usize::from(vertices) - 1;
        self.ascending(rest, i64::from(first) + 1, &mut dag.vertices)?;
        let triangles = self.small()?;
        for _ in 0..triangles {
            dag.corners.push(self.take()?);
        }
        Ok(Cluster {
            first_vertex: first_vertex as u32,
            first_triangle: first_triangle as u32,
            vertices,
            triangles,
            level: 0,
            range,
            own: None,
            parent: None,
            sphere,
            cone,
        })
    }

    /// From 1 to 255.
    fn small(&mut self) -> Result<u8> {
        match u8::try_from(self.number()?) {
            Ok(number @ 1..) => Ok(number),
            _ => Err(self.bad("a cluster is empty or too large")),
        }
    }
}
