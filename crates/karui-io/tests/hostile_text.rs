//! Damaged and hostile OBJ, PLY, STL, OFF and gzip files: each gives a typed
//! error that names the place, quickly, and none a panic.

#![allow(clippy::unwrap_used, reason = "a test")]

use flate2::{Compression, write::GzEncoder};
use karui_io::{Error, ErrorKind, Format, Place, read, read_bytes, read_poly_bytes};
use std::{fs, io::Write};

/// What kind of error is expected.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Syntax,
    Truncated,
    Index,
    NotFinite,
    TooLarge,
    Unsupported,
    Mismatch,
    Unknown,
    Io,
}

fn kind(error: &Error) -> Kind {
    match *error.kind {
        ErrorKind::Syntax { .. } => Kind::Syntax,
        ErrorKind::Truncated { .. } => Kind::Truncated,
        ErrorKind::IndexOutOfRange { .. } => Kind::Index,
        ErrorKind::NotFinite { .. } => Kind::NotFinite,
        ErrorKind::TooLarge { .. } => Kind::TooLarge,
        ErrorKind::Unsupported(_) => Kind::Unsupported,
        ErrorKind::Mismatch { .. } => Kind::Mismatch,
        ErrorKind::UnknownFormat { .. } => Kind::Unknown,
        ErrorKind::Io(_) => Kind::Io,
        _ => panic!("unexpected error: {error}"),
    }
}

/// Reads the bytes both as a scene and as polygons; both must fail alike.
fn check(format: Format, bytes: &[u8], expected: Kind, place: Option<Place>) {
    let shown = String::from_utf8_lossy(&bytes[..bytes.len().min(60)]).into_owned();
    let error = match read_bytes(format, bytes, "x") {
        Ok(loaded) => panic!("{shown:?} loads: {:?}", loaded.warnings),
        Err(error) => error,
    };
    assert_eq!(kind(&error), expected, "{shown:?}: {error}");
    if let Some(place) = place {
        assert_eq!(error.place, place, "{shown:?}: {error}");
    }
    let poly = read_poly_bytes(format, bytes, "x").unwrap_err();
    assert_eq!(kind(&poly), expected, "{shown:?}: {poly}");
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

#[test]
fn obj() {
    let after = |line: &str| format!("{TRIANGLE}{line}\n").into_bytes();
    let line4 = Some(Place::Line(4));
    for (line, expected) in [
        ("v 1 2", Kind::Syntax),
        ("v 1 2 z", Kind::Syntax),
        ("v 1,5 0 0", Kind::Syntax),
        ("v", Kind::Syntax),
        ("v nan 0 0", Kind::NotFinite),
        ("v 0 -inf 0", Kind::NotFinite),
        ("v 0 0 1e999", Kind::NotFinite),
        ("v 0 0 -1.#IND", Kind::NotFinite),
        ("v 0 0 0 nan 0 0", Kind::NotFinite),
        ("vt nan 0", Kind::NotFinite),
        ("vt 0 1e400", Kind::NotFinite),
        // Fits 64 bits but not 32: found by fuzzing.
        (
            "vt 0 222222222222222222222222222222222222222222",
            Kind::NotFinite,
        ),
        ("vt", Kind::Syntax),
        ("vn 0 0", Kind::Syntax),
        ("vn 0 0 inf", Kind::NotFinite),
        ("f 1 2 4", Kind::Index),
        ("f 0 1 2", Kind::Index),
        ("f 1 2 -4", Kind::Index),
        ("f 1 2 4294967295", Kind::Index),
        ("f 1 2 4294967296", Kind::Index),
        ("f 1 2 4294967297", Kind::Index),
        ("f 1 2 -9223372036854775808", Kind::Syntax),
        ("f 1 2 99999999999999999999", Kind::Syntax),
        ("f 1 2 999999999999999999", Kind::Index),
        ("f 1/1 2/2 3/3", Kind::Index),
        ("f 1//1 2//2 3//3", Kind::Index),
        ("f 1/2/3/4 2 3", Kind::Syntax),
        ("f a b c", Kind::Syntax),
        ("f /1 2 3", Kind::Syntax),
        ("f 1 2 3.5", Kind::Syntax),
    ] {
        check(Format::Obj, &after(line), expected, line4.clone());
    }
    check(Format::Obj, b"", Kind::Truncated, None);
    check(Format::Obj, b"\0\0\0\0", Kind::Syntax, Some(Place::Line(1)));
    check(Format::Obj, b"<html>\n", Kind::Syntax, Some(Place::Line(1)));
    let mut binary: Vec<u8> = (0..=255).cycle().take(100_000).collect();
    binary.reverse();
    check(Format::Obj, &binary, Kind::Syntax, None);
}

#[test]
fn obj_in_bulk_is_linear() {
    // So much of it that quadratic time would be seen as a test that hangs.
    const MANY: usize = 600_000;
    // A face of very many corners, all at one vertex, each with its own
    // texture coordinate.
    let mut text = TRIANGLE.to_owned();
    text += &"vt 0.5 0.5\n".repeat(MANY);
    text += "f";
    for i in 1..=MANY {
        text += &format!(" 1/{i}");
    }
    read_bytes(Format::Obj, text.as_bytes(), "x").unwrap();
    // Very many materials, a line that goes on for ever, empty lines.
    let mut text = TRIANGLE.to_owned();
    for i in 0..MANY {
        text += &format!("usemtl m{i}\nf 1 2 3\n");
    }
    text += &"\\\n".repeat(100_000);
    text += &"\n".repeat(100_000);
    read_bytes(Format::Obj, text.as_bytes(), "x").unwrap();
}

/// A PLY file of a triangle, with `change` applied to its text.
fn ply(change: impl Fn(String) -> String) -> Vec<u8> {
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
                property float z\nelement face 1\nproperty list uchar int vertex_indices\n\
                end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    change(text.to_owned()).into_bytes()
}

#[test]
fn ply_headers() {
    assert!(read_bytes(Format::Ply, &ply(|t| t), "x").is_ok());
    for (from, to, expected) in [
        ("end_header\n", "", Kind::Syntax),
        ("ply\n", "plx\n", Kind::Syntax),
        ("format ascii 1.0\n", "", Kind::Syntax),
        ("ascii 1.0", "ascii 2.0", Kind::Unsupported),
        ("ascii", "binary", Kind::Syntax),
        ("float x", "floot x", Kind::Syntax),
        ("float x", "float", Kind::Syntax),
        ("float x", "float q", Kind::Syntax),
        ("list uchar int", "list float int", Kind::Syntax),
        ("list uchar int", "list uchar float", Kind::Unsupported),
        ("element vertex", "element point", Kind::Syntax),
        ("vertex 3", "vertex -3", Kind::Syntax),
        ("vertex 3", "vertex", Kind::Syntax),
        ("vertex 3", "vertex 2147483648", Kind::Truncated),
        ("vertex 3", "vertex 999999999999999999", Kind::Truncated),
        ("face 1", "face 4294967295", Kind::Truncated),
        ("face 1", "face 2", Kind::Truncated),
        ("element vertex 3\n", "", Kind::Syntax),
        ("list uchar int vertex_indices", "int flags", Kind::Syntax),
        ("end_header", "end", Kind::Syntax),
    ] {
        let bytes = ply(|t| t.replacen(from, to, 1));
        check(Format::Ply, &bytes, expected, None);
    }
    for n in [0, 3, 4, 21, 38] {
        let bytes = &ply(|t| t)[..n];
        let expected = if n < 3 { Kind::Syntax } else { Kind::Truncated };
        check(Format::Ply, bytes, expected, None);
    }
    let many = ply(|t| {
        t.replace(
            "float z\n",
            &("float z\n".to_owned() + &"property char c\n".repeat(20_000)),
        )
    });
    check(Format::Ply, &many, Kind::TooLarge, None);
    // Nothing to read a row from, so no time to spend on two billion of them.
    let empty = ply(|t| t.replace("element face", "element none 2147483648\nelement face"));
    assert!(read_bytes(Format::Ply, &empty, "x").is_ok());
}

#[test]
fn ply_text_bodies() {
    for (from, to, expected, line) in [
        ("1 0 0\n", "1 0\n", Kind::Syntax, 11),
        ("1 0 0\n", "1 a 0\n", Kind::Syntax, 11),
        ("1 0 0\n", "1 nan 0\n", Kind::NotFinite, 11),
        ("1 0 0\n", "1 0 1e39\n", Kind::NotFinite, 11),
        ("0 1 0\n", "\n\n0 inf 0\n", Kind::NotFinite, 14),
        ("3 0 1 2", "3 0 1 3", Kind::Index, 13),
        ("3 0 1 2", "3 0 1 -1", Kind::Index, 13),
        ("3 0 1 2", "3 0 1", Kind::Syntax, 13),
        ("3 0 1 2", "4 0 1 2", Kind::Syntax, 13),
        ("3 0 1 2", "-3 0 1 2", Kind::Syntax, 13),
        ("3 0 1 2", "4294967295 0 1 2", Kind::Syntax, 13),
        ("3 0 1 2", "3 0 1 99999999999", Kind::Syntax, 13),
    ] {
        let bytes = ply(|t| t.replacen(from, to, 1));
        check(Format::Ply, &bytes, expected, Some(Place::Line(line)));
    }
}

fn binary_ply(big: bool, vertices: &[[f32; 3]], faces: &[&[i32]]) -> Vec<u8> {
    let format = if big {
        "binary_big_endian"
    } else {
        "binary_little_endian"
    };
    let mut bytes = format!(
        "ply\nformat {format} 1.0\nelement vertex {}\nproperty float x\nproperty float y\n\
         property float z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
        vertices.len(),
        faces.len()
    )
    .into_bytes();
    let mut push = |value: [u8; 4]| bytes.extend(value);
    for &value in vertices.as_flattened() {
        push(if big {
            value.to_be_bytes()
        } else {
            value.to_le_bytes()
        });
    }
    for face in faces {
        bytes.push(face.len() as u8);
        for index in *face {
            bytes.extend(if big {
                index.to_be_bytes()
            } else {
                index.to_le_bytes()
            });
        }
    }
    bytes
}

const CORNERS: [[f32; 3]; 4] = [[0.; 3], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];

#[test]
fn ply_binary_bodies() {
    for big in [false, true] {
        let good = binary_ply(big, &CORNERS, &[&[0, 1, 2], &[0, 1, 2, 3]]);
        assert!(read_bytes(Format::Ply, &good, "x").is_ok());
        let body = good.len() - 4 * 12 - 13 - 17;
        for cut in body..good.len() {
            check(Format::Ply, &good[..cut], Kind::Truncated, None);
        }
        let regular = binary_ply(big, &CORNERS, &[&[0, 1, 2], &[0, 1, 4]]);
        let place = Some(Place::Byte((body + 4 * 12 + 13) as u64));
        check(Format::Ply, &regular, Kind::Index, place.clone());
        let mixed = binary_ply(big, &CORNERS, &[&[0, 1, 2], &[0, 1, -2, 3]]);
        check(Format::Ply, &mixed, Kind::Index, place);
        let mut corners = CORNERS;
        corners[2][1] = f32::NAN;
        let place = Some(Place::Byte(body as u64 + 24));
        check(
            Format::Ply,
            &binary_ply(big, &corners, &[]),
            Kind::NotFinite,
            place,
        );
    }
    // A list of four billion values.
    let mut bytes = b"ply\nformat binary_little_endian 1.0\nelement vertex 1\n\
        property list uint float x\nend_header\n"
        .to_vec();
    bytes.extend(u32::MAX.to_le_bytes());
    bytes.extend([0; 100]);
    check(Format::Ply, &bytes, Kind::Truncated, None);
    // A list of fewer than no values.
    let text = String::from_utf8_lossy(&bytes[..80]).replace("uint", "char");
    let bytes = [text.as_bytes(), &[0xff; 50]].concat();
    check(Format::Ply, &bytes, Kind::Syntax, None);
}

fn binary_stl(count: u32, facets: &[[f32; 12]]) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend(count.to_le_bytes());
    for facet in facets {
        facet.iter().for_each(|v| bytes.extend(v.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

#[test]
fn stl() {
    let good = binary_stl(2, &[[1.0; 12]; 2]);
    assert!(read_bytes(Format::Stl, &good, "x").is_ok());
    for cut in [0, 1, 79, 80, 83, 84, 85, 133, 134, 150, 183] {
        check(Format::Stl, &good[..cut], Kind::Truncated, None);
    }
    check(
        Format::Stl,
        &binary_stl(1 << 31, &[]),
        Kind::Truncated,
        None,
    );
    check(
        Format::Stl,
        &binary_stl(u32::MAX, &[[0.0; 12]]),
        Kind::Truncated,
        None,
    );
    check(
        Format::Stl,
        &binary_stl(1, &[[0.0; 12]; 3]),
        Kind::Syntax,
        None,
    );
    let mut bad = [[0.0; 12]; 2];
    bad[1][4] = f32::INFINITY;
    let place = Some(Place::Byte(84 + 50 + 12));
    check(Format::Stl, &binary_stl(2, &bad), Kind::NotFinite, place);
}

#[test]
fn stl_text() {
    let good = "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n\
                vertex 0 1 0\nendloop\nendfacet\nendsolid s\n";
    for (from, to, expected, line) in [
        ("vertex 1 0 0", "vertex 1 nan 0", Kind::NotFinite, 5),
        ("vertex 1 0 0", "vertex 1 x 0", Kind::Syntax, 5),
        ("vertex 1 0 0", "vertex 1 0", Kind::Syntax, 6),
        ("vertex 1 0 0\n", "", Kind::Syntax, 6),
        ("facet normal", "face normal", Kind::Syntax, 2),
        ("endloop", "endlop", Kind::Syntax, 7),
        ("endfacet", "facet", Kind::Syntax, 8),
        ("outer loop", "outer lop", Kind::Syntax, 3),
    ] {
        let text = good.replacen(from, to, 1);
        check(
            Format::Stl,
            text.as_bytes(),
            expected,
            Some(Place::Line(line)),
        );
    }
    for end in ["facet normal", "outer loop", "vertex 1", "endloop"] {
        let cut = good.find(end).unwrap() + end.len();
        check(Format::Stl, &good.as_bytes()[..cut], Kind::Truncated, None);
    }
}

#[test]
fn off() {
    let good = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    assert!(read_bytes(Format::Off, good.as_bytes(), "x").is_ok());
    for (from, to, expected) in [
        ("OFF\n", "OFX\n", Kind::Syntax),
        ("OFF\n", "OFF BINARY\n", Kind::Unsupported),
        ("OFF\n", "4OFF\n", Kind::Unsupported),
        ("OFF\n", "nOFF\n", Kind::Unsupported),
        ("OFF\n", "COFF\n", Kind::Syntax),
        ("OFF\n", "NOFF\n", Kind::Truncated),
        ("OFF\n", "STOFF\n", Kind::Syntax),
        ("3 1 0\n", "", Kind::Syntax),
        ("3 1 0\n", "-3 1 0\n", Kind::Syntax),
        ("3 1 0\n", "3 x 0\n", Kind::Syntax),
        ("3 1 0\n", "2147483648 1 0\n", Kind::Truncated),
        ("3 1 0\n", "3 2147483648 0\n", Kind::Truncated),
        ("3 1 0\n", "3 2 0\n", Kind::Truncated),
        ("3 1 0\n", "4 1 0\n", Kind::Truncated),
        ("1 0 0", "1 nan 0", Kind::NotFinite),
        ("1 0 0", "1 y 0", Kind::Syntax),
        ("3 0 1 2", "3 0 1 3", Kind::Index),
        ("3 0 1 2", "3 0 1 -1", Kind::Index),
        ("3 0 1 2", "3 0 1", Kind::Truncated),
        ("3 0 1 2", "4294967296 0 1 2", Kind::Truncated),
        ("3 0 1 2", "-1 0 1 2", Kind::Syntax),
        ("3 0 1 2", "3 0 1 2 0.5 nan 0.5", Kind::NotFinite),
    ] {
        let text = good.replacen(from, to, 1);
        check(Format::Off, text.as_bytes(), expected, None);
    }
    let far = b"STOFF\n3 1 0\n0 0 0 0 1e39\n1 0 0 0 0\n0 1 0 0 0\n3 0 1 2\n";
    check(Format::Off, far, Kind::NotFinite, Some(Place::Line(3)));
    check(Format::Off, b"", Kind::Truncated, None);
    check(Format::Off, b"OFF", Kind::Truncated, None);
}

fn gz(content: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(content).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn files() {
    let folder = tempfile::tempdir().unwrap();
    let good = gz(format!("{TRIANGLE}f 1 2 3\n").as_bytes());
    let mut damaged = good.clone();
    let middle = damaged.len() / 2;
    damaged[middle] ^= 0xff;
    let cases: [(&str, &[u8], Kind); 12] = [
        ("cut.obj.gz", &good[..good.len() - 6], Kind::Truncated),
        ("head.obj.gz", &good[..5], Kind::Truncated),
        ("damaged.obj.gz", &damaged, Kind::Syntax),
        ("none.obj.gz", b"", Kind::Truncated),
        ("plain.obj.gz", TRIANGLE.as_bytes(), Kind::Mismatch),
        ("packed.obj", &good, Kind::Mismatch),
        ("twice.obj.gz", &gz(&good), Kind::Syntax),
        ("wrong.obj", b"ply\nformat ascii 1.0\n", Kind::Mismatch),
        ("wrong.ply", b"OFF\n0 0 0\n", Kind::Mismatch),
        ("wrong.stl", b"glTF\x02\0\0\0", Kind::Mismatch),
        ("unknown.fbx", b"Kaydara FBX Binary", Kind::Unknown),
        ("noname", b"v 0 0 0\n", Kind::Unknown),
    ];
    for (name, content, expected) in cases {
        let path = folder.path().join(name);
        fs::write(&path, content).unwrap();
        let error = read(&path).map(drop).unwrap_err();
        assert_eq!(kind(&error), expected, "{error}");
        assert_eq!(error.path, path);
    }
    fs::create_dir(folder.path().join("folder.obj")).unwrap();
    for name in ["folder.obj", "missing.ply", "missing/a.stl", "nul\0.obj"] {
        let error = read(folder.path().join(name)).map(drop).unwrap_err();
        assert_eq!(kind(&error), Kind::Io, "{error}");
    }
    if cfg!(unix) {
        let error = read("/dev/null").map(drop).unwrap_err();
        assert_eq!(kind(&error), Kind::Io, "{error}");
    }
}

#[test]
fn bombs() {
    let folder = tempfile::tempdir().unwrap();
    for (i, unit) in ["\n", "v 0 0 0\n", "\0"].iter().enumerate() {
        let bomb = gz(unit.repeat((70 << 20) / unit.len()).as_bytes());
        assert!(bomb.len() < 2 << 20);
        let path = folder.path().join(format!("bomb{i}.obj.gz"));
        fs::write(&path, bomb).unwrap();
        let error = read(&path).map(drop).unwrap_err();
        assert_eq!(kind(&error), Kind::TooLarge, "{error}");
    }
}

#[test]
fn companions_stay_in_the_folder() {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("model");
    fs::create_dir(&model).unwrap();
    fs::write(folder.path().join("secret.mtl"), "newmtl leaked\n").unwrap();
    fs::write(
        model.join("own.mtl"),
        "newmtl m\nmap_Kd ../secret.mtl\nmap_Ke /etc/passwd\n",
    )
    .unwrap();
    let text = format!("mtllib ../secret.mtl\nmtllib own.mtl\n{TRIANGLE}usemtl m\nf 1 2 3\n");
    let path = model.join("a.obj");
    fs::write(&path, text).unwrap();
    let loaded = karui_io::read_with(&path, &Default::default()).unwrap();
    assert_eq!(loaded.scene.materials.len(), 1);
    let leaves = |w: &&String| w.contains("leaves the folder");
    // One for the path that both files name, one for the other.
    assert_eq!(
        loaded.warnings.iter().filter(leaves).count(),
        2,
        "{:?}",
        loaded.warnings
    );
    let missing = |i: &karui::mesh::Image| matches!(i.data, karui::mesh::ImageData::Missing { .. });
    assert!(loaded.scene.images.iter().all(missing));
}

/// Cuts and single changed bytes may or may not be noticed, but never panic.
#[test]
fn any_cut_and_any_changed_byte() {
    let stl_text = "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n\
                    vertex 0 1 0\nendloop\nendfacet\nendsolid s\n";
    let off = "STCNOFF\n3 1 0\n0 0 0 0 0 1 9 9 9 0 1\n1 0 0 0 0 1 1 1 1 1 1\n\
               0 1 0 0 0 1 2 2 2 0 0\n3 0 1 2 9 9 9\n";
    let obj = "mtllib a.mtl\nv 0 0 0 1 1 1\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nusemtl a\n\
               f 1/1/1 2/1/1 3/1/1\n";
    let samples: [(Format, Vec<u8>); 7] = [
        (Format::Obj, obj.into()),
        (Format::Off, off.into()),
        (Format::Stl, stl_text.into()),
        (Format::Stl, binary_stl(2, &[[1.0; 12]; 2])),
        (Format::Ply, ply(|t| t)),
        (
            Format::Ply,
            binary_ply(false, &CORNERS, &[&[0, 1, 2], &[3, 1, 2]]),
        ),
        (
            Format::Ply,
            binary_ply(true, &CORNERS, &[&[0, 1, 2, 3], &[3, 1, 2]]),
        ),
    ];
    for (format, sample) in samples {
        assert!(read_bytes(format, &sample, "x").is_ok());
        for cut in 0..sample.len() {
            drop(read_bytes(format, &sample[..cut], "x"));
        }
        for at in 0..sample.len() {
            for byte in [0, 1, b' ', b'-', b'9', b'\n', 0x7f, 0x80, 0xff] {
                let mut changed = sample.clone();
                changed[at] = byte;
                if let Ok(loaded) = read_bytes(format, &changed, "x") {
                    loaded.scene.validate().unwrap();
                }
            }
        }
    }
}
