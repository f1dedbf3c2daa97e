//! Surfaces that cannot be oriented. Each is a strip of quads whose last
//! column meets the first one upside down, so the edges between the two have
//! faces of opposite orientation.

use super::{super::TriMesh, quads, turn};
use glam::{DVec3, Vec3};

/// A Moebius strip of `segments` quads around (at least 3) and `across` quads
/// across (at least 1): one boundary loop, `across` inconsistent edges.
#[must_use]
pub fn moebius(segments: u32, across: u32) -> TriMesh {
    let (segments, across) = (segments.max(3), across.max(1));
    let mut positions = Vec::new();
    for i in 0..segments {
        for j in 0..=across {
            let width = f64::from(j) / f64::from(across) - 0.5;
            positions.push(twisted(i, segments, |sin, cos| {
                DVec3::new(width * cos, width * sin, 0.0)
            }));
        }
    }
    let triangles = quads(segments, across, |i, j| {
        let j = if i == segments { across - j } else { j };
        i % segments * (across + 1) + j
    });
    TriMesh::new(positions, triangles)
}

/// A Klein bottle in the figure-eight immersion: closed, one-sided, cutting
/// through itself; `segments` around (at least 4) and `sides` quads (raised to
/// an even number, at least 4) around the eight; `sides` inconsistent edges.
#[must_use]
pub fn klein_bottle(segments: u32, sides: u32) -> TriMesh {
    let (segments, sides) = (segments.max(4), sides.max(4).next_multiple_of(2));
    let mut positions = Vec::new();
    for i in 0..segments {
        for j in 0..sides {
            let (s, _) = turn(j, sides);
            let (s2, _) = turn(2 * j, sides);
            positions.push(twisted(i, segments, |sin, cos| {
                DVec3::new(cos * s - sin * s2, sin * s + cos * s2, 0.0) * 0.4
            }));
        }
    }
    separate_crossing(&mut positions, sides);
    let triangles = quads(segments, sides, |i, j| {
        let j = if i == segments { sides - j } else { j };
        i % segments * sides + j % sides
    });
    TriMesh::new(positions, triangles)
}

/// The eight crosses itself at its vertices 0 and sides / 2; the second is
/// moved so that they do not count as one position.
fn separate_crossing(positions: &mut [Vec3], sides: u32) {
    let half = sides as usize / 2;
    for p in positions.iter_mut().skip(half).step_by(sides as usize) {
        p.y += 0.01;
    }
}

/// Places a profile on the circle of radius 1, turned by half of `i`'s angle.
fn twisted(i: u32, segments: u32, profile: impl Fn(f64, f64) -> DVec3) -> Vec3 {
    let (sin, cos) = turn(i, segments);
    let (half_sin, half_cos) = turn(i, 2 * segments);
    let p = profile(half_sin, half_cos);
    let radius = 1.0 + p.x;
    (DVec3::new(radius * cos, p.y, -radius * sin) + 0.0).as_vec3()
}
