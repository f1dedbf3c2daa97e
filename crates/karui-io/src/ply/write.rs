//! Writing PLY.

use super::SETS;
use crate::{
    atomic::Sink,
    color::{self, Layout},
    number::{flip, to_byte, unflip, write_double, write_float, write_integer},
};
use karui::{
    TriMesh,
    geom::{Vec2, Vec3, Vec4},
    mesh::{Attribute, AttributeValues, Attributes},
};
use std::io;

/// How the body of a PLY file is encoded.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum PlyEncoding {
    /// The usual one, and the fastest to read.
    #[default]
    BinaryLittleEndian,
    /// As old workstations wrote it.
    BinaryBigEndian,
    /// Text.
    Ascii,
}

/// Writes the triangles, the vertices with all attributes but skins and morph
/// targets, and the face attributes.
pub(crate) fn write(sink: &mut Sink<'_>, mesh: &TriMesh, encoding: PlyEncoding) -> io::Result<()> {
    let vertex = vertex_columns(&mesh.positions, &mesh.attributes, &Types::shortest());
    let face = face_columns(mesh);
    write_header(sink, mesh, encoding, &vertex, &face)?;
    let mut row = Row {
        encoding,
        bytes: Vec::new(),
    };
    for v in 0..mesh.positions.len() {
        vertex.iter().for_each(|column| row.push((column.value)(v)));
        row.flush(sink)?;
    }
    for (t, corners) in mesh.triangles.iter().enumerate() {
        row.push(Value::U8(3));
        corners.iter().for_each(|&v| row.push(Value::U32(v)));
        face.iter().for_each(|column| row.push((column.value)(t)));
        row.flush(sink)?;
    }
    Ok(())
}

fn write_header(
    sink: &mut Sink<'_>,
    mesh: &TriMesh,
    encoding: PlyEncoding,
    vertex: &[Column<'_>],
    face: &[Column<'_>],
) -> io::Result<()> {
    let format = match encoding {
        PlyEncoding::BinaryLittleEndian => "binary_little_endian",
        PlyEncoding::BinaryBigEndian => "binary_big_endian",
        PlyEncoding::Ascii => "ascii",
    };
    writeln!(sink, "ply\nformat {format} 1.0\ncomment written by karui")?;
    writeln!(sink, "element vertex {}", mesh.positions.len())?;
    for column in vertex {
        writeln!(sink, "property {} {}", column.scalar, column.name)?;
    }
    writeln!(sink, "element face {}", mesh.triangles.len())?;
    let index = index_type(mesh.positions.len() as u64);
    writeln!(sink, "property list uchar {index} vertex_indices")?;
    for column in face {
        writeln!(sink, "property {} {}", column.scalar, column.name)?;
    }
    sink.write_all(b"end_header\n")
}

/// A property and how to get its value for an element.
pub(crate) struct Column<'a> {
    pub name: String,
    pub scalar: &'static str,
    pub value: Box<dyn Fn(usize) -> Value + 'a>,
}

#[derive(Clone, Copy)]
pub(crate) enum Value {
    I8(i8),
    U8(u8),
    I16(i16),
    U16(u16),
    I32(i32),
    U32(u32),
    F32(f32),
    F64(f64),
}

/// Signed, because many readers know no other; 2^31 vertices fit in none.
pub(crate) fn index_type(vertices: u64) -> &'static str {
    if vertices > i32::MAX as u64 {
        "uint"
    } else {
        "int"
    }
}

/// How the types of columns are chosen.
pub(crate) struct Types {
    /// Of a set of colours.
    pub color: fn(&[Vec4]) -> Layout,
    /// Whether the t of texture coordinates is in double precision.
    pub double: fn(&[Vec2]) -> bool,
}

impl Types {
    /// The shortest that lose nothing, which all vertices have to be seen for.
    fn shortest() -> Self {
        Self {
            color: Layout::of,
            double: |uvs| {
                !uvs.iter()
                    .all(|uv| unflip(f64::from(flip(uv.y) as f32)) == uv.y)
            },
        }
    }
}

pub(crate) fn vertex_columns<'a>(
    positions: &'a [Vec3],
    a: &'a Attributes,
    types: &Types,
) -> Vec<Column<'a>> {
    let mut columns = Vec::new();
    push_floats(&mut columns, ["x", "y", "z"], |v, i| positions[v][i]);
    if let Some(normals) = &a.normals {
        push_floats(&mut columns, ["nx", "ny", "nz"], |v, i| normals[v][i]);
    }
    if let Some(tangents) = &a.tangents {
        push_floats(&mut columns, ["tx", "ty", "tz", "tw"], |v, i| {
            tangents[v][i]
        });
    }
    for (set, uvs) in a.uvs.iter().take(SETS).enumerate() {
        push_floats(&mut columns, [numbered("s", set)], |v, _| uvs[v].x);
        let name = numbered("t", set);
        columns.push(if (types.double)(uvs) {
            column(name, "double", |v| Value::F64(flip(uvs[v].y)))
        } else {
            column(name, "float", |v| Value::F32(flip(uvs[v].y) as f32))
        });
    }
    for (set, colors) in a.colors.iter().take(SETS).enumerate() {
        let layout = (types.color)(colors);
        let names = ["red", "green", "blue", "alpha"];
        for (i, name) in names[..layout.components()].iter().enumerate() {
            let name = numbered(name, set);
            columns.push(if layout.bytes {
                column(name, "uchar", move |v| Value::U8(to_byte(colors[v][i])))
            } else {
                column(name, "float", move |v| Value::F32(colors[v][i]))
            });
        }
    }
    a.custom.iter().for_each(|c| push_custom(&mut columns, c));
    columns
}

fn face_columns(mesh: &TriMesh) -> Vec<Column<'_>> {
    let mut columns = Vec::new();
    for attribute in &mesh.face_attributes {
        if color::is_face_color(attribute) {
            let names = ["red", "green", "blue", "alpha"];
            for (i, name) in names[..attribute.components].iter().enumerate() {
                columns.push(component(attribute, i, (*name).into()));
            }
        } else {
            push_custom(&mut columns, attribute);
        }
    }
    columns
}

fn numbered(name: &str, set: usize) -> String {
    if set == 0 {
        name.into()
    } else {
        format!("{name}{set}")
    }
}

fn column<'a>(
    name: String,
    scalar: &'static str,
    value: impl Fn(usize) -> Value + 'a,
) -> Column<'a> {
    let value = Box::new(value);
    Column {
        name,
        scalar,
        value,
    }
}

fn push_floats<'a, const N: usize, S: Into<String>>(
    columns: &mut Vec<Column<'a>>,
    names: [S; N],
    value: impl Fn(usize, usize) -> f32 + Copy + 'a,
) {
    for (i, name) in names.into_iter().enumerate() {
        let value = move |v| Value::F32(value(v, i));
        columns.push(column(name.into(), "float", value));
    }
}

fn push_custom<'a>(columns: &mut Vec<Column<'a>>, attribute: &'a Attribute) {
    let name = property_name(&attribute.name);
    if attribute.components == 1 {
        columns.push(component(attribute, 0, name));
        return;
    }
    for i in 0..attribute.components {
        columns.push(component(attribute, i, format!("{name}_{i}")));
    }
}

/// A name is one word in PLY.
fn property_name(name: &str) -> String {
    let word = |c: char| {
        if c.is_whitespace() || c.is_control() {
            '_'
        } else {
            c
        }
    };
    match name {
        "" => "unnamed".into(),
        _ => name.chars().map(word).collect(),
    }
}

fn component(attribute: &Attribute, i: usize, name: String) -> Column<'_> {
    let n = attribute.components;
    match &attribute.values {
        AttributeValues::I8(v) => column(name, "char", move |e| Value::I8(v[e * n + i])),
        AttributeValues::U8(v) => column(name, "uchar", move |e| Value::U8(v[e * n + i])),
        AttributeValues::I16(v) => column(name, "short", move |e| Value::I16(v[e * n + i])),
        AttributeValues::U16(v) => column(name, "ushort", move |e| Value::U16(v[e * n + i])),
        AttributeValues::I32(v) => column(name, "int", move |e| Value::I32(v[e * n + i])),
        AttributeValues::U32(v) => column(name, "uint", move |e| Value::U32(v[e * n + i])),
        AttributeValues::F32(v) => column(name, "float", move |e| Value::F32(v[e * n + i])),
        AttributeValues::F64(v) => column(name, "double", move |e| Value::F64(v[e * n + i])),
    }
}

/// The row being written.
pub(crate) struct Row {
    pub encoding: PlyEncoding,
    pub bytes: Vec<u8>,
}

impl Row {
    pub fn push(&mut self, value: Value) {
        match self.encoding {
            PlyEncoding::Ascii => self.push_text(value),
            PlyEncoding::BinaryLittleEndian => match value {
                Value::I8(v) => self.bytes.extend(v.to_le_bytes()),
                Value::U8(v) => self.bytes.extend(v.to_le_bytes()),
                Value::I16(v) => self.bytes.extend(v.to_le_bytes()),
                Value::U16(v) => self.bytes.extend(v.to_le_bytes()),
                Value::I32(v) => self.bytes.extend(v.to_le_bytes()),
                Value::U32(v) => self.bytes.extend(v.to_le_bytes()),
                Value::F32(v) => self.bytes.extend(v.to_le_bytes()),
                Value::F64(v) => self.bytes.extend(v.to_le_bytes()),
            },
            PlyEncoding::BinaryBigEndian => match value {
                Value::I8(v) => self.bytes.extend(v.to_be_bytes()),
                Value::U8(v) => self.bytes.extend(v.to_be_bytes()),
                Value::I16(v) => self.bytes.extend(v.to_be_bytes()),
                Value::U16(v) => self.bytes.extend(v.to_be_bytes()),
                Value::I32(v) => self.bytes.extend(v.to_be_bytes()),
                Value::U32(v) => self.bytes.extend(v.to_be_bytes()),
                Value::F32(v) => self.bytes.extend(v.to_be_bytes()),
                Value::F64(v) => self.bytes.extend(v.to_be_bytes()),
            },
        }
    }

    fn push_text(&mut self, value: Value) {
        if !self.bytes.is_empty() {
            self.bytes.push(b' ');
        }
        let bytes = &mut self.bytes;
        let written = match value {
            Value::I8(v) => write_integer(bytes, v),
            Value::U8(v) => write_integer(bytes, v),
            Value::I16(v) => write_integer(bytes, v),
            Value::U16(v) => write_integer(bytes, v),
            Value::I32(v) => write_integer(bytes, v),
            Value::U32(v) => write_integer(bytes, v),
            Value::F32(v) => write_float(bytes, v),
            Value::F64(v) => write_double(bytes, v),
        };
        debug_assert!(written.is_ok(), "writing to memory cannot fail");
    }

    fn flush(&mut self, sink: &mut Sink<'_>) -> io::Result<()> {
        if self.encoding == PlyEncoding::Ascii {
            self.bytes.push(b'\n');
        }
        sink.write_all(&self.bytes)?;
        self.bytes.clear();
        Ok(())
    }
}
