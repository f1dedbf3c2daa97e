//! What is written reads back: every attribute a format can hold, exactly.

#![allow(clippy::unwrap_used, reason = "a test")]

use karui::{
    Scene, TriMesh,
    geom::{Mat4, Vec2, Vec3, Vec4},
    mesh::{
        AlphaMode, Attribute, AttributeValues, Image, ImageData, Material, MaterialRange,
        NamedMesh, Node, Texture, TextureRef, Transform, UvTransform, Wrap,
    },
};
use karui_io::{PlyEncoding, WriteOptions, read, read_with, write_with};
use proptest::prelude::*;
use std::{fs, path::Path};

const ENCODINGS: [PlyEncoding; 3] = [
    PlyEncoding::Ascii,
    PlyEncoding::BinaryBigEndian,
    PlyEncoding::BinaryLittleEndian,
];

fn through(name: &str, mesh: &TriMesh, options: &WriteOptions) -> TriMesh {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    let written = write_with(&path, &Scene::from_mesh(mesh.clone()), options).unwrap();
    let size = |p: &std::path::PathBuf| fs::metadata(p).unwrap().len();
    assert_eq!(written.bytes, written.files.iter().map(size).sum::<u64>());
    let mesh = read(&path).unwrap().into_single_mesh().unwrap();
    mesh.validate().unwrap();
    mesh
}

fn ply_options(ply: PlyEncoding) -> WriteOptions {
    WriteOptions {
        ply,
        ..WriteOptions::default()
    }
}

fn attribute(name: &str, components: usize, values: AttributeValues) -> Attribute {
    Attribute {
        name: name.into(),
        components,
        values,
    }
}

/// Two triangles with everything that PLY can hold.
fn rich() -> TriMesh {
    let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(0.1, 1e-20, -3e30)];
    let mut mesh = TriMesh::new(positions, vec![[0, 1, 2], [2, 1, 3]]);
    let a = &mut mesh.attributes;
    a.normals = Some(vec![
        Vec3::Z,
        Vec3::new(0.6, 0.8, 0.0),
        Vec3::Y,
        Vec3::NEG_X,
    ]);
    a.tangents = Some(vec![Vec4::new(1.0, 0.0, 0.0, -1.0); 4]);
    a.uvs = (0..2)
        .map(|s| {
            (0..4)
                .map(|i| Vec2::new(0.1 * i as f32, 0.3 * (i + s) as f32))
                .collect()
        })
        .collect();
    let color = |i: u8| Vec4::new(f32::from(i) / 255.0, 1.0, 0.0, 1.0);
    a.colors = vec![
        (0..4).map(color).collect(),
        vec![Vec4::new(0.3, 0.1, 0.7, 0.5); 4],
    ];
    a.custom = vec![
        attribute(
            "confidence",
            1,
            AttributeValues::F32(vec![0.1, f32::NAN, 1e-30, 4.0]),
        ),
        attribute("i8", 1, AttributeValues::I8(vec![-128, 127, 0, 1])),
        attribute("u16", 1, AttributeValues::U16(vec![0, 65535, 7, 1])),
        attribute("i16", 1, AttributeValues::I16(vec![-32768, 32767, 7, 1])),
        attribute("u32", 1, AttributeValues::U32(vec![0, u32::MAX, 7, 1])),
        attribute(
            "i32",
            1,
            AttributeValues::I32(vec![i32::MIN, i32::MAX, 7, 1]),
        ),
        attribute(
            "f64",
            1,
            AttributeValues::F64(vec![0.1, 1e300, -1e-300, 1.0 / 3.0]),
        ),
        attribute(
            "f_rest",
            3,
            AttributeValues::F32((0..12).map(|i| i as f32).collect()),
        ),
    ];
    mesh.face_attributes = vec![
        attribute(
            "color",
            4,
            AttributeValues::U8(vec![1, 2, 3, 4, 255, 0, 0, 255]),
        ),
        attribute("quality", 1, AttributeValues::F32(vec![0.25, 1e9])),
        attribute("label", 2, AttributeValues::I32(vec![-1, 2, 3, 4])),
    ];
    mesh
}

/// Equality that takes NaN for equal to itself.
fn assert_same(found: &TriMesh, expected: &TriMesh) {
    assert_eq!(format!("{found:?}"), format!("{expected:?}"));
}

#[test]
fn ply_keeps_everything() {
    for encoding in ENCODINGS {
        for name in ["a.ply", "a.ply.gz", "A.PLY"] {
            assert_same(&through(name, &rich(), &ply_options(encoding)), &rich());
        }
    }
}

#[test]
fn off_keeps_colours_normals_and_texture_coordinates() {
    let mut mesh = rich();
    let a = &mut mesh.attributes;
    a.custom.clear();
    a.tangents = None;
    a.uvs.truncate(1);
    a.colors.truncate(1);
    mesh.face_attributes.truncate(1);
    assert_same(&through("a.off", &mesh, &WriteOptions::default()), &mesh);
    // Colours that are no bytes, alpha, and whole numbers among fractions.
    mesh.attributes.colors[0][0] = Vec4::new(1.0, 0.0, 0.123, 0.5);
    mesh.face_attributes[0] = attribute(
        "color",
        4,
        AttributeValues::F32(vec![1.0, 0.0, 1.0, 1.0, 0.3, 0.1, 0.0, 1.0]),
    );
    assert_same(&through("a.off.gz", &mesh, &WriteOptions::default()), &mesh);
}

#[test]
fn stl_keeps_corners_and_attribute_bytes() {
    let mut mesh = TriMesh::new(rich().positions, rich().triangles);
    for stl_ascii in [false, true] {
        let options = WriteOptions {
            stl_ascii,
            ..WriteOptions::default()
        };
        assert_same(&through("a.stl", &mesh, &options), &mesh);
        assert_same(&through("a.stl.gz", &mesh, &options), &mesh);
    }
    mesh.face_attributes = vec![attribute(
        "stl_attribute",
        1,
        AttributeValues::U16(vec![7, 0]),
    )];
    assert_same(&through("a.stl", &mesh, &WriteOptions::default()), &mesh);
}

/// What OBJ says of the corners of all triangles, whatever the vertex order.
fn corners(mesh: &TriMesh) -> Vec<String> {
    let a = &mesh.attributes;
    let corner = |&v: &u32| {
        let v = v as usize;
        format!(
            "{:?} {:?} {:?} {:?}",
            mesh.positions[v],
            a.normals.as_ref().map(|n| n[v]),
            a.uvs.first().map(|u| u[v]),
            a.colors.first().map(|c| c[v])
        )
    };
    mesh.triangles.iter().flatten().map(corner).collect()
}

#[test]
fn obj_keeps_corners() {
    let mesh = rich();
    let back = through("a.obj", &mesh, &WriteOptions::default());
    assert_eq!(corners(&back), corners(&mesh));
    assert_eq!(back.positions, mesh.positions);
    let back = through(
        "a.obj.gz",
        &TriMesh::new(mesh.positions.clone(), mesh.triangles.clone()),
        &WriteOptions::default(),
    );
    assert_same(&back, &TriMesh::new(mesh.positions, mesh.triangles));
}

/// A scene with materials, a texture in memory and one that is missing.
fn textured() -> Scene {
    let mut mesh = rich();
    mesh.attributes.colors.clear();
    let range = |first, material| MaterialRange {
        first,
        count: 1,
        material,
        source: None,
    };
    mesh.ranges = vec![range(0, Some(1)), range(1, Some(0))];
    let mut scene = Scene::from_mesh(mesh);
    scene.meshes[0].name = Some("body".into());
    let texture = |image, wrap| Texture {
        image: Some(image),
        wrap,
        nearest: false,
    };
    scene.textures = vec![texture(0, [Wrap::Repeat; 2]), texture(1, [Wrap::Clamp; 2])];
    let image = |mime: &str, data| Image {
        name: None,
        mime: mime.into(),
        data,
    };
    scene.images = vec![
        image(
            "image/png",
            ImageData::Bytes {
                bytes: b"\x89PNG..."[..].into(),
                uri: Some("wood.png".into()),
            },
        ),
        image(
            "image/jpeg",
            ImageData::Missing {
                uri: "gone.jpg".into(),
            },
        ),
    ];
    let reference = |texture, transform| {
        Some(TextureRef {
            texture,
            uv_set: 0,
            transform,
        })
    };
    let moved = UvTransform {
        offset: Vec2::new(0.25, -0.5),
        rotation: 0.0,
        scale: Vec2::new(2.0, 4.0),
    };
    scene.materials = vec![
        Material {
            name: Some("red paint".into()),
            base_color: Vec4::new(0.8, 0.1, 0.1, 0.5),
            base_color_texture: reference(0, None),
            metallic: 0.25,
            roughness: 0.3,
            normal_texture: reference(1, None),
            normal_scale: 0.7,
            emissive: Vec3::new(0.0, 0.5, 1.0),
            emissive_texture: reference(0, Some(moved)),
            alpha_mode: AlphaMode::Blend,
            ..Material::default()
        },
        Material {
            name: Some("steel".into()),
            metallic_roughness_texture: reference(1, None),
            ..Material::default()
        },
    ];
    scene
}

#[test]
fn obj_keeps_materials_and_textures() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    let scene = textured();
    let written = write_with(&path, &scene, &WriteOptions::default()).unwrap();
    let names: Vec<_> = written
        .files
        .iter()
        .filter_map(|f| f.file_name()?.to_str())
        .collect();
    assert_eq!(names, ["wood.png", "a.mtl", "a.obj"]);
    let loaded = read_with(&path, &Default::default()).unwrap();
    assert_eq!(loaded.warnings, ["texture `gone.jpg` was not found"]);
    let back = loaded.scene;
    // Ranges come in the order in which materials appear.
    let materials: Vec<_> = back.meshes[0]
        .mesh
        .ranges
        .iter()
        .map(|r| r.material)
        .collect();
    assert_eq!(materials, [Some(1), Some(0)]);
    assert_eq!(back.meshes[0].name.as_deref(), Some("body"));
    assert_eq!(
        corners(&back.meshes[0].mesh),
        corners(&scene.meshes[0].mesh)
    );
    assert_eq!(back.images, scene.images);
    let plain = |m: &Material| Material {
        base_color_texture: None,
        normal_texture: None,
        emissive_texture: None,
        metallic_roughness_texture: None,
        ..m.clone()
    };
    for (found, expected) in back.materials.iter().zip(&scene.materials) {
        assert_eq!(plain(found), plain(expected));
        let image = |scene: &Scene, t: Option<TextureRef>| {
            t.map(|t| (scene.textures[t.texture as usize], t.transform))
        };
        for part in [
            |m: &Material| m.base_color_texture,
            |m: &Material| m.normal_texture,
            |m: &Material| m.emissive_texture,
            |m: &Material| m.metallic_roughness_texture,
        ] {
            assert_eq!(image(&back, part(found)), image(&scene, part(expected)));
        }
    }
}

#[test]
fn obj_leaves_other_files_alone() {
    let folder = tempfile::tempdir().unwrap();
    let other = folder.path().join("wood.png");
    fs::write(&other, "another picture").unwrap();
    let path = folder.path().join("a.obj");
    write_with(&path, &textured(), &WriteOptions::default()).unwrap();
    assert_eq!(fs::read(&other).unwrap(), b"another picture");
    let scene = read(&path).unwrap();
    let ImageData::Bytes { bytes, uri } = &scene.images[0].data else {
        panic!("{:?}", scene.images[0]);
    };
    assert_eq!(
        (&bytes[..], uri.as_deref()),
        (&b"\x89PNG..."[..], Some("a-wood.png"))
    );
}

#[test]
fn scenes_are_placed() {
    let triangle = TriMesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
    let mut scene = Scene::from_mesh(triangle);
    scene.meshes.push(NamedMesh::default());
    scene.nodes[0].children = vec![1];
    scene.nodes[0].transform = Transform::Matrix(Mat4::from_translation(Vec3::Z));
    scene.nodes.push(Node {
        mesh: Some(0),
        transform: Transform::Matrix(Mat4::from_scale(Vec3::new(-2.0, 1.0, 1.0))),
        ..Node::default()
    });
    let expected = scene.clone().into_single_mesh().unwrap();
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.obj", "a.ply", "a.stl", "a.off"] {
        let path = folder.path().join(name);
        write_with(&path, &scene, &WriteOptions::default()).unwrap();
        let back = read(&path).unwrap().into_single_mesh().unwrap();
        let positions = |m: &TriMesh| -> Vec<Vec3> {
            m.triangles
                .iter()
                .flatten()
                .map(|&v| m.positions[v as usize])
                .collect()
        };
        assert_eq!(positions(&back), positions(&expected), "{name}");
    }
    let text = fs::read_to_string(folder.path().join("a.obj")).unwrap();
    assert_eq!(text.matches("\no object").count(), 2, "{text}");
}

#[test]
fn damaged_scenes_are_not_written() {
    let folder = tempfile::tempdir().unwrap();
    let bad = [
        TriMesh::new(vec![Vec3::ZERO], vec![[0, 0, 1]]),
        TriMesh::new(vec![Vec3::NAN], vec![]),
    ];
    for mesh in bad {
        for name in ["a.obj", "a.ply", "a.stl", "a.off"] {
            let path = folder.path().join(name);
            let scene = Scene::from_mesh(mesh.clone());
            let error = write_with(&path, &scene, &WriteOptions::default()).unwrap_err();
            assert!(error.to_string().contains(name), "{error}");
        }
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// Non-manifold, one-sided, degenerate: no writer minds.
#[test]
fn the_zoo() {
    for (name, mesh) in karui::mesh::shapes::zoo() {
        for encoding in ENCODINGS {
            let mut held = mesh.clone();
            held.attributes.skins.clear();
            held.attributes.morphs.clear();
            held.ranges.clear();
            let back = through("a.ply", &mesh, &ply_options(encoding));
            assert_eq!(format!("{back:?}"), format!("{held:?}"), "{name}");
        }
        let back = through("a.obj", &mesh, &WriteOptions::default());
        assert_eq!(corners(&back), corners(&mesh), "{name}");
        for file in ["a.off", "a.stl"] {
            let back = through(file, &mesh, &WriteOptions::default());
            assert_eq!(back.triangles.len(), mesh.triangles.len(), "{name}");
        }
    }
}

#[test]
fn same_bytes_every_time() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.obj", "a.ply.gz", "a.off", "a.stl"] {
        let write = || {
            let path = folder.path().join(name);
            write_with(&path, &textured(), &WriteOptions::default()).unwrap();
            fs::read(&path).unwrap()
        };
        assert_eq!(write(), write(), "{name}");
    }
}

#[test]
fn empty_meshes() {
    for name in ["a.obj", "a.ply", "a.stl", "a.off"] {
        let back = through(name, &TriMesh::default(), &WriteOptions::default());
        assert_same(&back, &TriMesh::default());
    }
    assert!(Path::new("a.obj").is_relative());
}

/// Any finite number, subnormal ones included; not -0, which STL turns to 0.
fn number() -> impl Strategy<Value = f32> {
    let any = prop::num::f32::NORMAL | prop::num::f32::SUBNORMAL | prop::num::f32::POSITIVE;
    any.prop_map(|v| if v.is_finite() { v + 0.0 } else { 1.5 })
}

fn unit() -> impl Strategy<Value = f32> {
    (-(1i32 << 22)..1 << 22).prop_map(|i| i as f32 / (1 << 22) as f32)
}

fn vec3(v: [f32; 3]) -> Vec3 {
    v.into()
}

prop_compose! {
    fn mesh()(vertices in 1usize..20)(
        positions in prop::collection::vec(prop::array::uniform3(number()).prop_map(vec3), vertices),
        triangles in prop::collection::vec(prop::array::uniform3(0..vertices as u32), 0..20),
        normals in prop::option::of(prop::collection::vec(prop::array::uniform3(unit()).prop_map(vec3), vertices)),
        uvs in prop::option::of(prop::collection::vec(prop::array::uniform2(unit()).prop_map(Vec2::from), vertices)),
        colors in prop::option::of(prop::collection::vec(prop::array::uniform4(0f32..1.0).prop_map(Vec4::from), vertices)),
        bytes in any::<bool>(),
    ) -> TriMesh {
        let mut mesh = TriMesh::new(positions, triangles);
        mesh.attributes.normals = normals;
        mesh.attributes.uvs.extend(uvs);
        let byte = |c: f32| if bytes { (c * 255.0).round() / 255.0 } else { c };
        let rounded = |c: Vec<Vec4>| c.iter().map(|c| c.to_array().map(byte).into()).collect();
        mesh.attributes.colors.extend(colors.map(rounded));
        mesh
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn ply(mesh in mesh(), encoding in prop::sample::select(&ENCODINGS[..])) {
        assert_same(&through("a.ply", &mesh, &ply_options(encoding)), &mesh);
    }

    #[test]
    fn off(mesh in mesh()) {
        assert_same(&through("a.off", &mesh, &WriteOptions::default()), &mesh);
    }

    #[test]
    fn obj(mesh in mesh()) {
        let back = through("a.obj", &mesh, &WriteOptions::default());
        prop_assert_eq!(corners(&back), corners(&mesh));
    }

    #[test]
    fn stl(mesh in mesh(), stl_ascii in any::<bool>()) {
        let options = WriteOptions { stl_ascii, ..WriteOptions::default() };
        let back = through("a.stl", &mesh, &options);
        let positions = |m: &TriMesh| -> Vec<Vec3> {
            m.triangles.iter().flatten().map(|&v| m.positions[v as usize]).collect()
        };
        prop_assert_eq!(positions(&back), positions(&mesh));
    }
}
