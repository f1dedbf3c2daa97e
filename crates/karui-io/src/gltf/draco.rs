//! `KHR_draco_mesh_compression`, decoded by the crate `draco-core`.

use super::{
    accessor::{Component, Elements, Layout},
    budget::Budget,
    document::Document,
    json::{self, At},
};
use crate::error::{Error, ErrorKind, Result};
use draco_core::{
    decode_limits::DecodeLimits,
    decoder_buffer::DecoderBuffer,
    draco_types::DataType,
    geometry_attribute::PointAttribute,
    geometry_indices::{FaceIndex, PointIndex},
    mesh::Mesh,
    mesh_decoder::MeshDecoder,
};
use serde_json::Value;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Name of the extension.
pub(super) const DRACO: &str = "KHR_draco_mesh_compression";

/// Share of the memory left that the decoder's output may take; its working
/// memory is several times that.
const SHARE: u64 = 4;

/// A decoded primitive.
pub(super) struct Decoded {
    mesh: Mesh,
    /// Corners of all triangles.
    pub indices: Vec<u32>,
}

impl Document {
    /// Decodes the primitive whose extension object is `compressed`.
    pub fn decode_draco(
        &self,
        compressed: &Value,
        budget: &Budget,
        at: &At<'_>,
    ) -> Result<Decoded> {
        let views = self.view_count();
        let Some(view) = json::index(compressed, "bufferView", views, "bufferView", at)? else {
            return Err(at.syntax("`bufferView`", "none"));
        };
        let mesh = decode(self.view(view), budget).map_err(|kind| at.fail(kind))?;
        let points = mesh.num_points();
        let mut indices = Vec::with_capacity(mesh.num_faces() * 3);
        for face in 0..mesh.num_faces() {
            let corners = mesh.face(FaceIndex(face as u32)).map(|PointIndex(p)| p);
            if let Some(&worst) = corners.iter().find(|&&p| p as usize >= points) {
                return Err(at.fail(ErrorKind::IndexOutOfRange {
                    what: "point",
                    index: i64::from(worst),
                    count: points,
                }));
            }
            indices.extend(corners);
        }
        Ok(Decoded { mesh, indices })
    }
}

fn decode(bytes: &[u8], budget: &Budget) -> Result<Mesh, ErrorKind> {
    let allowed = budget.left() / SHARE;
    let mut limits = DecodeLimits::default();
    limits.max_points = limits.max_points.min(allowed / 12);
    limits.max_faces = limits.max_faces.min(allowed / 12);
    limits.max_decoded_bytes = limits.max_decoded_bytes.min(allowed);
    // The decoder is not ours and works on data from anywhere: should it ever
    // panic, that is an error of this one file.
    let attempt = catch_unwind(AssertUnwindSafe(|| {
        let mut mesh = Mesh::new();
        let mut buffer = DecoderBuffer::new(bytes).with_limits(limits);
        MeshDecoder::new()
            .decode(&mut buffer, &mut mesh)
            .map(|()| mesh)
    }));
    match attempt {
        Ok(Ok(mesh)) => Ok(mesh),
        Ok(Err(error)) => Err(ErrorKind::syntax("a Draco mesh", error.to_string())),
        Err(_) => Err(ErrorKind::syntax(
            "a Draco mesh",
            "data that the decoder fails on",
        )),
    }
}

impl Decoded {
    /// Number of vertices.
    pub fn points(&self) -> usize {
        self.mesh.num_points()
    }

    /// The values of the attribute with Draco's `id`, which the document
    /// describes as `layout`.
    pub fn elements(
        &self,
        id: usize,
        layout: Layout,
        budget: &Budget,
        at: &At<'_>,
    ) -> Result<Elements<'static>> {
        let attribute = u32::try_from(id)
            .ok()
            .and_then(|id| self.mesh.attribute_by_unique_id(id))
            .ok_or_else(|| at.syntax("an attribute of the Draco mesh", id.to_string()))?;
        let components = layout.kind.components();
        if usize::from(attribute.num_components()) != components {
            let expected = format!("{components} components in the Draco mesh");
            return Err(at.syntax(expected, attribute.num_components().to_string()));
        }
        budget.take(self.points(), components * 4, at)?;
        let found = component(attribute.data_type());
        let layout = Layout {
            component: found.unwrap_or(Component::F32),
            ..layout
        };
        let bytes = match found {
            Some(component) => raw(attribute, self.points(), components * component.size()),
            None => {
                let values = attribute.read_f32s(self.points(), components);
                values.into_iter().flat_map(f32::to_le_bytes).collect()
            }
        };
        Ok(Elements::from_bytes(layout, bytes))
    }
}

fn component(data_type: DataType) -> Option<Component> {
    Some(match data_type {
        DataType::Int8 => Component::I8,
        DataType::Uint8 => Component::U8,
        DataType::Int16 => Component::I16,
        DataType::Uint16 => Component::U16,
        DataType::Uint32 => Component::U32,
        DataType::Float32 => Component::F32,
        _ => return None,
    })
}

/// Values of `size` bytes in the order of the points; zeros where the stream
/// has none.
fn raw(attribute: &PointAttribute, points: usize, size: usize) -> Vec<u8> {
    let stride = usize::try_from(attribute.byte_stride()).unwrap_or(size);
    let data = attribute.buffer().data();
    let mut bytes = vec![0; points * size];
    for (point, target) in bytes.chunks_exact_mut(size).enumerate() {
        let value = attribute.mapped_index(PointIndex(point as u32)).0 as usize;
        let start = value.saturating_mul(stride);
        let source = start.checked_add(size).and_then(|end| data.get(start..end));
        if let Some(source) = source {
            target.copy_from_slice(source);
        }
    }
    bytes
}

/// Names and Draco ids of the attributes of a compressed primitive.
pub(super) fn attribute_ids<'v>(
    compressed: &'v Value,
    at: &At<'_>,
) -> Result<Vec<(&'v str, usize)>> {
    let Some(attributes) = compressed.get("attributes").and_then(Value::as_object) else {
        return Err(at.syntax("`attributes`", "none"));
    };
    let at = at.key("attributes");
    let id = |name: &'v String| {
        Ok((
            name.as_str(),
            json::required(&compressed["attributes"], name, &at)?,
        ))
    };
    attributes.keys().map(id).collect::<Result<_, Error>>()
}
