//! What a vertex carries, by the names that glTF has for it.

use crate::arrays::{custom, floats, view};
use crate::errors::InputError;
use karui::mesh::{Attribute, AttributeValues, Attributes, SkinWeights};
use karui::{PolyMesh, TriMesh};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::{any::Any, sync::Arc};

/// What has attributes of vertices.
pub trait Carrier: Any + Send + Sync {
    /// Those.
    fn attributes(&self) -> &Attributes;
}

impl Carrier for TriMesh {
    fn attributes(&self) -> &Attributes {
        &self.attributes
    }
}

impl Carrier for PolyMesh {
    fn attributes(&self) -> &Attributes {
        &self.attributes
    }
}

/// `TEXCOORD_1` is set 1 of `TEXCOORD`.
fn set_of(name: &str) -> Option<(&str, usize)> {
    let (kind, set) = name.rsplit_once('_')?;
    Some((kind, set.parse().ok()?))
}

/// Adds an attribute to a mesh: a set of glTF's must be the next of its kind.
pub fn add(mesh: &mut TriMesh, name: &str, given: &Bound<'_, PyAny>) -> PyResult<()> {
    let attributes = &mut mesh.attributes;
    match (name, set_of(name)) {
        ("NORMAL", _) => attributes.normals = Some(floats(name, given, 3)?),
        ("TANGENT", _) => attributes.tangents = Some(floats(name, given, 4)?),
        (_, Some(("TEXCOORD", set))) => {
            next(name, set, attributes.uvs.len())?;
            attributes.uvs.push(floats(name, given, 2)?);
        }
        (_, Some(("COLOR", set))) => {
            next(name, set, attributes.colors.len())?;
            attributes.colors.push(floats(name, given, 4)?);
        }
        (_, Some(("JOINTS" | "WEIGHTS", _))) => {
            let said = format!("`{name}`: skins can be read from files only");
            return Err(InputError::new_err(said));
        }
        _ => attributes.custom.push(custom(name, given)?),
    }
    Ok(())
}

fn next(name: &str, set: usize, there: usize) -> PyResult<()> {
    match set == there {
        true => Ok(()),
        false => Err(InputError::new_err(format!(
            "`{name}` comes after {there} sets of its kind: sets are numbered from 0, none twice"
        ))),
    }
}

/// All attributes of the vertices, by name.
pub fn dictionary<'py>(py: Python<'py>, mesh: &Arc<TriMesh>) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    if let Some(normals) = normals(py, mesh)? {
        all.set_item("NORMAL", normals)?;
    }
    if mesh.attributes.tangents.is_some() {
        let tangents = view::<f32, _, _>(py, mesh, 4, |m| {
            m.attributes.tangents.as_deref().unwrap_or_default()
        });
        all.set_item("TANGENT", tangents?)?;
    }
    for set in 0..mesh.attributes.uvs.len() {
        all.set_item(format!("TEXCOORD_{set}"), uvs(py, mesh, set)?)?;
    }
    for set in 0..mesh.attributes.colors.len() {
        all.set_item(format!("COLOR_{set}"), colors(py, mesh, set)?)?;
    }
    for (set, skin) in mesh.attributes.skins.iter().enumerate() {
        let [joints, weights] = skins(py, skin)?;
        all.set_item(format!("JOINTS_{set}"), joints)?;
        all.set_item(format!("WEIGHTS_{set}"), weights)?;
    }
    for (i, attribute) in mesh.attributes.custom.iter().enumerate() {
        let values = of_any_type(py, mesh, |m| &m.attributes.custom[i])?;
        all.set_item(&attribute.name, values)?;
    }
    Ok(all)
}

/// Attributes of the triangles, by name.
pub fn face_dictionary<'py>(py: Python<'py>, mesh: &Arc<TriMesh>) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    for (i, attribute) in mesh.face_attributes.iter().enumerate() {
        let values = of_any_type(py, mesh, |m| &m.face_attributes[i])?;
        all.set_item(&attribute.name, values)?;
    }
    Ok(all)
}

type Array<'py> = Option<Bound<'py, PyAny>>;

/// Normals, if there are any.
pub fn normals<'py>(py: Python<'py>, mesh: &Arc<impl Carrier>) -> PyResult<Array<'py>> {
    if mesh.attributes().normals.is_none() {
        return Ok(None);
    }
    view::<f32, _, _>(py, mesh, 3, |m| {
        m.attributes().normals.as_deref().unwrap_or_default()
    })
    .map(Some)
}

/// One set of texture coordinates, if it is there.
pub fn uvs<'py>(py: Python<'py>, mesh: &Arc<impl Carrier>, set: usize) -> PyResult<Array<'py>> {
    if set >= mesh.attributes().uvs.len() {
        return Ok(None);
    }
    view::<f32, _, _>(py, mesh, 2, |m| &m.attributes().uvs[set]).map(Some)
}

/// One set of colours, if it is there.
pub fn colors<'py>(py: Python<'py>, mesh: &Arc<impl Carrier>, set: usize) -> PyResult<Array<'py>> {
    if set >= mesh.attributes().colors.len() {
        return Ok(None);
    }
    view::<f32, _, _>(py, mesh, 4, |m| &m.attributes().colors[set]).map(Some)
}

/// Joints and weights, copied: they lie between each other.
fn skins<'py>(py: Python<'py>, skin: &[SkinWeights]) -> PyResult<[Bound<'py, PyAny>; 2]> {
    let joints: Vec<u16> = skin.iter().flat_map(|s| s.joints).collect();
    let weights: Vec<f32> = skin.iter().flat_map(|s| s.weights).collect();
    let shape = [skin.len(), 4];
    Ok([
        PyArray1::from_vec(py, joints).reshape(shape)?.into_any(),
        PyArray1::from_vec(py, weights).reshape(shape)?.into_any(),
    ])
}

fn of_any_type<'py>(
    py: Python<'py>,
    mesh: &Arc<TriMesh>,
    attribute: impl Fn(&TriMesh) -> &Attribute,
) -> PyResult<Bound<'py, PyAny>> {
    let columns = match attribute(mesh).components {
        1 => 0,
        columns => columns,
    };
    macro_rules! typed {
        ($($variant:ident $scalar:ty,)*) => {
            match &attribute(mesh).values {
                $(AttributeValues::$variant(_) => view::<$scalar, _, _>(py, mesh, columns, |m| {
                    match &attribute(m).values {
                        AttributeValues::$variant(values) => values,
                        _ => &[],
                    }
                }),)*
            }
        };
    }
    typed!(I8 i8, U8 u8, I16 i16, U16 u16, I32 i32, U32 u32, F32 f32, F64 f64,)
}
