//! glTF and GLB in slices: the document is in memory, buffers stay in their files.
//!
//! Vertices come in the order of [`karui::Scene::into_single_mesh`], those of a mesh again
//! for every place where it stands. Where only some meshes have texture coordinates or
//! colours, the others get (0, 0) and white; normals and tangents are carried only if all
//! meshes have them. Skins, morph targets and custom attributes are left aside. Compressed
//! meshes cannot be read in slices.

mod buffers;
mod meshes;

use super::{
    budget::Budget,
    document::Document,
    instancing::{self, INSTANCING},
    json::{self, ROOT},
    node,
    primitive::{Mode, triangles},
    read::read_nodes,
};
use crate::{
    error::{ErrorKind, Result},
    slices::{failed, file::FileAt},
    warnings::Warnings,
};
use buffers::{AccessorAt, Buffers};
use glam::{Mat3, Mat4, Vec2, Vec3, Vec4};
use karui::{
    Scene, TriMesh,
    mesh::Attributes,
    outofcore::{self, Source, Vertices},
};
use meshes::{BlockAt, MeshAt, PrimitiveAt};
use serde_json::Value;
use std::{ops::Range, sync::Arc};

/// Triangles of a portion.
const TRIANGLES: u64 = 65_536;

/// A glTF file.
pub(crate) struct Gltf {
    file: Arc<FileAt>,
    buffers: Buffers,
    meshes: Vec<MeshAt>,
    placed: Vec<Placed>,
    portions: Vec<Portion>,
    kinds: Kinds,
    vertices: u64,
}

/// A mesh that stands somewhere.
struct Placed {
    mesh: usize,
    world_from_mesh: Mat4,
    /// Its first vertex.
    first: u64,
}

/// Where a portion starts: a placed mesh, a primitive of it, a triangle of that.
#[derive(Clone, Copy)]
struct Portion {
    placed: usize,
    primitive: usize,
    triangle: u64,
}

/// What every vertex carries.
struct Kinds {
    normals: bool,
    tangents: bool,
    uvs: usize,
    colors: usize,
}

/// Reads the document and finds out where all meshes are and stand.
pub(crate) fn open(file: FileAt, warnings: &mut Warnings) -> Result<Gltf> {
    let file = Arc::new(file);
    let parts = buffers::split(&file)?;
    let json = json::parse(&parts.json)?;
    let buffers = Buffers::find(&json, parts.bin, &file)?;
    let meshes: Vec<MeshAt> = (0..json::count(&json, "meshes"))
        .map(|m| meshes::find(&json, m, &buffers, warnings))
        .collect::<Result<_>>()?;
    let scene = nodes(json, &buffers, parts.json.len())?;
    let mut vertices = 0u64;
    let mut placed = Vec::new();
    for instance in scene.iter_instances() {
        let mesh = instance.mesh as usize;
        let Some(found) = meshes.get(mesh) else {
            continue;
        };
        placed.push(Placed {
            mesh,
            world_from_mesh: instance.world_from_mesh.as_mat4(),
            first: vertices,
        });
        vertices = vertices.saturating_add(found.vertices);
    }
    let portions = portions(&meshes, &placed);
    if portions.is_empty() {
        warnings.push("the file holds no triangles");
    }
    Ok(Gltf {
        kinds: Kinds::of(&meshes, &placed),
        file,
        buffers,
        meshes,
        portions,
        placed,
        vertices,
    })
}

/// The nodes of the document, without meshes.
fn nodes(json: Value, buffers: &Buffers, size: usize) -> Result<Scene> {
    let wanted = instancing_views(&json)?;
    let views = buffers.views(&wanted)?;
    let read = views.iter().flatten().map(|(bytes, _)| bytes.len()).sum();
    let budget = Budget::new(read, size);
    let document = Document::of_views(json, views);
    let mut nodes = read_nodes(&document.json, &budget)?;
    instancing::read_all(&document, &budget, &mut nodes)?;
    let roots = node::roots(&document.json, &nodes)?;
    Ok(Scene {
        nodes,
        roots,
        ..Scene::default()
    })
}

/// The buffer views that hold places of instances.
fn instancing_views(json: &Value) -> Result<Vec<bool>> {
    let mut wanted = vec![false; json::count(json, "bufferViews")];
    for node in json::array(json, "nodes", &ROOT)? {
        let attributes = json::extension(node, INSTANCING).and_then(|e| e.get("attributes"));
        let indices = attributes.and_then(Value::as_object).into_iter().flatten();
        for index in indices.filter_map(|(_, v)| v.as_u64()) {
            let accessor = json["accessors"].get(index as usize);
            for pointer in [
                "/bufferView",
                "/sparse/indices/bufferView",
                "/sparse/values/bufferView",
            ] {
                let view = accessor.and_then(|a| a.pointer(pointer)?.as_u64());
                if let Some(wanted) = view.and_then(|v| wanted.get_mut(v as usize)) {
                    *wanted = true;
                }
            }
        }
    }
    Ok(wanted)
}

/// Portions of equal size, over the ends of primitives and meshes.
fn portions(meshes: &[MeshAt], all: &[Placed]) -> Vec<Portion> {
    let mut starts = Vec::new();
    let mut room = 0;
    for (placed, of) in all.iter().enumerate() {
        for (primitive, found) in meshes[of.mesh].primitives.iter().enumerate() {
            let mut triangle = 0;
            while triangle < found.triangles {
                if room == 0 {
                    starts.push(Portion {
                        placed,
                        primitive,
                        triangle,
                    });
                    room = TRIANGLES;
                }
                let taken = room.min(found.triangles - triangle);
                triangle += taken;
                room -= taken;
            }
        }
    }
    starts
}

impl Kinds {
    fn of(meshes: &[MeshAt], placed: &[Placed]) -> Self {
        let mut used = vec![false; meshes.len()];
        placed.iter().for_each(|p| used[p.mesh] = true);
        let used = |(m, _): &(usize, &MeshAt)| used[*m];
        let blocks = || {
            meshes
                .iter()
                .enumerate()
                .filter(used)
                .flat_map(|(_, m)| &m.blocks)
        };
        Self {
            normals: blocks().next().is_some() && blocks().all(|b| b.normals.is_some()),
            tangents: blocks().next().is_some() && blocks().all(|b| b.tangents.is_some()),
            uvs: blocks().map(|b| b.uvs.len()).max().unwrap_or(0),
            colors: blocks().map(|b| b.colors.len()).max().unwrap_or(0),
        }
    }

    fn empty(&self) -> TriMesh {
        TriMesh {
            attributes: Attributes {
                normals: self.normals.then(Vec::new),
                tangents: self.tangents.then(Vec::new),
                uvs: vec![Vec::new(); self.uvs],
                colors: vec![Vec::new(); self.colors],
                ..Attributes::default()
            },
            ..TriMesh::default()
        }
    }
}

impl Gltf {
    fn slice(&self, ids: Range<u64>) -> Result<Vertices> {
        let end = ids.end.min(self.vertices);
        let ids = ids.start.min(end)..end;
        let mut whole = self.kinds.empty();
        let after = self.placed.partition_point(|p| p.first <= ids.start);
        for placed in &self.placed[after.saturating_sub(1)..] {
            if placed.first >= ids.end {
                break;
            }
            let mut first = placed.first;
            for block in &self.meshes[placed.mesh].blocks {
                let range = first..first + block.positions.count;
                let [start, end] = [ids.start, ids.end].map(|v| v.clamp(range.start, range.end));
                if start < end {
                    let piece = self.block(block, start - first..end - first)?;
                    append(&mut whole, piece.transformed(placed.world_from_mesh));
                }
                first = range.end;
            }
        }
        Ok(Vertices {
            positions: whole.positions,
            attributes: whole.attributes,
        })
    }

    fn block(&self, block: &BlockAt, range: Range<u64>) -> Result<TriMesh> {
        let found = self
            .buffers
            .read(&block.positions, range.clone())?
            .floats([0.0; 3]);
        let positions: Vec<Vec3> = found.into_iter().map(Vec3::from).collect();
        if let Some(bad) = positions.iter().position(|p| !p.is_finite()) {
            let kind = ErrorKind::NotFinite { what: "a position" };
            let bad = range.start + bad as u64;
            return Err(self.buffers.fail(&block.positions, bad, kind));
        }
        let mut mesh = self.kinds.empty();
        mesh.positions = positions;
        let a = &mut mesh.attributes;
        if let Some(normals) = &mut a.normals {
            *normals = self.floats(block.normals.as_ref(), &range, [0.0, 0.0, 1.0])?;
        }
        if let Some(tangents) = &mut a.tangents {
            *tangents = self.floats(block.tangents.as_ref(), &range, [1.0, 0.0, 0.0, 1.0])?;
        }
        for (i, set) in a.uvs.iter_mut().enumerate() {
            let uvs = block.uvs.get(i).and_then(Option::as_ref);
            *set = self.floats::<Vec2, 2>(uvs, &range, [0.0; 2])?;
        }
        for (i, set) in a.colors.iter_mut().enumerate() {
            let colors = block.colors.get(i).and_then(Option::as_ref);
            *set = self.floats::<Vec4, 4>(colors, &range, [1.0; 4])?;
        }
        Ok(mesh)
    }

    /// Values of some vertices; `default` where there are none, or none that are finite.
    fn floats<V: From<[f32; N]>, const N: usize>(
        &self,
        of: Option<&AccessorAt>,
        range: &Range<u64>,
        default: [f32; N],
    ) -> Result<Vec<V>> {
        let count = (range.end - range.start) as usize;
        let values = match of {
            Some(of) => self.buffers.read(of, range.clone())?.floats(default),
            None => vec![default; count],
        };
        let finite = |v: [f32; N]| {
            if v.iter().all(|f| f.is_finite()) {
                v
            } else {
                default
            }
        };
        Ok(values.into_iter().map(|v| V::from(finite(v))).collect())
    }

    fn triangles(&self, portion: u64) -> Result<Vec<[u64; 3]>> {
        let mut found = Vec::new();
        let Some(&Portion {
            mut placed,
            mut primitive,
            mut triangle,
        }) = self.portions.get(portion as usize)
        else {
            return Ok(found);
        };
        let mut room = TRIANGLES;
        while let Some(place) = self.placed.get(placed).filter(|_| room > 0) {
            let Some(of) = self.meshes[place.mesh].primitives.get(primitive) else {
                (placed, primitive) = (placed + 1, 0);
                continue;
            };
            let taken = room.min(of.triangles - triangle);
            let local = self.primitive(of, triangle..triangle + taken)?;
            let is_mirror = Mat3::from_mat4(place.world_from_mesh).determinant() < 0.0;
            found.extend(local.into_iter().map(|mut t| {
                if is_mirror {
                    t.swap(1, 2);
                }
                t.map(|v| u64::from(v) + of.first + place.first)
            }));
            room -= taken;
            (primitive, triangle) = (primitive + 1, 0);
        }
        Ok(found)
    }

    /// Some triangles of a primitive, as indices into its block.
    fn primitive(&self, of: &PrimitiveAt, range: Range<u64>) -> Result<Vec<[u32; 3]>> {
        if range.is_empty() {
            return Ok(Vec::new());
        }
        match of.mode {
            Mode::List => {
                let corners = self.corners(of, 3 * range.start..3 * range.end)?;
                Ok(triangles(Mode::List, &corners))
            }
            Mode::Strip => {
                let corners = self.corners(of, range.start..range.end + 2)?;
                let mut strip = triangles(Mode::Strip, &corners);
                if range.start % 2 == 1 {
                    strip.iter_mut().for_each(|t| t.swap(1, 2));
                }
                Ok(strip)
            }
            Mode::Fan => {
                let mut corners = self.corners(of, 0..1)?;
                corners.extend(self.corners(of, range.start + 1..range.end + 2)?);
                Ok(triangles(Mode::Fan, &corners))
            }
        }
    }

    fn corners(&self, of: &PrimitiveAt, range: Range<u64>) -> Result<Vec<u32>> {
        let Some(corners) = &of.corners else {
            return Ok(range.map(|v| v as u32).collect());
        };
        let found = self.buffers.read(corners, range.clone())?.indices();
        let bad = |&c: &u32| u64::from(c) >= of.vertices;
        let Some(at) = found.iter().position(bad) else {
            return Ok(found);
        };
        let kind = ErrorKind::IndexOutOfRange {
            what: "vertex",
            index: i64::from(found[at]),
            count: of.vertices as usize,
        };
        Err(self.buffers.fail(corners, range.start + at as u64, kind))
    }
}

/// Adds vertices with the same attributes.
fn append(to: &mut TriMesh, from: TriMesh) {
    to.positions.extend(from.positions);
    let (to, from) = (&mut to.attributes, from.attributes);
    if let (Some(to), Some(from)) = (&mut to.normals, from.normals) {
        to.extend(from);
    }
    if let (Some(to), Some(from)) = (&mut to.tangents, from.tangents) {
        to.extend(from);
    }
    to.uvs
        .iter_mut()
        .zip(from.uvs)
        .for_each(|(to, from)| to.extend(from));
    to.colors
        .iter_mut()
        .zip(from.colors)
        .for_each(|(to, from)| to.extend(from));
}

impl Source for Gltf {
    fn vertices(&self) -> u64 {
        self.vertices
    }

    fn chunks(&self) -> u64 {
        self.portions.len() as u64
    }

    fn read_vertices(&self, ids: Range<u64>) -> outofcore::Result<Vertices> {
        self.slice(ids).map_err(|e| failed(e, &self.file))
    }

    fn read_triangles(&self, chunk: u64) -> outofcore::Result<Vec<[u64; 3]>> {
        self.triangles(chunk).map_err(|e| failed(e, &self.file))
    }
}
