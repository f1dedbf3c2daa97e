//! Raw positions and indices in slices.

use crate::{assert_same, common, damaged_everywhere, outcome};
use karui::{TriMesh, mesh::shapes};
use karui_io::slices;
use std::fs;

/// The file as the documentation describes it.
fn made(mesh: &TriMesh, width: u32) -> Vec<u8> {
    let mut bytes = b"KARUITM1".to_vec();
    bytes.extend((mesh.positions.len() as u64).to_le_bytes());
    bytes.extend((mesh.triangles.len() as u64).to_le_bytes());
    bytes.extend(width.to_le_bytes());
    bytes.extend([0; 4]);
    for p in &mesh.positions {
        p.to_array()
            .iter()
            .for_each(|x| bytes.extend(x.to_le_bytes()));
    }
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    for &v in mesh.triangles.as_flattened() {
        match width {
            4 => bytes.extend(v.to_le_bytes()),
            _ => bytes.extend(u64::from(v).to_le_bytes()),
        }
    }
    bytes
}

#[test]
fn both_widths() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.tm");
    let mut meshes = vec![
        shapes::icosphere(2),
        shapes::landscape(300, 301, 4),
        TriMesh::default(),
    ];
    if let Some(models) = common::models() {
        for name in [
            "scans/armadillo.off.gz",
            "scans/bun_zipper.ply.gz",
            "hard/bones.off",
        ] {
            let scene = karui_io::read(models.join(name)).unwrap();
            let mesh = scene.into_single_mesh().unwrap();
            meshes.push(TriMesh::new(mesh.positions, mesh.triangles));
        }
    }
    for mesh in &meshes {
        for width in [4, 8] {
            fs::write(&path, made(mesh, width)).unwrap();
            assert_same(&*slices::open(&path).unwrap(), mesh, 10_001, "raw");
        }
    }
}

#[test]
fn what_is_wrong_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.tm");
    for width in [4, 8] {
        let good = made(&shapes::icosphere(0), width);
        damaged_everywhere(&good, "a.tm");
        let error = |at: usize, bytes: &[u8]| {
            let mut bad = good.clone();
            bad[at..at + bytes.len()].copy_from_slice(bytes);
            fs::write(&path, &bad).unwrap();
            outcome(&path).unwrap_err()
        };
        for count in [u64::MAX, 1 << 60, 1 << 32, 13, 0] {
            for at in [8, 16] {
                let error = error(at, &count.to_le_bytes());
                assert!(error.contains("a.tm: byte 8: "), "{error}");
            }
        }
        assert!(error(24, &[5]).contains("byte 24"));
        assert!(error(28, &[1]).contains("byte 24"));
        assert!(error(36, &f32::INFINITY.to_le_bytes()).contains("byte 36"));
        let indices = 32 + 12 * 12;
        let found = error(indices + width as usize, &[12]);
        assert!(
            found.contains("index 12 is out of range; there are 12"),
            "{found}"
        );
        assert!(
            found.contains(&format!("byte {}", indices + width as usize)),
            "{found}"
        );
    }
}
