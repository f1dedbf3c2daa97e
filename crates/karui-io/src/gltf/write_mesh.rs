//! A mesh as glTF primitives: one for each material range with triangles.
//! Ranges that share vertices share accessors.

use super::{
    encode,
    json::{self, ROOT},
    material::set,
    origin::Origin,
    pack::{Packer, Use, check_count},
    primitive::triangle_mode,
    quantize::Grid,
    references::{OF_TRIANGLES, visit_primitive},
    write_vertices::Vertices,
};
use crate::error::Result;
use karui::mesh::{MaterialRange, NamedMesh, TriMesh};
use serde_json::{Value, json};

/// A range to be written, and what it was in the file it came from.
struct Part<'a> {
    range: MaterialRange,
    raw: Option<&'a Value>,
    /// Mesh of the file that the primitive belongs to.
    mesh: Option<usize>,
    /// Names of attributes that other primitives of that mesh had but not
    /// this one.
    omit: Vec<&'a str>,
}

/// What the writers of meshes share.
pub(super) struct MeshWriter<'w, 'a> {
    pub origin: &'w mut Origin<'a>,
    pub packer: &'w mut Packer,
    pub quantize: bool,
}

impl<'a> MeshWriter<'_, 'a> {
    /// Writes mesh `index`. `None` if there is nothing to draw, which glTF
    /// cannot express.
    pub fn write(
        &mut self,
        index: usize,
        named: &NamedMesh,
        grid: Option<Grid>,
    ) -> Result<Option<Value>> {
        let parts = self.parts(&named.mesh);
        let mut written: Vec<Option<Value>> = vec![None; parts.len()];
        for pool in pools(&named.mesh, &parts) {
            self.write_pool(&named.mesh, &parts, &pool, grid, &mut written)?;
        }
        let mut primitives = Vec::new();
        self.add_in_file_order(index, &parts, &mut written, &mut primitives)?;
        primitives.extend(written.into_iter().flatten());
        if primitives.is_empty() {
            return Ok(None);
        }
        let mut mesh = self.frame(index, named, &parts);
        mesh["primitives"] = Value::Array(primitives);
        Ok(Some(mesh))
    }

    fn parts(&self, mesh: &TriMesh) -> Vec<Part<'a>> {
        let ranges = mesh.ranges_or_whole().into_iter().filter(|r| r.count > 0);
        let mut names: Option<(usize, Vec<&'a str>)> = None;
        let part = |range: MaterialRange| {
            let Some((mesh, raw)) = range.source.and_then(|s| self.origin.primitive(s)) else {
                return Part {
                    range,
                    raw: None,
                    mesh: None,
                    omit: Vec::new(),
                };
            };
            if names.as_ref().is_none_or(|(m, _)| *m != mesh) {
                names = Some((mesh, self.origin.attribute_names(mesh)));
            }
            let all = names.iter().flat_map(|(_, names)| names.iter().copied());
            let lacks = |name: &&str| raw["attributes"].get(*name).is_none();
            Part {
                range,
                raw: Some(raw),
                mesh: Some(mesh),
                omit: all.filter(lacks).collect(),
            }
        };
        ranges.map(part).collect()
    }

    /// Writes the vertices of the parts that `pool` lists and those parts.
    fn write_pool(
        &mut self,
        mesh: &TriMesh,
        parts: &[Part<'a>],
        pool: &[usize],
        grid: Option<Grid>,
        written: &mut [Option<Value>],
    ) -> Result<()> {
        let triangles = |part: &Part<'_>| &mesh.triangles[part.range.triangles()];
        let corners = pool.iter().map(|&p| triangles(&parts[p]).as_flattened());
        let sources = used_vertices(mesh.positions.len(), corners);
        check_count("vertices", sources.len())?;
        let Some(first) = pool.first().map(|&p| &parts[p]) else {
            return Ok(());
        };
        let origin = &*self.origin;
        let vertices = Vertices {
            mesh,
            sources: &sources,
            omit: &first.omit,
            hint: &|name| origin.accessor(first.raw?, name),
            grid,
            quantize: self.quantize,
        };
        let (attributes, targets) = vertices.write(self.packer);
        let local = LocalIndices::new(&sources);
        for &p in pool {
            let corners = triangles(&parts[p]).as_flattened().iter();
            let corners: Vec<u32> = corners.map(|&v| local.get(v)).collect();
            let array = encode::indices(&corners, sources.len());
            let indices = self.packer.push(array, Use::Triangles);
            written[p] = Some(primitive(&parts[p], &attributes, &targets, indices));
        }
        Ok(())
    }

    /// Takes the primitives over in the order of the file, points and lines
    /// among them.
    fn add_in_file_order(
        &mut self,
        index: usize,
        parts: &[Part<'a>],
        written: &mut [Option<Value>],
        primitives: &mut Vec<Value>,
    ) -> Result<()> {
        let Some(mesh) = self.origin.mesh(index) else {
            return Ok(());
        };
        let mut order: Vec<usize> = (0..parts.len()).collect();
        order.retain(|&p| parts[p].mesh == Some(index));
        order.sort_by_key(|&p| parts[p].range.source);
        let mut order = order.into_iter().peekable();
        let first = self.origin.first_primitive(index);
        let at = ROOT.item("meshes", index);
        for (i, raw) in json::array(mesh, "primitives", &at)?.iter().enumerate() {
            if triangle_mode(raw).is_none() {
                primitives.push(self.pass(raw.clone())?);
            }
            let number = first + i as u32;
            while let Some(p) = order.next_if(|&p| parts[p].range.source == Some(number)) {
                primitives.extend(written[p].take());
            }
        }
        Ok(())
    }

    /// Points or lines, with copies of their accessors.
    fn pass(&mut self, mut raw: Value) -> Result<Value> {
        let origin = &mut *self.origin;
        let packer = &mut *self.packer;
        visit_primitive(&mut raw, &ROOT, &mut |target, value, at| {
            let usage = if at.to_string() == "/indices" {
                Use::Indices
            } else {
                Use::Vertices
            };
            origin.pass(target, value, usage, at, packer)
        })?;
        Ok(raw)
    }

    /// The mesh without its primitives. A mesh that was added takes morph
    /// weights and target names from the one its primitives come from.
    fn frame(&self, index: usize, named: &NamedMesh, parts: &[Part<'a>]) -> Value {
        let morphs = named.mesh.attributes.morphs.len();
        let mut frame = match self.origin.mesh(index) {
            Some(raw) => raw.clone(),
            None => {
                let source = parts.first().and_then(|p| self.origin.mesh(p.mesh?));
                let mut frame = json!({});
                for key in ["weights", "extras"] {
                    if let Some(value) = source.and_then(|s| s.get(key)).filter(|_| morphs > 0) {
                        frame[key] = value.clone();
                    }
                }
                frame
            }
        };
        set(&mut frame, "name", json!(named.name), named.name.is_none());
        if json::count(&frame, "weights") != morphs && !parts.is_empty() {
            json::remove(&mut frame, "weights");
        }
        frame
    }
}

fn primitive(part: &Part<'_>, attributes: &Value, targets: &[Value], indices: usize) -> Value {
    let mut primitive = part.raw.cloned().unwrap_or_else(|| json!({}));
    primitive["attributes"] = attributes.clone();
    primitive["indices"] = json!(indices);
    json::remove(&mut primitive, "mode");
    set(
        &mut primitive,
        "targets",
        json!(targets),
        targets.is_empty(),
    );
    let material = part.range.material;
    set(
        &mut primitive,
        "material",
        json!(material),
        material.is_none(),
    );
    for extension in OF_TRIANGLES {
        json::remove_extension(&mut primitive, extension);
    }
    primitive
}

/// The vertices that corners name, in order, each once.
fn used_vertices<'m>(
    vertices: usize,
    corners: impl Iterator<Item = &'m [u32]> + Clone,
) -> Vec<u32> {
    if corners.clone().map(<[u32]>::len).sum::<usize>() < vertices / 16 {
        // A small part of a large mesh: its size counts, not the mesh's.
        let mut used: Vec<u32> = corners.flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
        return used;
    }
    let mut is_used = vec![false; vertices];
    for &v in corners.flatten() {
        is_used[v as usize] = true;
    }
    let used = is_used.iter().enumerate().filter(|(_, used)| **used);
    used.map(|(v, _)| v as u32).collect()
}

/// Groups of parts that are joined by common vertices and lack the same
/// attributes, in the order of their first part.
fn pools(mesh: &TriMesh, parts: &[Part<'_>]) -> Vec<Vec<usize>> {
    let mut parent: Vec<usize> = (0..parts.len()).collect();
    let mut owner: Vec<u32> = vec![u32::MAX; mesh.positions.len()];
    for (p, part) in parts.iter().enumerate() {
        for &v in mesh.triangles[part.range.triangles()].as_flattened() {
            let owner = &mut owner[v as usize];
            if *owner == u32::MAX {
                *owner = p as u32;
            } else if *owner != p as u32 && parts[*owner as usize].omit == part.omit {
                join(&mut parent, *owner as usize, p);
            }
        }
    }
    let mut pools: Vec<Vec<usize>> = vec![Vec::new(); parts.len()];
    for p in 0..parts.len() {
        let root = root_of(&mut parent, p);
        pools[root].push(p);
    }
    pools.retain(|pool| !pool.is_empty());
    pools
}

fn root_of(parent: &mut [usize], mut p: usize) -> usize {
    while parent[p] != p {
        parent[p] = parent[parent[p]];
        p = parent[p];
    }
    p
}

fn join(parent: &mut [usize], a: usize, b: usize) {
    let (a, b) = (root_of(parent, a), root_of(parent, b));
    let (low, high) = (a.min(b), a.max(b));
    parent[high] = low;
}

/// New indices of vertices listed in order: a table if the list is dense, a
/// search otherwise, so that many small parts of a large mesh stay cheap.
struct LocalIndices<'s> {
    sources: &'s [u32],
    first: u32,
    table: Vec<u32>,
}

impl<'s> LocalIndices<'s> {
    fn new(sources: &'s [u32]) -> Self {
        let first = sources.first().copied().unwrap_or(0);
        let span = sources.last().map_or(0, |l| (l - first) as usize + 1);
        let mut table = Vec::new();
        if span <= sources.len() * 8 {
            table.resize(span, 0);
            for (new, &old) in sources.iter().enumerate() {
                table[(old - first) as usize] = new as u32;
            }
        }
        Self {
            sources,
            first,
            table,
        }
    }

    fn get(&self, old: u32) -> u32 {
        if self.table.is_empty() {
            self.sources.partition_point(|&s| s < old) as u32
        } else {
            self.table[(old - self.first) as usize]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn part(first: u32, count: u32, omit: Vec<&str>) -> Part<'_> {
        Part {
            range: MaterialRange {
                first,
                count,
                ..MaterialRange::default()
            },
            raw: None,
            mesh: None,
            omit,
        }
    }

    #[test]
    fn parts_with_common_vertices_share_a_pool() {
        let triangles = vec![[0, 1, 2], [3, 4, 5], [2, 1, 6], [5, 4, 7]];
        let mesh = TriMesh::new(vec![Vec3::ZERO; 8], triangles);
        let parts: Vec<_> = (0..4).map(|t| part(t, 1, vec![])).collect();
        assert_eq!(pools(&mesh, &parts), [[0, 2], [1, 3]]);
        let mut parts = parts;
        parts[2].omit = vec!["NORMAL"];
        assert_eq!(pools(&mesh, &parts), [vec![0], vec![1, 3], vec![2]]);
    }

    #[test]
    fn used_vertices_of_small_and_large_parts() {
        for vertices in [10, 1000] {
            let corners: [&[u32]; 2] = [&[7, 3, 7], &[9, 3, 0]];
            assert_eq!(used_vertices(vertices, corners.into_iter()), [0, 3, 7, 9]);
        }
    }

    #[test]
    fn local_indices_dense_and_sparse() {
        for sources in [vec![5, 6, 9], vec![1, 4000, 9000]] {
            let local = LocalIndices::new(&sources);
            let found: Vec<u32> = sources.iter().map(|&s| local.get(s)).collect();
            assert_eq!(found, [0, 1, 2]);
        }
    }
}
