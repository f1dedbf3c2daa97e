use crate::{Format, read_bytes, read_poly_bytes};
use karui::{
    TriMesh,
    geom::{Vec2, Vec4},
    mesh::AttributeValues,
};

fn load(text: &str) -> (TriMesh, Vec<String>) {
    let loaded = read_bytes(Format::Ply, text.as_bytes(), "t.ply").unwrap();
    let warnings = loaded.warnings;
    (loaded.scene.into_single_mesh().unwrap(), warnings)
}

/// Four vertices with further properties, then further elements.
fn file(properties: &str, values: [&str; 4], elements: &str, rows: &str) -> String {
    let corners = ["0 0 0", "1 0 0", "1 1 0", "0 1 0"];
    let vertices: String = corners
        .iter()
        .zip(values)
        .map(|(corner, value)| format!("{corner} {value}\n"))
        .collect();
    format!(
        "ply\nformat ascii 1.0\ncomment c\nobj_info i\nelement vertex 4\nproperty float x\n\
         property double y\nproperty int z\n{properties}{elements}end_header\n{vertices}{rows}"
    )
}

const FACE: &str = "element face 1\nproperty list uchar int vertex_index\n";
const NONE: [&str; 4] = [""; 4];

#[test]
fn strips_turn_every_other_triangle() {
    let strips = "element tristrips 1\nproperty list int int vertex_indices\n";
    let (mesh, _) = load(&file("", NONE, strips, "9 0 1 3 2 -1 3 3 0 1\n"));
    assert_eq!(mesh.triangles, [[0, 1, 3], [3, 1, 2], [0, 3, 1]]);
}

#[test]
fn unknown_elements_are_skipped_wherever_they_are() {
    let before = "element camera 2\nproperty list uchar float pose\nproperty char id\n";
    let after = "element edge 1\nproperty int vertex1\n";
    let elements = format!("{before}{FACE}{after}");
    let text = file("", NONE, &elements, "2 0.5 1 7\n0 7\n4 0 1 2 3\n9\n");
    let (mesh, warnings) = load(&text);
    assert_eq!(mesh.triangles.len(), 2);
    let expected = [
        "element `camera` was passed over",
        "element `edge` was passed over",
    ];
    assert_eq!(warnings, expected);
    let poly = read_poly_bytes(Format::Ply, text.as_bytes(), "t.ply").unwrap();
    assert_eq!(poly.face(0), [0, 1, 2, 3]);
}

#[test]
fn point_clouds_are_meshes_without_triangles() {
    let (mesh, warnings) = load(&file("", NONE, "", ""));
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (4, 0));
    assert_eq!(warnings, ["the file holds points but no faces"]);
}

#[test]
fn names_of_other_tools() {
    let names = "property float texture_u\nproperty float texture_v\n\
                 property ushort diffuse_red\nproperty ushort diffuse_green\n\
                 property ushort diffuse_blue\n";
    let row = "0.25 0.25 65535 0 13107";
    let (mesh, _) = load(&file(names, [row; 4], FACE, "3 0 1 2\n"));
    assert_eq!(mesh.attributes.uvs[0][0], Vec2::new(0.25, 0.75));
    assert_eq!(mesh.attributes.colors[0][0], Vec4::new(1.0, 0.0, 0.2, 1.0));
    assert!(mesh.attributes.custom.is_empty());
}

#[test]
fn unknown_properties_are_kept() {
    let names = "property float f_0\nproperty float f_1\nproperty uchar red\n\
                 property list uchar short pair\nproperty list uchar short ragged\n";
    let rows = [
        "1 2 9 2 5 6 0",
        "3 4 9 2 7 8 1 1",
        "5 6 9 2 1 1 0",
        "7 8 9 2 0 0 0",
    ];
    let (mesh, warnings) = load(&file(names, rows, FACE, "3 0 1 2\n"));
    let custom = &mesh.attributes.custom;
    let found: Vec<_> = custom
        .iter()
        .map(|a| (a.name.as_str(), a.components))
        .collect();
    assert_eq!(found, [("f", 2), ("red", 1), ("pair", 2)]);
    let f = AttributeValues::F32(vec![1., 2., 3., 4., 5., 6., 7., 8.]);
    assert_eq!(custom[0].values, f);
    assert_eq!(
        custom[2].values,
        AttributeValues::I16(vec![5, 6, 7, 8, 1, 1, 0, 0])
    );
    assert_eq!(
        warnings,
        ["lists of varying length `ragged` were passed over"]
    );
}

#[test]
fn faces_of_two_corners_go_with_their_properties() {
    let face = "element face 3\nproperty uchar red\nproperty list uchar uint vertex_indices\n\
                property uchar green\nproperty uchar blue\nproperty float q\n";
    let rows = "1 3 0 1 2 2 3 0.5\n4 2 0 1 5 6 1.5\n7 4 0 1 2 3 8 9 2.5\n";
    let (mesh, warnings) = load(&file("", NONE, face, rows));
    assert_eq!(warnings, ["faces of fewer than 3 corners were passed over"]);
    let colors = AttributeValues::U8(vec![1, 2, 3, 7, 8, 9, 7, 8, 9]);
    assert_eq!(mesh.face_attributes[0].values, colors);
    let q = AttributeValues::F32(vec![0.5, 2.5, 2.5]);
    assert_eq!(mesh.face_attributes[1].values, q);
}
