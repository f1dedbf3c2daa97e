//! The faces and triangle strips of a PLY file.

use super::{
    columns::{Column, Lengths, Table, with_values},
    vertices::{custom, interleave},
};
use crate::{
    Place, Warnings,
    color::FACE_COLOR,
    error::{Error, ErrorKind, Result},
};
use karui::{
    PolyMesh,
    mesh::{Attribute, AttributeValues},
};

/// Names of the list of corners.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// Adds the faces of the table, with their properties as face attributes.
pub(super) fn add_faces(
    mut table: Table,
    mesh: &mut PolyMesh,
    warnings: &mut Warnings,
) -> Result<()> {
    let vertices = mesh.positions.len();
    let corners = take_corners(&mut table, vertices, false)?;
    let lengths = corners.lengths;
    let indices = to_u32(corners.values);
    let rows = table.rows;
    let kept = kept_rows(&lengths, rows);
    let mut attributes = attributes(table, &mut |w| warnings.push(w));
    match kept {
        None => append(mesh, indices, &lengths, rows)?,
        Some(kept) => {
            warnings.push("faces of fewer than 3 corners were passed over");
            append_kept(mesh, &indices, &lengths, &kept)?;
            for attribute in &mut attributes {
                *attribute = attribute.gathered(&kept);
            }
        }
    }
    mesh.face_attributes = attributes;
    Ok(())
}

/// Adds the triangles of strips; -1 starts a new strip.
pub(super) fn add_strips(
    mut table: Table,
    mesh: &mut PolyMesh,
    warnings: &mut Warnings,
) -> Result<()> {
    let vertices = mesh.positions.len();
    let rows = table.rows;
    let corners = take_corners(&mut table, vertices, true)?;
    let indices = to_u32(corners.values);
    let mut first = 0;
    for row in 0..rows {
        let end = first + corners.lengths.get(row);
        for strip in indices[first..end].split(|&v| v == u32::MAX) {
            for (t, w) in strip.windows(3).enumerate() {
                let [a, b, c] = [w[0], w[1], w[2]];
                // Strips repeat a corner to turn; such triangles are empty.
                if a != b && b != c && c != a {
                    let face = if t % 2 == 0 { [a, b, c] } else { [b, a, c] };
                    crate::read::push_face(mesh, &face).map_err(|k| Error::new(Place::File, k))?;
                }
            }
        }
        first = end;
    }
    if !std::mem::take(&mut mesh.face_attributes).is_empty() {
        warnings.push("face properties were passed over because strips have none");
    }
    Ok(())
}

/// The list of corners, every index of which exists.
pub(crate) fn take_corners(
    table: &mut Table,
    vertices: usize,
    allow_restart: bool,
) -> Result<Column> {
    let is_list = |n: &&&str| table.get(n).is_some_and(|c| c.property.list.is_some());
    let Some(name) = CORNERS.iter().find(is_list) else {
        let kind = ErrorKind::syntax("a list `vertex_indices`", "none");
        return Err(Error::new(table.place(0), kind));
    };
    if let Some(column) = table.get(name) {
        check_indices(table, column, vertices, allow_restart)?;
    }
    let missing = || Error::new(Place::File, ErrorKind::syntax("a list", "none"));
    table.take(name).ok_or_else(missing)
}

fn check_indices(
    table: &Table,
    column: &Column,
    vertices: usize,
    allow_restart: bool,
) -> Result<()> {
    if column.property.scalar.is_float() {
        let kind = ErrorKind::unsupported("a vertex index that is not a whole number");
        return Err(Error::new(table.place(0), kind));
    }
    let least = if allow_restart { -1 } else { 0 };
    let bad = |index: i64| index < least || index >= vertices as i64;
    let found = with_values!(&column.values, v, T => {
        v.iter().position(|&i: &T| bad(i as i64)).map(|at| (at, v[at] as i64))
    });
    let Some((at, index)) = found else {
        return Ok(());
    };
    let kind = ErrorKind::IndexOutOfRange {
        what: "vertex",
        index,
        count: vertices,
    };
    Err(Error::new(table.place(row_of(&column.lengths, at)), kind))
}

/// The row that value `at` of a list belongs to.
fn row_of(lengths: &Lengths, at: usize) -> usize {
    match lengths {
        Lengths::Fixed(length) => at / (*length).max(1),
        Lengths::Varying(lengths) => {
            let ends = lengths.iter().scan(0, |end, &l| {
                *end += l as usize;
                Some(*end)
            });
            ends.take_while(|&end| end <= at).count()
        }
    }
}

/// Checked indices; -1 becomes `u32::MAX`.
pub(crate) fn to_u32(values: AttributeValues) -> Vec<u32> {
    if let AttributeValues::U32(values) = values {
        return values;
    }
    with_values!(values, v, T => v.into_iter().map(|i: T| i as i64 as u32).collect())
}

/// The rows of three or more corners, unless all are.
fn kept_rows(lengths: &Lengths, rows: usize) -> Option<Vec<u32>> {
    let kept = |row: &u32| lengths.get(*row as usize) >= 3;
    let all = match lengths {
        Lengths::Fixed(length) => *length >= 3 || rows == 0,
        Lengths::Varying(lengths) => lengths.iter().all(|&l| l >= 3),
    };
    (!all).then(|| (0..rows as u32).filter(kept).collect())
}

/// Appends all faces, the indices in one piece.
fn append(mesh: &mut PolyMesh, indices: Vec<u32>, lengths: &Lengths, rows: usize) -> Result<()> {
    let base = mesh.indices.len();
    let total = base.saturating_add(indices.len());
    crate::read::check_corners(total).map_err(|k| Error::new(Place::File, k))?;
    mesh.offsets.reserve_exact(rows);
    let mut end = base;
    for row in 0..rows {
        end += lengths.get(row);
        mesh.offsets.push(end as u32);
    }
    if base == 0 {
        mesh.indices = indices;
    } else {
        mesh.indices.extend(indices);
    }
    Ok(())
}

fn append_kept(
    mesh: &mut PolyMesh,
    indices: &[u32],
    lengths: &Lengths,
    kept: &[u32],
) -> Result<()> {
    let mut first = 0;
    let mut row = 0;
    for &keep in kept {
        while row < keep as usize {
            first += lengths.get(row);
            row += 1;
        }
        let face = &indices[first..first + lengths.get(row)];
        crate::read::push_face(mesh, face).map_err(|k| Error::new(Place::File, k))?;
    }
    Ok(())
}

fn attributes(mut table: Table, warn: &mut dyn FnMut(String)) -> Vec<Attribute> {
    let mut found = Vec::new();
    found.extend(face_color(&mut table));
    found.extend(custom(table.take_rest(), warn));
    found
}

fn face_color(table: &mut Table) -> Option<Attribute> {
    let kind = |name: &str| {
        let column = table.get(name)?;
        let typed = matches!(
            column.values,
            AttributeValues::U8(_) | AttributeValues::F32(_)
        );
        (typed && column.property.list.is_none()).then_some(column.property.scalar)
    };
    let names = ["red", "green", "blue", "alpha"];
    let kinds = names.map(kind);
    let first = kinds[0]?;
    let components = kinds.iter().take_while(|&&k| k == Some(first)).count();
    if components < 3 {
        return None;
    }
    let columns = names[..components].iter().filter_map(|n| table.take(n));
    Some(Attribute {
        name: FACE_COLOR.into(),
        components,
        values: interleave(columns.map(|c| c.values).collect()),
    })
}
