//! Writing OBJ.

use super::mtl_write;
use crate::{
    atomic::{Sink, Transaction},
    error::{Error, Result},
    number::{write_flipped, write_float, write_floats, write_integer},
    write::write_file,
};
use foldhash::fast::RandomState;
use karui::{Scene, TriMesh, mesh::Attributes};
use std::{collections::HashMap, hash::Hash, io, path::Path};

/// Writes every placed mesh as an object in world space, its materials to a
/// library of the model's name, and the images beside it.
///
/// Equal positions, texture coordinates and normals are written once, so that
/// readers see one surface across seams.
pub(crate) fn write(files: &mut Transaction, path: &Path, scene: &Scene) -> Result<()> {
    let objects = objects(scene)?;
    let names = mtl_write::material_names(scene);
    let library = if scene.materials.is_empty() {
        None
    } else {
        Some(write_library(files, path, scene, &names)?)
    };
    write_file(files, path, |sink| {
        sink.write_all(b"# written by karui\n")?;
        if let Some(library) = &library {
            writeln!(sink, "mtllib {library}")?;
        }
        let mut written = Written::default();
        for (name, mesh) in &objects {
            write_object(sink, name.as_deref(), mesh, &names, &mut written)?;
        }
        Ok(())
    })
}

fn write_library(
    files: &mut Transaction,
    path: &Path,
    scene: &Scene,
    names: &[String],
) -> Result<String> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let (images, companions) = mtl_write::image_files(scene, path);
    for companion in companions {
        files.write(&folder.join(&companion.name), |sink| {
            sink.write_all(companion.bytes)
        })?;
    }
    let library = format!("{}.mtl", mtl_write::model_stem(path));
    files.write(&folder.join(&library), |sink| {
        mtl_write::write(sink, scene, names, &images)
    })?;
    Ok(library)
}

/// Every placed mesh in world space with a name of its own.
fn objects(scene: &Scene) -> Result<Vec<(Option<String>, TriMesh)>> {
    let fail = |error: karui::Error| Error::file("", error.into());
    scene.check_unfolded().map_err(fail)?;
    let mut objects = Vec::new();
    for instance in scene.iter_instances() {
        let node = &scene.nodes[instance.node as usize];
        let Some(named) = scene.meshes.get(instance.mesh as usize) else {
            continue;
        };
        let name = named.name.clone().or_else(|| node.name.clone());
        let world_from_mesh = instance.world_from_mesh.as_mat4();
        let mesh = named.mesh.clone().transformed(world_from_mesh);
        mesh.validate().map_err(fail)?;
        objects.push((name, mesh));
    }
    if let [(name, _)] = &mut objects[..] {
        *name = name.take().filter(|n| !n.trim().is_empty());
        return Ok(objects);
    }
    let given = objects.iter().map(|(n, _)| n.clone().unwrap_or_default());
    let names = mtl_write::unique(given, "object");
    for ((name, _), unique) in objects.iter_mut().zip(names) {
        *name = Some(unique);
    }
    Ok(objects)
}

/// How many of each kind have been written, for the indices of the next
/// object.
#[derive(Default)]
struct Written {
    positions: usize,
    uvs: usize,
    normals: usize,
}

fn write_object(
    sink: &mut Sink<'_>,
    name: Option<&str>,
    mesh: &TriMesh,
    materials: &[String],
    written: &mut Written,
) -> io::Result<()> {
    if let Some(name) = name {
        writeln!(sink, "o {}", one_line(name))?;
    }
    let colors = mesh.attributes.colors.first();
    let color = |v: usize| colors.map(|c| c[v].to_array());
    let vertices = mesh.positions.len();
    let positions = Distinct::of(vertices, |v| {
        (bits(mesh.positions[v].to_array()), color(v).map(bits))
    });
    let has_alpha = colors.is_some_and(|c| c.iter().any(|c| c.w != 1.0));
    for &v in &positions.first {
        sink.write_all(b"v")?;
        write_floats(sink, &mesh.positions[v].to_array())?;
        if let Some(color) = color(v) {
            write_floats(sink, &color[..if has_alpha { 4 } else { 3 }])?;
        }
        sink.write_all(b"\n")?;
    }
    let uvs = write_uvs(sink, &mesh.attributes)?;
    let normals = write_normals(sink, &mesh.attributes)?;
    let index = |d: &Option<Distinct>, base: usize, v: u32| {
        d.as_ref().map(|d| base + d.of_vertex[v as usize] + 1)
    };
    let corner = |sink: &mut Sink<'_>, v: u32| {
        let position = written.positions + positions.of_vertex[v as usize] + 1;
        let uv = index(&uvs, written.uvs, v);
        let normal = index(&normals, written.normals, v);
        write_corner(sink, position, uv, normal)
    };
    write_faces(sink, mesh, materials, corner)?;
    let count = |d: &Option<Distinct>| d.as_ref().map_or(0, |d| d.first.len());
    written.positions += positions.first.len();
    written.uvs += count(&uvs);
    written.normals += count(&normals);
    Ok(())
}

fn write_uvs(sink: &mut Sink<'_>, attributes: &Attributes) -> io::Result<Option<Distinct>> {
    let Some(uvs) = attributes.uvs.first() else {
        return Ok(None);
    };
    let distinct = Distinct::of(uvs.len(), |v| bits(uvs[v].to_array()));
    for &v in &distinct.first {
        sink.write_all(b"vt ")?;
        write_float(sink, uvs[v].x)?;
        sink.write_all(b" ")?;
        write_flipped(sink, uvs[v].y)?;
        sink.write_all(b"\n")?;
    }
    Ok(Some(distinct))
}

fn write_normals(sink: &mut Sink<'_>, attributes: &Attributes) -> io::Result<Option<Distinct>> {
    let Some(normals) = &attributes.normals else {
        return Ok(None);
    };
    let distinct = Distinct::of(normals.len(), |v| bits(normals[v].to_array()));
    for &v in &distinct.first {
        sink.write_all(b"vn")?;
        write_floats(sink, &normals[v].to_array())?;
        sink.write_all(b"\n")?;
    }
    Ok(Some(distinct))
}

fn write_faces(
    sink: &mut Sink<'_>,
    mesh: &TriMesh,
    materials: &[String],
    corner: impl Fn(&mut Sink<'_>, u32) -> io::Result<()>,
) -> io::Result<()> {
    for range in mesh.ranges_or_whole() {
        if let Some(name) = range.material.and_then(|m| materials.get(m as usize)) {
            writeln!(sink, "usemtl {name}")?;
        }
        for triangle in &mesh.triangles[range.triangles()] {
            sink.write_all(b"f")?;
            for &v in triangle {
                corner(sink, v)?;
            }
            sink.write_all(b"\n")?;
        }
    }
    Ok(())
}

fn write_corner(
    sink: &mut Sink<'_>,
    position: usize,
    uv: Option<usize>,
    normal: Option<usize>,
) -> io::Result<()> {
    sink.write_all(b" ")?;
    write_integer(sink, position)?;
    if uv.is_some() || normal.is_some() {
        sink.write_all(b"/")?;
    }
    if let Some(uv) = uv {
        write_integer(sink, uv)?;
    }
    if let Some(normal) = normal {
        sink.write_all(b"/")?;
        write_integer(sink, normal)?;
    }
    Ok(())
}

fn one_line(name: &str) -> String {
    let printable = |c: char| if c.is_control() { '_' } else { c };
    name.trim().chars().map(printable).collect()
}

fn bits<const N: usize>(values: [f32; N]) -> [u32; N] {
    values.map(f32::to_bits)
}

/// Numbers for values so that equal ones share theirs, by first appearance.
struct Distinct {
    of_vertex: Vec<usize>,
    /// A vertex that has the value.
    first: Vec<usize>,
}

impl Distinct {
    fn of<K: Hash + Eq>(vertices: usize, key: impl Fn(usize) -> K) -> Self {
        let mut number: HashMap<K, usize, RandomState> = HashMap::default();
        let mut first = Vec::new();
        let of_vertex = (0..vertices)
            .map(|v| {
                *number.entry(key(v)).or_insert_with(|| {
                    first.push(v);
                    first.len() - 1
                })
            })
            .collect();
        Self { of_vertex, first }
    }
}
