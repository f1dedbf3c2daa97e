//! Reading PLY.

use super::{
    columns::{Body, Table, read_ascii, read_binary},
    faces,
    header::{self, Element, Encoding},
    vertices,
};
use crate::{
    Place,
    error::{Error, ErrorKind, Result},
    source::Source,
    text::Lines,
};
use karui::PolyMesh;

/// Reads the polygons and strips with all properties of vertices and faces.
/// Other elements are passed over with a warning.
pub(crate) fn read(source: &mut Source<'_>) -> Result<PolyMesh> {
    let mut lines = Lines::new(source.bytes);
    let header = header::read(&mut lines)?;
    let mut body = Body {
        bytes: source.bytes,
        at: source.bytes.len() - lines.rest().len(),
        encoding: header.encoding,
    };
    let mut tables = Vec::new();
    for element in header.elements {
        let table = match header.encoding {
            Encoding::Ascii => read_ascii(&element, &mut lines, &mut source.warnings)?,
            _ => read_binary(&element, &mut body)?,
        };
        tables.push((element, table));
    }
    build(tables, source)
}

fn build(tables: Vec<(Element, Table)>, source: &mut Source<'_>) -> Result<PolyMesh> {
    let warnings = &mut source.warnings;
    let mut mesh = PolyMesh::default();
    let (vertex, others): (Vec<_>, Vec<_>) =
        tables.into_iter().partition(|(e, _)| e.name == "vertex");
    let Some((element, table)) = vertex.into_iter().next() else {
        let kind = ErrorKind::syntax("an element `vertex`", "none");
        return Err(Error::new(Place::File, kind));
    };
    if element.count > u32::MAX as usize {
        let kind = ErrorKind::TooLarge {
            what: "vertices",
            found: element.count as u64,
            limit: u64::from(u32::MAX),
        };
        return Err(Error::new(Place::File, kind));
    }
    (mesh.positions, mesh.attributes) = vertices::build(table, &mut |w| warnings.push(w))?;
    let mut has_faces = false;
    for (element, table) in others {
        match element.name.as_str() {
            "face" if table.rows > 0 && !has_faces => {
                has_faces = true;
                faces::add_faces(table, &mut mesh, warnings)?;
            }
            "face" if table.rows == 0 => {}
            "tristrips" => faces::add_strips(table, &mut mesh, warnings)?,
            name => warnings.push(format!("element `{name}` was passed over")),
        }
    }
    if mesh.face_count() == 0 {
        warnings.push("the file holds points but no faces");
    }
    Ok(mesh)
}
