//! What fuzzing has found, each cut down to the least that shows it.

use karui_io::{Format, read_bytes};

/// The scene if it was accepted; then it must be valid.
fn read(format: Format, bytes: &[u8]) -> Option<karui::Scene> {
    let scene = read_bytes(format, bytes, "find").ok()?.scene;
    scene.validate().expect("what a reader accepts is valid");
    Some(scene)
}

/// `read_obj`: v is parsed in double precision, where 2e50 is finite, and was
/// infinite once narrowed.
#[test]
fn obj_texture_coordinate_beyond_single_precision() {
    let with_v = |v: &str| {
        let digits = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.3 {v}\nf 1/1 2/1 3/1\n");
        read(Format::Obj, digits.as_bytes())
    };
    assert!(with_v(&format!("{}.6", "2".repeat(51))).is_none());
    assert!(with_v("0.6").is_some());
}
