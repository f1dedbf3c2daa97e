//! Hierarchies as bytes, sound and not.

use karui::Error;
use karui::geom::{Camera, Vec3};
use karui::hierarchy::{Budget, Hierarchy, HierarchyOptions, ViewAndLight, checksum};
use karui::mesh::{TriMesh, shapes};

fn built(mesh: &TriMesh) -> Hierarchy {
    let options = HierarchyOptions {
        alpha: f64::INFINITY,
        ..HierarchyOptions::default()
    };
    Hierarchy::build(mesh, &options).expect("builds")
}

#[test]
fn what_is_written_is_read() {
    for (name, mesh) in shapes::zoo() {
        let hierarchy = built(&mesh);
        let again =
            Hierarchy::from_bytes(&hierarchy.to_bytes()).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(again, hierarchy, "{name}");
        assert!(again.is_of(&mesh), "{name}");
    }
    assert!(!built(&shapes::cube(2)).is_of(&shapes::cube(3)));
}

#[test]
fn what_is_cut_short_or_altered_is_refused() {
    let bytes = built(&shapes::icosphere(2)).to_bytes();
    for length in (0..bytes.len()).step_by(7) {
        let found = Hierarchy::from_bytes(&bytes[..length]);
        assert!(matches!(found, Err(Error::BadHierarchy { .. })), "{length}");
    }
    for at in (0..bytes.len()).step_by(11) {
        let mut damaged = bytes.clone();
        damaged[at] ^= 0x20;
        let found = Hierarchy::from_bytes(&damaged);
        assert!(matches!(found, Err(Error::BadHierarchy { .. })), "{at}");
    }
}

/// Bytes that somebody has tampered with and closed again.
fn resealed(mut bytes: Vec<u8>, at: usize, with: u32) -> Vec<u8> {
    bytes[at..at + 4].copy_from_slice(&with.to_le_bytes());
    let end = bytes.len() - 8;
    let sum = checksum(&bytes[..end]);
    bytes[end..].copy_from_slice(&sum.to_le_bytes());
    bytes
}

/// Every number in turn replaced by several: refused, or as good as any other.
#[test]
fn what_is_tampered_with_is_refused_or_can_be_cut() {
    for mesh in [
        shapes::icosphere(1),
        shapes::terrain(4, 3, 1),
        shapes::cube(2),
    ] {
        let bytes = built(&mesh).to_bytes();
        let mut refused = 0;
        for at in (8..bytes.len() - 8).step_by(4) {
            for with in [0, 1, 7, 40, 1 << 31, u32::MAX, 0x3f80_0000, 0x7fc0_0000] {
                let tampered = resealed(bytes.clone(), at, with);
                let Ok(hierarchy) = Hierarchy::from_bytes(&tampered) else {
                    refused += 1;
                    continue;
                };
                exercise(&hierarchy, &mesh);
            }
        }
        assert!(refused > bytes.len(), "{refused} of {}", 2 * bytes.len());
    }
}

fn exercise(hierarchy: &Hierarchy, mesh: &TriMesh) {
    let mut cut = hierarchy.coarsest();
    for (direction, area) in [
        (Vec3::X, 50.0),
        (Vec3::Z, 4000.0),
        (Vec3::new(1.0, -2.0, 0.5), 300.0),
    ] {
        let criteria = ViewAndLight {
            camera: Camera::looking_at(mesh.bounds(), direction, 0.6),
            size: [200, 200],
            area,
            ..ViewAndLight::default()
        };
        // The box may be anything now.
        if cut.refine(&criteria, Budget::UNLIMITED).is_ok() {
            cut.validate().expect("it was taken");
        }
    }
}
