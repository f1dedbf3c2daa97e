//! What the fuzz targets have in common.

pub mod dirty;

use karui::{PolyMesh, Scene};
use karui_io::Format;

/// Reads `bytes`; whatever is accepted must be sound.
pub fn read(format: Format, bytes: &[u8]) {
    if let Ok(loaded) = karui_io::read_bytes(format, bytes, "fuzz") {
        check(&loaded.scene);
    }
    if let Ok(mesh) = karui_io::read_poly_bytes(format, bytes, "fuzz") {
        check_polygons(&mesh);
    }
}

fn check_polygons(mesh: &PolyMesh) {
    let end = mesh.offsets.last().copied();
    assert_eq!(
        end,
        Some(mesh.indices.len() as u32),
        "faces end with the indices"
    );
    assert!(mesh.offsets.is_sorted(), "faces follow each other");
    let vertices = mesh.positions.len();
    assert!(mesh.indices.iter().all(|&v| (v as usize) < vertices));
}

/// A scene that a reader returned must be valid: operations rely on it.
pub fn check(scene: &Scene) {
    scene.validate().expect("a scene read from a file is valid");
}
