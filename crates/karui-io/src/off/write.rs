//! Writing OFF.

use crate::{
    atomic::Sink,
    color::{self, Layout},
    number::{byte_of, write_flipped, write_float, write_floats, write_integer},
};
use karui::{
    TriMesh,
    geom::Vec4,
    mesh::{Attribute, AttributeValues},
};
use std::io;

/// Writes the triangles with the normals, first colours and first texture
/// coordinates of the vertices and the colours of the faces.
pub(crate) fn write(sink: &mut Sink<'_>, mesh: &TriMesh) -> io::Result<()> {
    let a = &mesh.attributes;
    let mark = |there: bool, mark: &'static str| if there { mark } else { "" };
    writeln!(
        sink,
        "{}{}{}OFF\n{} {} 0",
        mark(!a.uvs.is_empty(), "ST"),
        mark(!a.colors.is_empty(), "C"),
        mark(a.normals.is_some(), "N"),
        mesh.positions.len(),
        mesh.triangles.len()
    )?;
    let layout = a.colors.first().map(|colors| Layout::of(colors));
    for v in 0..mesh.positions.len() {
        write_vertex(sink, mesh, v, layout)?;
    }
    let colors = color::of_faces(&mesh.face_attributes);
    for (t, corners) in mesh.triangles.iter().enumerate() {
        sink.write_all(b"3")?;
        for &v in corners {
            sink.write_all(b" ")?;
            write_integer(sink, v)?;
        }
        if let Some(colors) = colors {
            write_face_color(sink, colors, t)?;
        }
        sink.write_all(b"\n")?;
    }
    Ok(())
}

fn write_vertex(
    sink: &mut Sink<'_>,
    mesh: &TriMesh,
    v: usize,
    layout: Option<Layout>,
) -> io::Result<()> {
    let a = &mesh.attributes;
    let [x, y, z] = mesh.positions[v].to_array();
    write_float(sink, x)?;
    write_floats(sink, &[y, z])?;
    if let Some(normals) = &a.normals {
        write_floats(sink, &normals[v].to_array())?;
    }
    if let (Some(colors), Some(layout)) = (a.colors.first(), layout) {
        write_color(sink, colors[v], layout)?;
    }
    if let Some(uvs) = a.uvs.first() {
        write_floats(sink, &[uvs[v].x])?;
        sink.write_all(b" ")?;
        write_flipped(sink, uvs[v].y)?;
    }
    sink.write_all(b"\n")
}

fn write_color(sink: &mut Sink<'_>, color: Vec4, layout: Layout) -> io::Result<()> {
    let components = color.to_array();
    for &c in &components[..layout.components()] {
        match byte_of(c).filter(|_| layout.bytes) {
            Some(byte) => write!(sink, " {byte}")?,
            None => write_fraction(sink, c)?,
        }
    }
    Ok(())
}

/// With a point or exponent, which is what tells 1.0 from the byte 1.
fn write_fraction(sink: &mut Sink<'_>, value: f32) -> io::Result<()> {
    write!(sink, " {}", zmij::Buffer::new().format(value))
}

fn write_face_color(sink: &mut Sink<'_>, colors: &Attribute, t: usize) -> io::Result<()> {
    let element = t * colors.components..(t + 1) * colors.components;
    match &colors.values {
        AttributeValues::U8(bytes) => bytes[element]
            .iter()
            .try_for_each(|byte| write!(sink, " {byte}")),
        AttributeValues::F32(values) => values[element]
            .iter()
            .try_for_each(|&value| write_fraction(sink, value)),
        _ => Ok(()),
    }
}
