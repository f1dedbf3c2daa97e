//! Numpy arrays in and out.
//!
//! In, an array is copied once, since a mesh must not change while it is worked on. Out,
//! numpy is shown the mesh's own memory through its array interface protocol: nothing is
//! copied, the array is read-only and keeps the mesh alive.

use crate::errors::{InputError, input_error};
use bytemuck::{NoUninit, Pod, cast_slice};
use numpy::{Element, PyArray1, PyArrayDescrMethods, PyArrayMethods, PyReadonlyArrayDyn};
use numpy::{PyUntypedArray, PyUntypedArrayMethods, dtype};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::{any::Any, sync::Arc};

/// Anything that numpy makes an array of.
pub fn array<'py>(what: &str, given: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyUntypedArray>> {
    let made = given
        .py()
        .import("numpy")?
        .call_method1("asarray", (given,));
    let refused = |e: PyErr| InputError::new_err(format!("`{what}` is no array: {e}"));
    Ok(made.map_err(refused)?.cast_into()?)
}

/// Values of an array in rows of `columns`; 0 stands for an array of one dimension.
fn values<'py, T: Element>(
    what: &str,
    array: &Bound<'py, PyUntypedArray>,
    columns: usize,
) -> PyResult<PyReadonlyArrayDyn<'py, T>> {
    let fits = match (array.shape(), columns) {
        ([_], 0) => true,
        ([_, found], columns) => *found == columns && columns > 0,
        _ => false,
    };
    if !fits {
        let expected = match columns {
            0 => "(n,)".to_owned(),
            _ => format!("(n, {columns})"),
        };
        let found = format!("of shape {:?}", array.shape());
        return Err(input_error(what, &found, &format!("of shape {expected}")));
    }
    let py = array.py();
    let contiguous = (array, dtype::<T>(py));
    let made = py
        .import("numpy")?
        .call_method1("ascontiguousarray", contiguous)?;
    made.extract()
}

fn must_be(
    what: &str,
    array: &Bound<'_, PyUntypedArray>,
    kinds: &[u8],
    expected: &str,
) -> PyResult<()> {
    match kinds.contains(&array.dtype().kind()) {
        true => Ok(()),
        false => Err(input_error(
            what,
            &format!("of type {}", array.dtype()),
            expected,
        )),
    }
}

/// Vectors of `columns` numbers of 32 bits; of integers and of wider numbers, too.
pub fn floats<T: Pod>(what: &str, given: &Bound<'_, PyAny>, columns: usize) -> PyResult<Vec<T>> {
    let array = array(what, given)?;
    must_be(what, &array, b"fiub", "of numbers")?;
    let values = values::<f32>(what, &array, columns)?;
    let slice = values
        .as_slice()
        .map_err(|e| InputError::new_err(e.to_string()))?;
    Ok(cast_slice(slice).to_vec())
}

/// One number a vertex, if any are given.
pub fn scalars(what: &str, given: Option<&Bound<'_, PyAny>>) -> PyResult<Option<Vec<f32>>> {
    given.map(|given| floats(what, given, 0)).transpose()
}

/// One truth value a vertex, if any are given.
pub fn flags(what: &str, given: Option<&Bound<'_, PyAny>>) -> PyResult<Option<Vec<bool>>> {
    let Some(given) = given else { return Ok(None) };
    let array = array(what, given)?;
    must_be(what, &array, b"b", "of type bool")?;
    let values = values::<bool>(what, &array, 0)?;
    Ok(Some(values.as_array().iter().copied().collect()))
}

/// `count` numbers: those given, or the one given for all.
pub fn repeated(what: &str, given: &Bound<'_, PyAny>, count: usize) -> PyResult<Vec<f32>> {
    if array(what, given)?.ndim() == 0 {
        return Ok(vec![given.extract()?; count]);
    }
    let all: Vec<f32> = floats(what, given, 0)?;
    match all.len() == count {
        true => Ok(all),
        false => {
            let found = format!("of {} numbers", all.len());
            Err(input_error(
                what,
                &found,
                &format!("one number, or {count}"),
            ))
        }
    }
}

/// Triples of vertex numbers, of any integer type.
pub fn triangles(given: &Bound<'_, PyAny>) -> PyResult<Vec<[u32; 3]>> {
    indices("triangles", given, 3)
}

/// Numbers of vertices or the like, of any integer type, in rows of `columns`; 0 stands for an
/// array of one dimension.
pub fn indices<T: Pod>(what: &str, given: &Bound<'_, PyAny>, columns: usize) -> PyResult<Vec<T>> {
    let array = array(what, given)?;
    if array.len() > 0 {
        must_be(what, &array, b"iu", "of integers")?;
    }
    if array.dtype().is_equiv_to(&dtype::<u32>(given.py())) {
        let values = values::<u32>(what, &array, columns)?;
        let slice = values
            .as_slice()
            .map_err(|e| InputError::new_err(e.to_string()))?;
        return Ok(cast_slice(slice).to_vec());
    }
    let values = values::<i64>(what, &array, columns)?;
    let narrow = |&wide: &i64| {
        u32::try_from(wide)
            .map_err(|_| input_error(what, &format!("{wide} somewhere"), "0 or more"))
    };
    let all: Vec<u32> = values
        .as_array()
        .iter()
        .map(narrow)
        .collect::<PyResult<_>>()?;
    Ok(cast_slice(&all).to_vec())
}

/// Faces of any number of corners, as rows of an array or as sequences, one each: the corners of
/// all, and where each begins.
pub fn faces(given: &Bound<'_, PyAny>) -> PyResult<(Vec<u32>, Vec<u32>)> {
    let what = "faces";
    let (corners, sizes): (Vec<u32>, Vec<usize>) = match given.cast::<PyUntypedArray>() {
        Ok(array) if array.ndim() == 2 => {
            let [rows, columns] = [array.shape()[0], array.shape()[1]];
            // Without columns it is refused by its shape.
            (indices(what, given, columns.max(1))?, vec![columns; rows])
        }
        _ => {
            let refused = |e: PyErr| {
                let expected = "a sequence of sequences of vertex numbers";
                InputError::new_err(format!("`{what}` must be {expected}: {e}"))
            };
            let all: Vec<Vec<u32>> = given.extract().map_err(refused)?;
            let sizes = all.iter().map(Vec::len).collect();
            (all.concat(), sizes)
        }
    };
    if u32::try_from(corners.len()).is_err() {
        let found = format!("of {} corners in all", corners.len());
        return Err(input_error(what, &found, "of fewer than 2^32"));
    }
    let mut end = 0;
    let ends = sizes.iter().map(|&size| {
        end += size as u32;
        end
    });
    Ok((corners, std::iter::once(0).chain(ends).collect()))
}

/// Values of their own type, and how many there are to an element.
pub fn custom(what: &str, given: &Bound<'_, PyAny>) -> PyResult<karui::mesh::Attribute> {
    use karui::mesh::AttributeValues as V;
    let array = array(what, given)?;
    let columns = match *array.shape() {
        [_, columns] => columns,
        _ => 0,
    };
    macro_rules! typed {
        ($($kind:literal $bytes:literal $variant:ident,)*) => {
            match (array.dtype().kind(), array.dtype().itemsize()) {
                $(($kind, $bytes) => {
                    let values = values(what, &array, columns)?;
                    V::$variant(values.as_array().iter().copied().collect())
                })*
                _ => {
                    let found = format!("of type {}", array.dtype());
                    let expected = "of float32, float64 or integers of up to 32 bits";
                    return Err(input_error(what, &found, expected));
                }
            }
        };
    }
    let values = typed!(
        b'i' 1 I8, b'u' 1 U8, b'i' 2 I16, b'u' 2 U16, b'i' 4 I32, b'u' 4 U32, b'f' 4 F32, b'f' 8 F64,
    );
    Ok(karui::mesh::Attribute {
        name: what.into(),
        components: columns.max(1),
        values,
    })
}

/// Part of an object's memory, for numpy: it takes the array interface and keeps this object.
#[pyclass(frozen, module = "karui")]
struct View {
    _owner: Arc<dyn Any + Send + Sync>,
    pointer: usize,
    shape: Vec<usize>,
    format: Py<PyAny>,
}

#[pymethods]
impl View {
    #[getter(__array_interface__)]
    fn array_interface<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let interface = PyDict::new(py);
        interface.set_item("version", 3)?;
        interface.set_item("shape", pyo3::types::PyTuple::new(py, &self.shape)?)?;
        interface.set_item("typestr", &self.format)?;
        let read_only = true;
        interface.set_item("data", (self.pointer, read_only))?;
        Ok(interface)
    }
}

/// A read-only array over memory of `owner`, a mesh or the like: rows of `columns`, or of one
/// dimension if 0.
pub fn view<'py, S, T, O>(
    py: Python<'py>,
    owner: &Arc<O>,
    columns: usize,
    part: impl FnOnce(&O) -> &[T],
) -> PyResult<Bound<'py, PyAny>>
where
    S: Element + NoUninit + Pod,
    T: NoUninit,
    O: Any + Send + Sync,
{
    let scalars: &[S] = cast_slice(part(owner));
    let rows = scalars.len() / columns.max(1);
    let shape = match columns {
        0 => vec![rows],
        columns => vec![rows, columns],
    };
    let view = View {
        pointer: scalars.as_ptr().expose_provenance(),
        shape,
        format: dtype::<S>(py).getattr("str")?.unbind(),
        _owner: Arc::<O>::clone(owner),
    };
    py.import("numpy")?.call_method1("asarray", (view,))
}

/// An array that takes rows over, without a copy.
pub fn owned<T: Element, const N: usize>(
    py: Python<'_>,
    rows: Vec<[T; N]>,
) -> PyResult<Bound<'_, PyAny>> {
    let shape = [rows.len(), N];
    let flat = PyArray1::from_vec(py, rows.into_flattened());
    Ok(flat.reshape(shape)?.into_any())
}
