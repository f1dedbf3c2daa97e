//! Made-up land of any extent.

use super::{super::TriMesh, grid::value_noise, quads};
use glam::Vec3;
use rayon::prelude::*;

/// Hills and roughness on a grid of `columns` x `rows` quads (at least 1 x 1)
/// with sides of 1 model unit, from (0, y, 0) on, facing +y, without
/// attributes: ten octaves of value noise from `seed`, waves of 1024 quads
/// down to 2, heights within -180..=180.
///
/// A larger one is more land, equally rough everywhere, where
/// [`terrain`](super::terrain) is the same land in smaller triangles: what
/// takes longer on it takes longer because there is more of it. Same
/// arguments, same bits.
#[must_use]
pub fn landscape(columns: u32, rows: u32, seed: u64) -> TriMesh {
    let (columns, rows) = (columns.max(1), rows.max(1));
    let row = |j: u32| {
        let vertex = move |i| Vec3::new(i as f32, landscape_height(i, j, seed), j as f32);
        (0..=columns).map(vertex)
    };
    let positions = (0..=rows).into_par_iter().flat_map_iter(row).collect();
    // Seen from above, z runs downwards; `quads` wants rows upwards.
    let vertex = |i: u32, j: u32| (rows - j) * (columns + 1) + i;
    TriMesh::new(positions, quads(columns, rows, vertex))
}

/// Height of [`landscape`] at the vertex in column `i` of row `j`, for land that is too
/// large to be in memory.
#[must_use]
pub fn landscape_height(i: u32, j: u32, seed: u64) -> f32 {
    let octave = |o: u32| {
        let wave = f64::from(1024 >> o);
        let noise = value_noise(
            f64::from(i) / wave,
            f64::from(j) / wave,
            seed ^ u64::from(o),
        );
        noise * 90.0 / f64::from(1 << o)
    };
    (0..10).map(octave).sum::<f64>() as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_up_and_depends_on_its_seed_only() {
        let land = landscape(40, 20, 7);
        assert_eq!(land.triangles.len(), 1600);
        for t in 0..land.triangles.len() {
            assert!(crate::geom::normal_times_two_areas(land.corners(t)).y > 0.0);
        }
        assert_eq!(land, landscape(40, 20, 7));
        assert_ne!(land, landscape(40, 20, 8));
    }

    #[test]
    fn more_land_is_the_same_land_and_more() {
        let (part, whole) = (landscape(9, 5, 3), landscape(33, 17, 3));
        for p in part.positions {
            assert!(whole.positions.contains(&p), "{p}");
        }
    }

    #[test]
    fn is_as_rough_everywhere() {
        let slope = |land: &TriMesh| {
            let lean = |t| {
                let n = crate::geom::normal_times_two_areas(land.corners(t)).normalize();
                n.y.acos()
            };
            let sum: f64 = (0..land.triangles.len()).map(lean).sum();
            sum / land.triangles.len() as f64
        };
        let (small, large) = (
            slope(&landscape(128, 64, 1)),
            slope(&landscape(512, 256, 1)),
        );
        assert!((small / large - 1.0).abs() < 0.2, "{small} {large}");
    }
}
