//! The torus.

use super::{super::TriMesh, quads, turn};
use glam::DVec3;

/// A closed torus around the y axis: centre circle of radius `major` in
/// `segments` steps, tube of radius `minor` in `sides` steps (both at least
/// 3): `segments * sides` vertices, twice as many triangles.
#[must_use]
pub fn torus(major: f32, minor: f32, segments: u32, sides: u32) -> TriMesh {
    let (segments, sides) = (segments.max(3), sides.max(3));
    let (major, minor) = (f64::from(major), f64::from(minor));
    let mut positions = Vec::with_capacity(segments as usize * sides as usize);
    for j in 0..sides {
        let (height, out) = turn(j, sides);
        let radius = major + minor * out;
        for i in 0..segments {
            let (sin, cos) = turn(i, segments);
            let p = DVec3::new(radius * cos, minor * height, -radius * sin);
            positions.push((p + 0.0).as_vec3());
        }
    }
    let triangles = quads(segments, sides, |i, j| j % sides * segments + i % segments);
    TriMesh::new(positions, triangles)
}
