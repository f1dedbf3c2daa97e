//! Writing STL.

use super::{ATTRIBUTE, binary::HEADER};
use crate::{atomic::Sink, number::write_floats};
use karui::{TriMesh, geom::Vec3, geom::normal_times_two_areas, mesh::AttributeValues};
use std::io;

/// Writes the triangles, with normals that follow from the corners.
pub(crate) fn write(sink: &mut Sink<'_>, mesh: &TriMesh, ascii: bool) -> io::Result<()> {
    if ascii {
        write_ascii(sink, mesh)
    } else {
        write_binary(sink, mesh)
    }
}

fn write_ascii(sink: &mut Sink<'_>, mesh: &TriMesh) -> io::Result<()> {
    sink.write_all(b"solid karui\n")?;
    for (t, corners) in mesh.triangles.iter().enumerate() {
        sink.write_all(b"facet normal")?;
        write_floats(sink, &normal(mesh, t).to_array())?;
        sink.write_all(b"\n outer loop\n")?;
        for &v in corners {
            sink.write_all(b"  vertex")?;
            write_floats(sink, &mesh.positions[v as usize].to_array())?;
            sink.write_all(b"\n")?;
        }
        sink.write_all(b" endloop\nendfacet\n")?;
    }
    sink.write_all(b"endsolid karui\n")
}

fn write_binary(sink: &mut Sink<'_>, mesh: &TriMesh) -> io::Result<()> {
    // The text must not start with `solid`, the mark of the other kind.
    let mut header = [0; HEADER - 4];
    header[..18].copy_from_slice(b"binary STL (karui)");
    sink.write_all(&header)?;
    sink.write_all(&(mesh.triangles.len() as u32).to_le_bytes())?;
    let attributes = attributes(mesh);
    for (t, &[a, b, c]) in mesh.triangles.iter().enumerate() {
        let at = |v: u32| mesh.positions[v as usize];
        for vector in [normal(mesh, t), at(a), at(b), at(c)] {
            let bytes = vector.to_array().map(f32::to_le_bytes);
            sink.write_all(bytes.as_flattened())?;
        }
        let attribute = attributes.get(t).copied().unwrap_or(0);
        sink.write_all(&attribute.to_le_bytes())?;
    }
    Ok(())
}

fn attributes(mesh: &TriMesh) -> &[u16] {
    let found = mesh.face_attributes.iter().find(|a| a.name == ATTRIBUTE);
    match found.map(|a| (a.components, &a.values)) {
        Some((1, AttributeValues::U16(values))) => values,
        _ => &[],
    }
}

fn normal(mesh: &TriMesh, t: usize) -> Vec3 {
    let normal = normal_times_two_areas(mesh.corners(t));
    normal.normalize_or_zero().as_vec3()
}
