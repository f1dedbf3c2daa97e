//! PLY in slices.

use crate::{assert_same, common, outcome, unpacked, whole};
use karui::TriMesh;
use karui_io::{Format, PlyEncoding, WriteOptions, read_bytes, slices};
use proptest::{collection::vec, prelude::*};
use std::fs;

#[test]
fn real_models() {
    let Some(models) = common::models() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    for name in [
        "hard/cycloidal.ply",
        "hard/featuretype.ply",
        "hard/octagonal_pocket.ply",
        "scans/bun_zipper.ply.gz",
        "scans/dragon_vrip.ply.gz",
        "scans/dragon_vrip_res2.ply.gz",
        "scans/dragon_vrip_res4.ply.gz",
    ] {
        let path = unpacked(&models.join(name), folder.path());
        let source = slices::open(&path).unwrap();
        assert_same(&*source, &whole(&path), 100_003, name);
    }
}

#[test]
fn real_models_in_all_encodings() {
    let Some(models) = common::models() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    for name in [
        "scans/armadillo.off.gz",
        "gltf/Fox.glb",
        "hard/sponza.obj.gz",
    ] {
        let scene = karui_io::read(models.join(name)).unwrap();
        for ply in [
            PlyEncoding::Ascii,
            PlyEncoding::BinaryLittleEndian,
            PlyEncoding::BinaryBigEndian,
        ] {
            let path = folder.path().join("a.ply");
            let options = WriteOptions {
                ply,
                ..WriteOptions::default()
            };
            karui_io::write_with(&path, &scene, &options).unwrap();
            let source = slices::open(&path).unwrap();
            assert_same(&*source, &whole(&path), 50_021, name);
        }
    }
}

/// A PLY file written plainly, value after value.
struct Made {
    encoding: usize,
    text: String,
    bytes: Vec<u8>,
}

impl Made {
    fn new(encoding: usize, header: &str) -> Self {
        let format = ["ascii", "binary_little_endian", "binary_big_endian"][encoding];
        Self {
            encoding,
            text: String::new(),
            bytes: format!("ply\nformat {format} 1.0\n{header}end_header\n").into_bytes(),
        }
    }

    fn float(&mut self, value: f32) {
        match self.encoding {
            0 => self.text += &format!("{value} "),
            1 => self.bytes.extend(value.to_le_bytes()),
            _ => self.bytes.extend(value.to_be_bytes()),
        }
    }

    fn byte(&mut self, value: u8) {
        match self.encoding {
            0 => self.text += &format!("{value} "),
            _ => self.bytes.push(value),
        }
    }

    fn int(&mut self, value: i32) {
        match self.encoding {
            0 => self.text += &format!("{value} "),
            1 => self.bytes.extend(value.to_le_bytes()),
            _ => self.bytes.extend(value.to_be_bytes()),
        }
    }

    fn end_row(&mut self) {
        if self.encoding == 0 {
            self.bytes.extend(self.text.as_bytes());
            self.bytes.push(b'\n');
            self.text.clear();
        }
    }
}

/// What a made file has, besides positions and corners.
#[derive(Debug, Clone)]
struct Shape {
    encoding: usize,
    points: Vec<[f32; 3]>,
    faces: Vec<Vec<usize>>,
    vertex_list: bool,
    face_byte: bool,
    before: bool,
    after: bool,
}

fn made(shape: &Shape) -> Vec<u8> {
    let list = if shape.vertex_list {
        "property list uchar int ring\n"
    } else {
        ""
    };
    let flag = if shape.face_byte {
        "property uchar q\n"
    } else {
        ""
    };
    let before = if shape.before {
        "element pose 2\nproperty list int float m\n"
    } else {
        ""
    };
    let after = if shape.after {
        "element edge 3\nproperty int a\n"
    } else {
        ""
    };
    let header = format!(
        "{before}element vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         {list}property uchar red\nproperty uchar green\nproperty uchar blue\n\
         property float q_0\nproperty float q_1\n\
         element face {}\n{flag}property list uchar int vertex_indices\n{after}",
        shape.points.len(),
        shape.faces.len(),
    );
    let mut file = Made::new(shape.encoding, &header);
    for row in 0..2 * usize::from(shape.before) {
        file.int(row as i32);
        (0..row).for_each(|v| file.float(v as f32));
        file.end_row();
    }
    for (i, point) in shape.points.iter().enumerate() {
        point.iter().for_each(|&x| file.float(x));
        if shape.vertex_list {
            file.byte((i % 3) as u8);
            (0..i % 3).for_each(|v| file.int(v as i32));
        }
        (0..3).for_each(|c| file.byte((i * 7 + c) as u8));
        (0..2).for_each(|c| file.float((i * 2 + c) as f32));
        file.end_row();
    }
    for (i, face) in shape.faces.iter().enumerate() {
        if shape.face_byte {
            file.byte(i as u8);
        }
        file.byte(face.len() as u8);
        face.iter()
            .for_each(|&v| file.int((v % shape.points.len()) as i32));
        file.end_row();
    }
    for row in 0..3 * i32::from(shape.after) {
        file.int(row);
        file.end_row();
    }
    file.bytes
}

fn shape() -> impl Strategy<Value = Shape> {
    let corner = -8i32..8;
    let point = [corner.clone(), corner.clone(), corner].prop_map(|p| p.map(|x| x as f32 / 4.0));
    let any_faces = vec(vec(0usize..1000, 0..8), 0..30);
    let faces = prop_oneof![
        any_faces,
        vec(vec(0usize..1000, 3), 0..30),
        vec(vec(0usize..1000, 4), 0..30)
    ];
    let flags = any::<[bool; 4]>();
    (0usize..3, vec(point, 1..40), faces, flags).prop_map(|(encoding, points, faces, f)| Shape {
        encoding,
        points,
        faces,
        vertex_list: f[0],
        face_byte: f[1],
        before: f[2],
        after: f[3],
    })
}

/// The mesh read whole, without what slices leave aside.
fn expected(bytes: &[u8]) -> Result<TriMesh, String> {
    let loaded = read_bytes(Format::Ply, bytes, "a.ply").map_err(|e| e.to_string())?;
    let mut mesh = loaded.scene.into_single_mesh().map_err(|e| e.to_string())?;
    mesh.attributes.custom.retain(|a| a.name != "ring");
    Ok(mesh)
}

proptest! {
    #[test]
    fn made_files(shape in shape(), step in 1u64..50) {
        let bytes = made(&shape);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ply");
        fs::write(&path, &bytes).unwrap();
        let mesh = expected(&bytes).unwrap();
        // Three corners on average prove nothing if one face has fewer.
        let corners: usize = shape.faces.iter().map(Vec::len).sum();
        let misleading = corners == 3 * shape.faces.len()
            && shape.faces.iter().any(|f| f.len() != 3)
            && shape.faces[0].len() == 3
            && shape.encoding > 0;
        prop_assume!(!misleading);
        let source = slices::open(&path).unwrap();
        assert_same(&*source, &mesh, step, "made");
    }
}

fn small(encoding: usize, faces: &[&[usize]]) -> Vec<u8> {
    made(&Shape {
        encoding,
        points: vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
        ],
        faces: faces.iter().map(|f| f.to_vec()).collect(),
        vertex_list: false,
        face_byte: true,
        before: false,
        after: false,
    })
}

#[test]
fn truncated_at_every_byte() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ply");
    for encoding in 0..3 {
        for faces in [
            &[&[0, 1, 2][..], &[0, 2, 3]][..],
            &[&[0, 1, 2, 3][..], &[0, 1, 2]],
        ] {
            let bytes = small(encoding, faces);
            for end in 0..bytes.len() {
                fs::write(&path, &bytes[..end]).unwrap();
                // A text may lack the end of its last line, and digits of its last number.
                let wanted = expected(&bytes[..end]).map(|m| m.triangles);
                let found = outcome(&path).map(|(_, t)| t);
                match (wanted, found) {
                    (Ok(wanted), Ok(found)) => {
                        let wide: Vec<_> = wanted.iter().map(|t| t.map(u64::from)).collect();
                        assert_eq!(wide, found);
                    }
                    (Err(_), Err(error)) => assert!(error.contains("a.ply"), "{error}"),
                    (wanted, found) => panic!("{encoding} {end}: {wanted:?}, {found:?}"),
                }
            }
        }
    }
}

#[test]
fn any_byte_may_be_wrong() {
    for encoding in 0..3 {
        crate::damaged_everywhere(&small(encoding, &[&[0, 1, 2], &[0, 2, 3]]), "a.ply");
        crate::damaged_everywhere(&small(encoding, &[&[0, 1, 2, 3], &[0, 1, 2]]), "a.ply");
    }
}

#[test]
fn counts_that_lie_are_found_when_the_file_is_opened() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ply");
    for encoding in 0..3 {
        let good = small(encoding, &[&[0, 1, 2], &[0, 2, 3]]);
        for (from, to) in [
            ("vertex 4", "vertex 5000000000"),
            ("vertex 4", "vertex 999999999999999999"),
            ("face 2", "face 5000000000"),
            ("face 2", "face 999999999999999999"),
        ] {
            let at = good
                .windows(from.len())
                .position(|w| w == from.as_bytes())
                .unwrap();
            let bad = [&good[..at], to.as_bytes(), &good[at + from.len()..]].concat();
            fs::write(&path, &bad).unwrap();
            let error = slices::open(&path).err().unwrap().to_string();
            let place = if encoding == 0 { "line" } else { "byte" };
            assert!(
                error.contains("ends early") && error.contains(place),
                "{error}"
            );
        }
    }
}

#[test]
fn errors_name_the_place_in_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ply");
    let mut points: Vec<[f32; 3]> = vec![[0.5, 0.25, 1.0]; 10_000];
    points[9_000][1] = f32::NAN;
    let mut faces = vec![vec![0usize, 1, 2]; 200_000];
    faces[150_000] = vec![5, 6, 7, 8];
    for encoding in 0..3 {
        let shape = Shape {
            encoding,
            points: points.clone(),
            faces: faces.clone(),
            vertex_list: encoding == 2,
            face_byte: true,
            before: true,
            after: true,
        };
        let mut bytes = made(&shape);
        fs::write(&path, &bytes).unwrap();
        let source = slices::open(&path).unwrap();
        assert!(source.read_vertices(0..9_000).is_ok());
        let error = source.read_vertices(8_990..9_010).unwrap_err().to_string();
        let whole = read_bytes(Format::Ply, &bytes, &path)
            .unwrap_err()
            .to_string();
        // Past lists of varying length the place is near the row only.
        if encoding < 2 {
            assert_eq!(error, whole);
        }
        assert!(error.contains("not finite"), "{error}");
        if encoding != 1 {
            continue;
        }
        // Three corners, then the last edges.
        let index = bytes.len() - 3 * 4 - 4;
        bytes[index..index + 4].copy_from_slice(&10_000i32.to_le_bytes());
        fs::write(&path, &bytes).unwrap();
        let source = slices::open(&path).unwrap();
        assert!(source.read_triangles(0).is_ok());
        let error = source
            .read_triangles(source.chunks() - 1)
            .unwrap_err()
            .to_string();
        let place = format!("byte {}", bytes.len() - 3 * 4 - 14);
        assert!(
            error.contains("index 10000 is out of range; there are 10000"),
            "{error}"
        );
        assert!(error.contains(&place), "{error}, not {place}");
    }
}

#[test]
fn three_corners_on_average_are_an_error_not_nonsense() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ply");
    fs::write(&path, small(1, &[&[0, 1, 2], &[0, 1], &[0, 1, 2, 3]])).unwrap();
    let error = outcome(&path).unwrap_err();
    assert!(error.contains("as the size of the file tells"), "{error}");
}

#[test]
fn what_is_passed_over_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ply");
    let shape = Shape {
        encoding: 1,
        points: vec![[0.0; 3]; 5],
        faces: vec![vec![0, 1, 2]],
        vertex_list: true,
        face_byte: true,
        before: true,
        after: true,
    };
    fs::write(&path, made(&shape)).unwrap();
    let warnings = slices::open_with(&path).unwrap().warnings;
    let expected = [
        "element `pose` was passed over",
        "element `edge` was passed over",
        "lists `ring` were passed over",
        "properties of faces were passed over",
    ];
    assert_eq!(warnings, expected);
    let strips = "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n\
                  property float z\nelement tristrips 0\nproperty list int int vertex_indices\n\
                  end_header\n";
    fs::write(&path, strips).unwrap();
    let error = slices::open(&path).err().unwrap().to_string();
    assert!(
        error.contains("strips in slices is not supported"),
        "{error}"
    );
}
