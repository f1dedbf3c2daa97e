use crate::{Format, Loaded, Result, read_bytes, read_poly_bytes};
use karui::{
    geom::{Vec2, Vec3, Vec4},
    mesh::{AlphaMode, Wrap},
};

fn load(text: &str) -> Result<Loaded> {
    read_bytes(Format::Obj, text.as_bytes(), "t.obj")
}

#[test]
fn corners_with_equal_indices_are_one_vertex() {
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0.25\nvn 0 0 1\n\
                f 1/1/1 2/2/1 3/1/1\nf -4/1/-1 3/1/1 4/2/1\nf 2/1/1 3/1/1 4/2/1\n";
    let mesh = &load(text).unwrap().scene.meshes[0].mesh;
    assert_eq!(
        mesh.triangles,
        [[0, 1, 3], [0, 3, 4], [2, 3, 4]].map(|t| t.map(order))
    );
    assert_eq!(mesh.positions.len(), 5);
    assert_eq!(mesh.attributes.uvs[0][0], Vec2::new(0.0, 1.0));
    assert_eq!(mesh.attributes.normals.as_ref().unwrap(), &[Vec3::Z; 5]);

    // Vertices are ordered by position, then texture coordinate: position 2
    // with coordinate 1 comes before position 2 with coordinate 2.
    fn order(v: u32) -> u32 {
        [0, 2, 1, 3, 4][v as usize]
    }
}

#[test]
fn lines_may_go_on_and_end_anyhow() {
    let text = "v 0 0 \\\r\n 0\r\nv 1 0 0\r\nv 0 1 0 # corner\r\nf 1 2 \\\n\\\n3 # face";
    let mesh = &load(text).unwrap().scene.meshes[0].mesh;
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
}

#[test]
fn colours_of_both_scales() {
    let face = "v 0 0 1\nf 1 2 3\n";
    let of = |first: &str| {
        let text = format!("{first}{face}");
        load(&text).unwrap().scene.meshes[0].mesh.attributes.colors[0].clone()
    };
    let fractions = of("v 0 0 0 1 0.5 0\nv 1 0 0 0 0 1\n");
    assert_eq!(fractions[0], Vec4::new(1.0, 0.5, 0.0, 1.0));
    assert_eq!(fractions[2], Vec4::ONE);
    let bytes = of("v 0 0 0 255 51 0\nv 1 0 0 0 0 1\n");
    assert_eq!(bytes[0], Vec4::new(1.0, 0.2, 0.0, 1.0));
}

#[test]
fn polygons_and_materials() {
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nusemtl a\nf 1 2 3\nusemtl b b\n\
                f 2 3 4\nusemtl a\nf 1 3 4\nl 1 2\n";
    let poly = read_poly_bytes(Format::Obj, text.as_bytes(), "t.obj").unwrap();
    assert_eq!(poly.face(0), [0, 1, 2, 3]);
    assert_eq!(poly.face_materials, [None, Some(0), Some(1), Some(0)]);
    let loaded = load(text).unwrap();
    assert_eq!(loaded.scene.materials[1].name.as_deref(), Some("b b"));
    let mesh = &loaded.scene.meshes[0].mesh;
    let counts: Vec<_> = mesh.ranges.iter().map(|r| (r.count, r.material)).collect();
    assert_eq!(counts, [(2, None), (2, Some(0)), (1, Some(1))]);
    assert_eq!(loaded.warnings, ["lines and points were passed over"]);
}

#[test]
fn missing_normals_are_made() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 1 0 0\nf 1//1 2 3\n";
    let mesh = &load(text).unwrap().scene.meshes[0].mesh;
    let normals = mesh.attributes.normals.as_ref().unwrap();
    assert_eq!(normals[..], [Vec3::X, Vec3::Z, Vec3::Z]);
}

#[test]
fn errors_name_the_line() {
    let start = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (rest, expected) in [
        ("v 1 2", "line 4: expected 3 numbers, found 2"),
        (
            "f 1 2 4",
            "line 4: vertex index 4 is out of range; there are 3",
        ),
        (
            "f 1 2 -4",
            "line 4: vertex index -4 is out of range; there are 3",
        ),
        (
            "f 0 1 2",
            "line 4: vertex index 0 is out of range; there are 3",
        ),
        (
            "\nf 1/1 2 3",
            "line 5: texture coordinate index 1 is out of range; there are 0",
        ),
        ("f 1 2 x", "line 4: expected a vertex index, found `x`"),
        (
            "f 1/1/1/1 2 3",
            "line 4: expected at most v/vt/vn, found `1/1/1/1`",
        ),
        (
            "v 1 nan 0",
            "line 4: vertex coordinate is not finite (NaN or infinite, or too large for 32 bits)",
        ),
    ] {
        let error = load(&format!("{start}{rest}\n")).unwrap_err();
        let expected = format!("t.obj: {expected}");
        // Indices are looked up while the line is read.
        let found = error.to_string();
        assert_eq!(found, expected);
    }
}

#[test]
fn material_statements() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let library = "newmtl a\nKd 0.5 0.25 1\nNs 48\nTr 0.25\nKe 1 0 0\n\
                   map_Kd -clamp on -s 2 4 -o 0.5 tex ture.png\nmap_d tex ture.png\n\
                   bump -bm 0.5 b.png\nillum 2\n\
                   newmtl b\nPr 0.5\nNs 1000\nPm 1\nnorm b.png\nmap_Ks b.png\nKd 0.5\n\
                   newmtl c\nd bad\n";
    std::fs::write(at("my lib.mtl"), library).unwrap();
    std::fs::write(at("tex ture.png"), "png").unwrap();
    let model = "mtllib my lib.mtl\nmtllib my lib.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n\
                 usemtl b\nf 1 2 3\nusemtl d\nf 1 2 3\n";
    std::fs::write(at("m.obj"), model).unwrap();
    let loaded = crate::read_with(at("m.obj"), &Default::default()).unwrap();
    let expected = [
        "texture `b.png` was not found",
        "`map_ks b.png` was passed over",
        "my lib.mtl: line 18: expected a number (material value), found `bad`",
        "material `d` is in no library",
    ];
    assert_eq!(loaded.warnings, expected);
    let [a, b, _, d] = &loaded.scene.materials[..] else {
        panic!("{:?}", loaded.scene.materials);
    };
    assert_eq!(a.base_color, Vec4::new(0.5, 0.25, 1.0, 0.75));
    assert_eq!(a.alpha_mode, AlphaMode::Blend);
    assert_eq!((a.roughness, a.metallic), (0.2, 0.0));
    assert_eq!((b.roughness, b.metallic), (0.5, 1.0));
    assert_eq!(b.base_color, Vec4::new(0.5, 0.5, 0.5, 1.0));
    assert_eq!(a.normal_scale, 0.5);
    assert_eq!(d.name.as_deref(), Some("d"));
    let texture = a.base_color_texture.unwrap();
    let transform = texture.transform.unwrap();
    assert_eq!(transform.scale, Vec2::new(2.0, 4.0));
    // v' = 0 + 4 v from below is v' = (1 - 4) + 4 v from above.
    assert_eq!(transform.offset, Vec2::new(0.5, -3.0));
    let found = &loaded.scene.textures[texture.texture as usize];
    assert_eq!(found.wrap, [Wrap::Clamp; 2]);
    assert_eq!(loaded.scene.images.len(), 2);
}
