//! Vertex attributes as arrays: floats, or integers where those hold the same
//! values or quantisation is asked for.

use super::{
    accessor::{Component, Kind},
    pack::Array,
};
use glam::Vec3;
use serde_json::{Value, json};

/// An array of vectors of one component type, each padded to a multiple of 4
/// bytes, as vertex attributes have to be.
fn array<const N: usize, const S: usize>(
    component: Component,
    values: impl ExactSizeIterator<Item = [[u8; S]; N]>,
) -> Array {
    let stride = (N * S).next_multiple_of(4);
    let count = values.len();
    let mut bytes = Vec::with_capacity(count * stride);
    for value in values {
        bytes.extend_from_slice(value.as_flattened());
        bytes.resize(bytes.len().next_multiple_of(4), 0);
    }
    Array {
        component,
        kind: kind(N),
        normalized: false,
        count,
        stride,
        bytes,
        range: None,
    }
}

fn kind(components: usize) -> Kind {
    match components {
        1 => Kind::Scalar,
        2 => Kind::Vec2,
        3 => Kind::Vec3,
        _ => Kind::Vec4,
    }
}

fn normalized(array: Array) -> Array {
    Array {
        normalized: true,
        ..array
    }
}

/// 32-bit floats.
pub(super) fn floats<const N: usize>(values: impl ExactSizeIterator<Item = [f32; N]>) -> Array {
    array(Component::F32, values.map(|v| v.map(f32::to_le_bytes)))
}

/// Positions or their differences, with their range.
pub(super) fn positions(values: &[Vec3]) -> Array {
    Array {
        range: Some(range(values.iter().map(|v| v.to_array()))),
        ..floats(values.iter().map(|v| v.to_array()))
    }
}

/// Least and greatest value of each component.
pub(super) fn range<const N: usize, T>(values: impl Iterator<Item = [T; N]>) -> [Vec<Value>; 2]
where
    T: PartialOrd + Copy + Into<Value>,
{
    let mut bounds: Option<[[T; N]; 2]> = None;
    for value in values {
        let [low, high] = bounds.get_or_insert([value, value]);
        for c in 0..N {
            if value[c] < low[c] {
                low[c] = value[c];
            }
            if value[c] > high[c] {
                high[c] = value[c];
            }
        }
    }
    bounds.map_or([Vec::new(), Vec::new()], |b| {
        b.map(|bound| bound.into_iter().map(Into::into).collect())
    })
}

/// A value in 0..1 as an integer up to `full`.
fn quantum(value: f32, full: f32) -> f32 {
    (value.clamp(0.0, 1.0) * full).round()
}

/// Whether integers up to `full` hold the values without loss.
fn exact<const N: usize>(values: &[[f32; N]], full: f32) -> bool {
    let values = values.as_flattened().iter();
    values.clone().all(|&v| quantum(v, full) / full == v)
}

fn unorm8<const N: usize>(values: &[[f32; N]]) -> Array {
    let bytes = values.iter().map(|v| v.map(|f| [quantum(f, 255.0) as u8]));
    normalized(array(Component::U8, bytes))
}

fn unorm16<const N: usize>(values: &[[f32; N]]) -> Array {
    let words = values
        .iter()
        .map(|v| v.map(|f| (quantum(f, 65535.0) as u16).to_le_bytes()));
    normalized(array(Component::U16, words))
}

/// Unit vectors, or differences of at most 1, as signed bytes.
pub(super) fn signed_bytes<const N: usize>(
    values: impl ExactSizeIterator<Item = [f32; N]>,
) -> Array {
    let byte = |f: f32| [(f.clamp(-1.0, 1.0) * 127.0).round() as i8 as u8];
    normalized(array(Component::I8, values.map(|v| v.map(byte))))
}

/// Colours: bytes or 16 bits if these hold them without loss or, for bytes, if
/// `lossy` is allowed.
pub(super) fn colors(values: &[[f32; 4]], lossy: bool) -> Array {
    let in_range = |v: &f32| (0.0..=1.0).contains(v);
    let fit = values.as_flattened().iter().all(in_range);
    if fit && (lossy || exact(values, 255.0)) {
        unorm8(values)
    } else if fit && exact(values, 65535.0) {
        unorm16(values)
    } else {
        floats(values.iter().copied())
    }
}

/// Texture coordinates: 16 bits if these hold them without loss and the file
/// had them so (`wanted`), or if `lossy` is allowed and all lie in 0..1.
pub(super) fn uvs(values: &[[f32; 2]], wanted: Option<Component>, lossy: bool) -> Array {
    match wanted {
        Some(Component::U8) if exact(values, 255.0) => return unorm8(values),
        Some(Component::U16) if exact(values, 65535.0) => return unorm16(values),
        _ => {}
    }
    let in_range = |v: &f32| (0.0..=1.0).contains(v);
    if lossy && values.as_flattened().iter().all(in_range) {
        unorm16(values)
    } else {
        floats(values.iter().copied())
    }
}

/// Joint indices in the smallest type that holds them.
pub(super) fn joints(values: &[[u16; 4]]) -> Array {
    if values.as_flattened().iter().all(|&j| j < 256) {
        array(Component::U8, values.iter().map(|v| v.map(|j| [j as u8])))
    } else {
        array(
            Component::U16,
            values.iter().map(|v| v.map(u16::to_le_bytes)),
        )
    }
}

/// Weights of one vertex over all its sets as bytes that sum to 255: rounded
/// down, the rest going to those that lose most.
pub(super) fn weight_bytes(weights: &[f32]) -> Vec<u8> {
    let total: f32 = weights.iter().sum();
    if total <= 0.0 {
        return vec![0; weights.len()];
    }
    let scaled: Vec<f32> = weights.iter().map(|w| w / total * 255.0).collect();
    let mut bytes: Vec<u8> = scaled.iter().map(|s| s.floor() as u8).collect();
    let given: usize = bytes.iter().map(|&b| usize::from(b)).sum();
    let mut order: Vec<usize> = (0..weights.len()).collect();
    order.sort_by(|&a, &b| scaled[b].fract().total_cmp(&scaled[a].fract()));
    for &i in order.iter().take(255usize.saturating_sub(given)) {
        bytes[i] = bytes[i].saturating_add(1);
    }
    bytes
}

/// Bytes that stand for weights, already normalised.
pub(super) fn weights8(values: impl ExactSizeIterator<Item = [u8; 4]>) -> Array {
    normalized(array(Component::U8, values.map(|v| v.map(|b| [b]))))
}

/// Unnormalised 16-bit integers, with their range.
pub(super) fn grid_positions(values: &[[u16; 3]]) -> Array {
    let words = values.iter().map(|v| v.map(u16::to_le_bytes));
    Array {
        range: Some(range(values.iter().copied())),
        ..array(Component::U16, words)
    }
}

/// Unnormalised signed 16-bit integers, with their range.
pub(super) fn grid_differences(values: &[[i16; 3]]) -> Array {
    let words = values.iter().map(|v| v.map(i16::to_le_bytes));
    Array {
        range: Some(range(values.iter().copied())),
        ..array(Component::I16, words)
    }
}

/// Vertex indices in 16 bits if they fit, otherwise in 32: GPUs of today have
/// no 8-bit indices. The greatest value of a type restarts a primitive and so
/// is not used.
pub(super) fn indices(values: &[u32], vertices: usize) -> Array {
    let narrow = vertices <= usize::from(u16::MAX);
    let size = if narrow { 2 } else { 4 };
    let bytes = values.iter().map(|v| v.to_le_bytes());
    Array {
        component: if narrow {
            Component::U16
        } else {
            Component::U32
        },
        kind: Kind::Scalar,
        normalized: false,
        count: values.len(),
        stride: size,
        bytes: bytes.flat_map(|b| b.into_iter().take(size)).collect(),
        range: None,
    }
}

/// Scalars or vectors of any type as a vertex attribute. `None` if there are
/// more than four components.
pub(super) fn custom<const S: usize>(
    component: Component,
    components: usize,
    values: impl ExactSizeIterator<Item = [u8; S]>,
) -> Option<Array> {
    let values: Vec<[u8; S]> = values.collect();
    Some(match components {
        1 => array(component, values.as_chunks::<1>().0.iter().copied()),
        2 => array(component, values.as_chunks::<2>().0.iter().copied()),
        3 => array(component, values.as_chunks::<3>().0.iter().copied()),
        4 => array(component, values.as_chunks::<4>().0.iter().copied()),
        _ => return None,
    })
}

/// A number in JSON that reads back as the same `f32`, in its shortest form.
pub(super) fn short(value: f32) -> Value {
    json!(value.to_string().parse::<f64>().unwrap_or(f64::from(value)))
}

/// [`short`] for each of several numbers.
pub(super) fn shorts(values: &[f32]) -> Value {
    values.iter().map(|&v| short(v)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn elements_are_padded_to_four_bytes() {
        let array = joints(&[[1, 2, 3, 4]]);
        assert_eq!((array.stride, &array.bytes[..]), (4, &[1, 2, 3, 4][..]));
        let normals = signed_bytes([[0.0, 1.0, -1.0]].into_iter());
        assert_eq!(normals.bytes, [0, 127, 129, 0]);
        let ids = custom(Component::U8, 1, [[7], [8]].into_iter()).unwrap();
        assert_eq!(ids.bytes, [7, 0, 0, 0, 8, 0, 0, 0]);
    }

    #[test]
    fn colors_take_the_smallest_exact_type() {
        let bytes = [[0.0, 1.0, 128.0 / 255.0, 1.0]];
        assert_eq!(colors(&bytes, false).component, Component::U8);
        let words = [[0.0, 1.0, 129.0 / 65535.0, 1.0]];
        assert_eq!(colors(&words, false).component, Component::U16);
        assert_eq!(colors(&[[0.1; 4]], false).component, Component::F32);
        assert_eq!(colors(&[[0.1; 4]], true).component, Component::U8);
        assert_eq!(colors(&[[1.5; 4]], true).component, Component::F32);
    }

    #[test]
    fn the_restart_value_is_not_an_index() {
        assert_eq!(indices(&[65534], 65535).component, Component::U16);
        assert_eq!(indices(&[65535], 65536).component, Component::U32);
    }

    proptest! {
        #[test]
        fn weights_sum_to_255(weights in prop::collection::vec(0f32..1.0, 1..9)) {
            let bytes = weight_bytes(&weights);
            let sum: u32 = bytes.iter().map(|&b| u32::from(b)).sum();
            let total: f32 = weights.iter().sum();
            prop_assert_eq!(sum, if total > 0.0 { 255 } else { 0 });
            for (b, w) in bytes.iter().zip(&weights) {
                prop_assert!((f32::from(*b) - w / total.max(1e-30) * 255.0).abs() <= 1.0 + 1e-3);
            }
        }

        #[test]
        fn short_numbers_read_back(bits: u32) {
            let value = f32::from_bits(bits);
            prop_assume!(value.is_finite());
            prop_assert_eq!(short(value).as_f64().unwrap() as f32, value);
        }
    }
}
