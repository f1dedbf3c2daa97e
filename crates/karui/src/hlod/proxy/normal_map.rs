//! Which way the members face, as seen from in front of a card.

use super::group::Group;
use super::silhouette::Window;
use crate::error::Result;
use crate::geom::{Vec3, normal_times_two_areas};
use crate::mesh::{NormalWeight, PositionIds, vertex_normals};
use crate::render::Hit;
use std::borrow::Cow;

/// Normals over the surface of a group.
pub(super) struct NormalMap<'a> {
    group: &'a Group<'a>,
    normals: Cow<'a, [Vec3]>,
}

impl<'a> NormalMap<'a> {
    /// With smooth normals where the members have none, as they are drawn.
    pub fn new(group: &'a Group<'a>) -> Result<Self> {
        let mesh = &group.mesh;
        let normals = match &mesh.attributes.normals {
            Some(normals) => Cow::Borrowed(&normals[..]),
            None => {
                let ids = PositionIds::of_mesh(mesh);
                Cow::Owned(vertex_normals(mesh, &ids, NormalWeight::Area)?)
            }
        };
        Ok(Self { group, normals })
    }

    /// Texel of a normal map for what is seen through a window; alpha 0 for nothing.
    pub fn texel(&self, hit: &Hit, window: &Window) -> [u8; 4] {
        if !hit.is_some() {
            return [0; 4];
        }
        let mesh = &self.group.mesh;
        let corners = mesh.triangles[hit.triangle as usize].map(|v| self.normals[v as usize]);
        let [a, b, c] = hit.weights();
        let mixed = corners[0] * a + corners[1] * b + corners[2] * c;
        let face = normal_times_two_areas(mesh.corners(hit.triangle as usize)).as_vec3();
        let normal = mixed.try_normalize().unwrap_or(face.normalize_or_zero());
        // The back of a surface is lit as one that faces the viewer.
        let towards = if face.dot(window.towards) < 0.0 {
            -normal
        } else {
            normal
        };
        let [x, y, z] = [window.right(), window.up, window.towards].map(|axis| towards.dot(axis));
        let code = |along: f32| (along.clamp(-1.0, 1.0) * 127.0 + 128.0) as u8;
        [code(x), code(y), code(z.max(0.0)), 255]
    }
}
