//! glTF and GLB in slices.

use crate::{assert_same, common, damaged_everywhere, outcome, triangles, vertices};
use karui::{
    Scene, TriMesh,
    geom::{Mat4, Vec3},
    mesh::{Node, Placements, Transform, shapes},
    outofcore::Source,
};
use karui_io::{GltfOptions, WriteOptions, slices};
use std::{fs, path::Path, sync::Arc};

/// The mesh read whole, without what slices leave aside.
fn whole(path: &Path, source: &dyn Source) -> TriMesh {
    let found = source.read_vertices(0..1).unwrap().attributes;
    let mut mesh = karui_io::read(path).unwrap().into_single_mesh().unwrap();
    let a = &mut mesh.attributes;
    a.skins.clear();
    a.morphs.clear();
    a.custom.clear();
    a.normals.take_if(|_| found.normals.is_none());
    a.tangents.take_if(|_| found.tangents.is_none());
    mesh
}

#[test]
fn real_models() {
    let Some(models) = common::models() else {
        return;
    };
    for name in [
        "2CylinderEngine.glb",
        "AnisotropyBarnLamp/AnisotropyBarnLamp.gltf",
        "CesiumMan.glb",
        "DenseSphere.glb",
        "DragonAttenuation.glb",
        "FlightHelmet/FlightHelmet.gltf",
        "Fox.glb",
        "MorphStressTest.gltf",
        "PalmTree/PalmTree.gltf",
        "ShapeCollection.glb",
        "SimpleSkin.gltf",
        "chr_knight.glb",
        "faces.glb",
        "gltf_primitives.glb",
        "many-cubes.gltf",
        "pirate.glb",
    ] {
        let path = models.join("gltf").join(name);
        if !path.is_file() {
            println!("SKIPPED: no {}", path.display());
            continue;
        }
        match slices::open(&path) {
            Ok(source) => {
                let mesh = whole(&path, &*source);
                assert_same(&*source, &mesh, 50_021, name);
                println!(
                    "{name}: {} vertices, {} portions",
                    source.vertices(),
                    source.chunks()
                );
            }
            Err(error) => {
                println!("{error}");
                assert!(error.to_string().contains("in slices"), "{error}");
            }
        }
    }
}

/// Two meshes: one placed three times, mirrored once, one on a node below another.
fn scene() -> Scene {
    let mut scene = Scene::from_mesh(shapes::textured_sphere(40, 60));
    let mut plain = Scene::from_mesh(shapes::landscape(300, 200, 2));
    scene.meshes.append(&mut plain.meshes);
    let transform = |m: Mat4| Transform::Matrix(m);
    let placements = Placements {
        translations: vec![Vec3::X, Vec3::new(3.0, 2.0, 1.0), Vec3::ZERO],
        scales: Some(vec![Vec3::ONE, Vec3::new(-1.0, 2.0, 1.5), Vec3::splat(0.5)]),
        ..Placements::default()
    };
    scene.nodes = vec![
        Node {
            mesh: Some(0),
            placements: Some(Arc::new(placements)),
            children: vec![1],
            ..Node::default()
        },
        Node {
            mesh: Some(1),
            transform: transform(Mat4::from_translation(Vec3::new(0.0, 5.0, -7.0))),
            ..Node::default()
        },
    ];
    scene.roots = vec![0];
    scene
}

#[test]
fn every_place_is_a_copy() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.glb", "a.gltf"] {
        let path = folder.path().join(name);
        karui_io::write(&path, &scene()).unwrap();
        let source = slices::open(&path).unwrap();
        let mesh = whole(&path, &*source);
        assert_same(&*source, &mesh, 5_003, name);
        assert!(source.chunks() >= 2);
    }
    // A buffer that is not there, or lies elsewhere.
    let path = folder.path().join("a.gltf");
    let text = fs::read_to_string(&path).unwrap();
    let start = text.find("\"uri\"").unwrap();
    let quoted: Vec<_> = text[start..]
        .match_indices('"')
        .map(|(i, _)| start + i)
        .collect();
    let with = |uri: &str| {
        let bad = format!("{}{uri}{}", &text[..=quoted[2]], &text[quoted[3]..]);
        fs::write(&path, bad).unwrap();
        slices::open(&path).err().unwrap().to_string()
    };
    assert!(with("none.bin").contains("no such file"));
    assert!(with("../a.glb").contains("leaves the folder"));
}

#[test]
fn compressed_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    let options = WriteOptions {
        gltf: GltfOptions {
            meshopt: true,
            ..GltfOptions::default()
        },
        ..WriteOptions::default()
    };
    karui_io::write_with(&path, &scene(), &options).unwrap();
    let error = slices::open(&path).err().unwrap().to_string();
    assert!(
        error.contains("compressed glTF in slices") && error.contains("karui convert"),
        "{error}"
    );
}

#[test]
fn damaged_files_are_told_from_good_ones() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    karui_io::write(&path, &Scene::from_mesh(shapes::icosphere(0))).unwrap();
    let good = fs::read(&path).unwrap();
    damaged_everywhere(&good, "a.glb");
    let as_text = String::from_utf8_lossy(&good).into_owned();
    let whole = outcome(&path).unwrap();
    assert_eq!(whole.1.len(), 20);
    // Every number of the document in turn becomes one that lies.
    let json = &as_text[..as_text.rfind("}]").unwrap()];
    for (at, _) in json.match_indices(|c: char| c.is_ascii_digit()) {
        let mut bad = good.clone();
        bad[at] = b'9';
        fs::write(&path, &bad).unwrap();
        if let Ok(source) = slices::open(&path) {
            let _ = triangles(&*source);
            let _ = vertices(&*source, 5);
        }
    }
    // The last index.
    let mut bad = good.clone();
    let end = bad.len();
    let indices = (0..end).rev().find(|&i| bad[i] != 0).unwrap();
    bad[indices] = 200;
    fs::write(&path, &bad).unwrap();
    if let Err(error) = outcome(&path) {
        assert!(error.contains("byte") && error.contains("a.glb"), "{error}");
    }
}
