//! Open grids and made-up terrain.

use super::{super::TriMesh, quads};
use glam::{Vec2, Vec3};

/// A flat open grid of `columns` x `rows` quads (at least 1 x 1) in the plane
/// y = 0, from (0, 0, 0) to (1, 0, 1), facing +y, with UVs.
#[must_use]
pub fn grid(columns: u32, rows: u32) -> TriMesh {
    height_grid(columns, rows, |_, _| 0.0)
}

/// Like [`grid`] with the height `height(x, z)` for `x` and `z` in 0..=1.
#[must_use]
pub fn height_grid(columns: u32, rows: u32, height: impl Fn(f32, f32) -> f32) -> TriMesh {
    let (columns, rows) = (columns.max(1), rows.max(1));
    let count = (columns as usize + 1) * (rows as usize + 1);
    let (mut positions, mut uvs) = (Vec::with_capacity(count), Vec::with_capacity(count));
    for j in 0..=rows {
        for i in 0..=columns {
            let uv = Vec2::new(i as f32 / columns as f32, 1.0 - j as f32 / rows as f32);
            positions.push(Vec3::new(uv.x, height(uv.x, uv.y), uv.y));
            uvs.push(uv);
        }
    }
    let triangles = quads(columns, rows, |i, j| j * (columns + 1) + i);
    let mut mesh = TriMesh::new(positions, triangles);
    mesh.attributes.uvs = vec![uvs];
    mesh
}

/// Rough terrain on a grid of `columns` x `rows` quads: eight octaves of value
/// noise from `seed`, heights within -0.25..=0.25. Same arguments, same bits.
#[must_use]
pub fn terrain(columns: u32, rows: u32, seed: u64) -> TriMesh {
    height_grid(columns, rows, |x, z| {
        let octave = |o: u32| {
            let scale = f64::from(4u32 << o);
            value_noise(
                f64::from(x) * scale,
                f64::from(z) * scale,
                seed ^ u64::from(o),
            ) / f64::from(8u32 << o)
        };
        (0..8).map(octave).sum::<f64>() as f32
    })
}

/// Smoothly interpolated lattice noise in -1..=1.
pub(in crate::mesh) fn value_noise(x: f64, z: f64, seed: u64) -> f64 {
    let (i, j) = (x.floor(), z.floor());
    let at = |di: f64, dj: f64| lattice_value((i + di) as u64, (j + dj) as u64, seed);
    let (s, t) = (smooth(x - i), smooth(z - j));
    let near = at(0.0, 0.0) + s * (at(1.0, 0.0) - at(0.0, 0.0));
    let far = at(0.0, 1.0) + s * (at(1.0, 1.0) - at(0.0, 1.0));
    near + t * (far - near)
}

fn smooth(t: f64) -> f64 {
    t * t * (3.0 - 2.0 * t)
}

/// A value in -1..1 that looks random (finaliser of SplitMix64).
fn lattice_value(i: u64, j: u64, seed: u64) -> f64 {
    let key = seed
        .wrapping_mul(0x9e37_79b9_7f4a_7c15)
        .wrapping_add(i << 32 | j);
    let mixed = (key ^ key >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((mixed ^ mixed >> 31) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grid_faces_up() {
        let mesh = grid(3, 2);
        assert_eq!(mesh.triangles.len(), 12);
        for t in 0..mesh.triangles.len() {
            assert!(crate::geom::normal_times_two_areas(mesh.corners(t)).y > 0.0);
        }
    }

    #[test]
    fn terrain_depends_on_its_seed_only() {
        let heights = |seed| -> Vec<f32> {
            let mesh = terrain(20, 20, seed);
            mesh.positions.iter().map(|p| p.y).collect()
        };
        assert_eq!(heights(1), heights(1));
        assert_ne!(heights(1), heights(2));
        let [low, high] = [f32::min, f32::max].map(|f| heights(1).into_iter().reduce(f).unwrap());
        assert!(low >= -0.25 && high <= 0.25 && high - low > 0.1);
    }
}
