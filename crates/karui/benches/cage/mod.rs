//! The cage that the benches of subdivision share.

use karui::geom::Vec3;
use karui::mesh::shapes;
use karui::subdiv::Cage;

/// A torus of 8,192 quads.
pub fn torus() -> (Cage, Vec<Vec3>) {
    let (around, across) = (128, 64);
    let mesh = shapes::torus(1.0, 0.4, around, across);
    let at = |i: u32, j: u32| j % across * around + i % around;
    let quads = (0..across).flat_map(|j| {
        (0..around).flat_map(move |i| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)])
    });
    let cage = Cage {
        vertices: mesh.positions.len(),
        offsets: (0..=around * across).map(|f| 4 * f).collect(),
        indices: quads.collect(),
        ..Cage::default()
    };
    (cage, mesh.positions)
}
