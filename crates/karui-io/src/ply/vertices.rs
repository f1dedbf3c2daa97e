//! The vertices of a PLY file.

use super::columns::{Column, Lengths, Table, with_values};
use crate::{
    error::{Error, ErrorKind, Result},
    number::unflip,
};
use karui::{
    geom::{Vec2, Vec3, Vec4},
    mesh::{Attribute, AttributeValues, Attributes},
};

/// Names of texture coordinates, without the number of the set.
const UV_NAMES: [[&str; 2]; 4] = [
    ["s", "t"],
    ["u", "v"],
    ["texture_u", "texture_v"],
    ["texture_s", "texture_t"],
];

/// Names of colours, alpha last because it may be missing.
const COLOR_NAMES: [[&str; 4]; 3] = [
    ["red", "green", "blue", "alpha"],
    [
        "diffuse_red",
        "diffuse_green",
        "diffuse_blue",
        "diffuse_alpha",
    ],
    ["r", "g", "b", "a"],
];

/// Sets of texture coordinates and of colours that are looked for.
pub(crate) const SETS: usize = 8;

/// Positions and attributes.
pub(crate) fn build(
    mut table: Table,
    warn: &mut dyn FnMut(String),
) -> Result<(Vec<Vec3>, Attributes)> {
    let Some(positions) = vectors(&mut table, ["x", "y", "z"], "vertex coordinate")? else {
        let kind = ErrorKind::syntax("the properties x, y and z of `vertex`", "not all of them");
        return Err(Error::new(table.place(0), kind));
    };
    let mut attributes = Attributes {
        normals: vectors(&mut table, ["nx", "ny", "nz"], "normal")?,
        tangents: tangents(&mut table)?,
        ..Attributes::default()
    };
    for set in 0..SETS {
        attributes.uvs.extend(uvs(&mut table, set)?);
        attributes.colors.extend(colors(&mut table, set)?);
    }
    attributes.custom = custom(table.take_rest(), warn);
    Ok((positions, attributes))
}

/// Takes columns if all of them are there and are scalars.
fn take<const N: usize>(table: &mut Table, names: [&str; N]) -> Option<[Column; N]> {
    let scalar = |n: &&str| table.get(n).is_some_and(|c| c.property.list.is_none());
    if !names.iter().all(scalar) {
        return None;
    }
    let columns: Option<Vec<_>> = names.into_iter().map(|n| table.take(n)).collect();
    columns?.try_into().ok()
}

/// A column as finite `f32`.
fn finite(table: &Table, column: Column, what: &'static str) -> Result<Vec<f32>> {
    let values = to_f32(column.values);
    match values.iter().position(|v| !v.is_finite()) {
        None => Ok(values),
        Some(row) => Err(Error::new(table.place(row), ErrorKind::NotFinite { what })),
    }
}

#[allow(clippy::unnecessary_cast, reason = "one of the types is f32 already")]
fn to_f32(values: AttributeValues) -> Vec<f32> {
    if let AttributeValues::F32(values) = values {
        return values;
    }
    with_values!(values, v, T => v.into_iter().map(|x: T| x as f32).collect())
}

fn finite_columns<const N: usize>(
    table: &mut Table,
    names: [&str; N],
    what: &'static str,
) -> Result<Option<[Vec<f32>; N]>> {
    let Some(columns) = take(table, names) else {
        return Ok(None);
    };
    let columns: Result<Vec<_>> = columns
        .into_iter()
        .map(|c| finite(table, c, what))
        .collect();
    Ok(columns?.try_into().ok())
}

fn vectors(table: &mut Table, names: [&str; 3], what: &'static str) -> Result<Option<Vec<Vec3>>> {
    let columns = finite_columns(table, names, what)?;
    Ok(columns.map(|[x, y, z]| {
        let pairs = x.into_iter().zip(y).zip(z);
        pairs.map(|((x, y), z)| Vec3::new(x, y, z)).collect()
    }))
}

fn tangents(table: &mut Table) -> Result<Option<Vec<Vec4>>> {
    let columns = finite_columns(table, ["tx", "ty", "tz", "tw"], "tangent")?;
    Ok(columns.map(|columns| interleave4(&columns, |v| v)))
}

fn interleave4(columns: &[Vec<f32>; 4], map: impl Fn(f32) -> f32) -> Vec<Vec4> {
    let [x, y, z, w] = columns;
    let row = |i: usize| Vec4::new(map(x[i]), map(y[i]), map(z[i]), map(w[i]));
    (0..x.len()).map(row).collect()
}

/// Names of set `set`: as they are for the first, else with its number.
fn numbered<const N: usize>(names: [&str; N], set: usize) -> [String; N] {
    names.map(|n| {
        if set == 0 {
            n.to_owned()
        } else {
            format!("{n}{set}")
        }
    })
}

#[allow(clippy::unnecessary_cast, reason = "one of the types is f64 already")]
fn uvs(table: &mut Table, set: usize) -> Result<Option<Vec<Vec2>>> {
    const WHAT: &str = "texture coordinate";
    for names in UV_NAMES {
        let names = numbered(names, set);
        let Some([u, v]) = take(table, [&names[0], &names[1]]) else {
            continue;
        };
        // Turned in double precision, see `flip`.
        let turned = with_values!(v.values, v, T => {
            v.into_iter().map(|x: T| unflip(x as f64)).collect()
        });
        let v = Column {
            values: AttributeValues::F32(turned),
            ..v
        };
        let u = finite(table, u, WHAT)?;
        let v = finite(table, v, WHAT)?;
        let pairs = u.into_iter().zip(v);
        return Ok(Some(pairs.map(|(u, v)| Vec2::new(u, v)).collect()));
    }
    Ok(None)
}

fn colors(table: &mut Table, set: usize) -> Result<Option<Vec<Vec4>>> {
    for names in COLOR_NAMES {
        let [r, g, b, a] = numbered(names, set);
        let typed = |n: &String| table.get(n).and_then(|c| full_scale(&c.values));
        let Some(scale) = typed(&r) else {
            continue;
        };
        if [&g, &b].map(typed) != [Some(scale); 2] {
            continue;
        }
        let has_alpha = typed(&a) == Some(scale);
        let Some([r, g, b]) = finite_columns(table, [&r, &g, &b], "colour")? else {
            continue;
        };
        let alpha = if has_alpha {
            finite_columns(table, [&a], "colour")?
        } else {
            None
        };
        let [a] = alpha.unwrap_or_else(|| [vec![scale; r.len()]]);
        return Ok(Some(interleave4(&[r, g, b, a], |c| c / scale)));
    }
    Ok(None)
}

/// The value that means full colour, for types that colours come in.
fn full_scale(values: &AttributeValues) -> Option<f32> {
    match values {
        AttributeValues::U8(_) => Some(255.0),
        AttributeValues::U16(_) => Some(65535.0),
        AttributeValues::F32(_) | AttributeValues::F64(_) => Some(1.0),
        _ => None,
    }
}

/// Everything else by name and type. Columns `name_0`, `name_1`, ... of one
/// type that follow each other become one attribute.
pub(super) fn custom(columns: Vec<Column>, warn: &mut dyn FnMut(String)) -> Vec<Attribute> {
    let mut found: Vec<Attribute> = Vec::new();
    let mut columns = columns.into_iter().peekable();
    while let Some(column) = columns.next() {
        let Lengths::Fixed(components @ 1..) = column.lengths else {
            let name = &column.property.name;
            warn(format!("lists of varying length `{name}` were passed over"));
            continue;
        };
        let Some(stem) = stem(&column, 0) else {
            found.push(Attribute {
                name: column.property.name,
                components,
                values: column.values,
            });
            continue;
        };
        let kind = (column.property.scalar, column.property.list);
        let mut parts = vec![column.values];
        while let Some(next) = columns.next_if(|c| {
            (c.property.scalar, c.property.list) == kind
                && self::stem(c, parts.len()).as_ref() == Some(&stem)
        }) {
            parts.push(next.values);
        }
        let components = parts.len();
        let name = if components == 1 {
            stem.clone() + "_0"
        } else {
            stem
        };
        found.push(Attribute {
            name,
            components,
            values: interleave(parts),
        });
    }
    found
}

/// `name` if the column is the scalar `name_<i>`.
fn stem(column: &Column, i: usize) -> Option<String> {
    let stem = column.property.name.strip_suffix(&format!("_{i}"))?;
    (column.property.list.is_none() && !stem.is_empty()).then(|| stem.to_owned())
}

/// Values of columns of one type and length, row after row.
pub(super) fn interleave(mut parts: Vec<AttributeValues>) -> AttributeValues {
    if parts.len() == 1 {
        return parts.swap_remove(0);
    }
    let mut first = parts[0].empty_like();
    with_values!(&mut first, joined, T => {
        let columns: Vec<Vec<T>> = parts.into_iter().filter_map(typed::<T>).collect();
        let rows = columns.iter().map(Vec::len).min().unwrap_or(0);
        joined.reserve_exact(rows * columns.len());
        for row in 0..rows {
            joined.extend(columns.iter().map(|c| c[row]));
        }
    });
    first
}

fn typed<T: 'static>(values: AttributeValues) -> Option<Vec<T>> {
    let boxed: Box<dyn std::any::Any> = with_values!(values, v, T => Box::<Vec<T>>::new(v));
    boxed.downcast().ok().map(|v| *v)
}
