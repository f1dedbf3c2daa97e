//! Gently rolling land.

use crate::mesh::{MaterialRange, TriMesh, shapes};
use glam::{Vec2, Vec3};

/// Cells a side.
const CELLS: u32 = 128;

/// A square of land around the origin.
pub(super) struct Ground {
    side: f32,
    seed: u64,
}

impl Ground {
    /// Of `side` metres.
    pub fn new(side: f32, seed: u64) -> Self {
        Self { side, seed }
    }

    /// Height of a corner of a cell: two octaves of noise, slopes of a few per
    /// cent whatever the size.
    fn corner(&self, i: u32, j: u32) -> f32 {
        let octave = |cells: f64, part: f64, seed: u64| {
            let noise = shapes::value_noise(f64::from(i) / cells, f64::from(j) / cells, seed);
            noise * part * f64::from(self.side)
        };
        (octave(32.0, 0.01, self.seed) + octave(11.0, 0.002, !self.seed)) as f32
    }

    /// Height in metres at a place within the square; bilinear in its cell.
    pub fn height(&self, place: Vec2) -> f32 {
        let at = (place / self.side + 0.5) * CELLS as f32;
        let cell = at
            .floor()
            .clamp(Vec2::ZERO, Vec2::splat(CELLS as f32 - 1.0));
        let (i, j) = (cell.x as u32, cell.y as u32);
        let t = (at - cell).clamp(Vec2::ZERO, Vec2::ONE);
        let row = |j: u32| {
            let (a, b) = (self.corner(i, j), self.corner(i + 1, j));
            a + (b - a) * t.x
        };
        let (near, far) = (row(j), row(j + 1));
        near + (far - near) * t.y
    }

    /// Its surface in one material, facing up, without normals.
    pub fn mesh(&self, material: u32) -> TriMesh {
        let vertex = |i: u32, j: u32| {
            let place = (Vec2::new(i as f32, j as f32) / CELLS as f32 - 0.5) * self.side;
            Vec3::new(place.x, self.corner(i, j), place.y)
        };
        let rows = (0..=CELLS).flat_map(|j| (0..=CELLS).map(move |i| vertex(i, j)));
        // Seen from above, z runs downwards; `quads` wants rows upwards.
        let index = |i: u32, j: u32| (CELLS - j) * (CELLS + 1) + i;
        let mut mesh = TriMesh::new(rows.collect(), shapes::quads(CELLS, CELLS, index));
        mesh.ranges = vec![MaterialRange {
            first: 0,
            count: mesh.triangles.len() as u32,
            material: Some(material),
            source: None,
        }];
        mesh
    }
}
