#![no_main]

use karui::geom::{Aabb, Camera, Vec3};
use karui::hierarchy::{Budget, Hierarchy, ViewAndLight, checksum};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    // A checksum is hard to guess, so it is put right.
    let Some(end) = bytes.len().checked_sub(8) else {
        return;
    };
    let mut sealed = bytes.to_vec();
    sealed[end..].copy_from_slice(&checksum(&bytes[..end]).to_le_bytes());
    let Ok(hierarchy) = Hierarchy::from_bytes(&sealed) else {
        return;
    };
    assert_eq!(hierarchy.to_bytes(), sealed);
    let mut cut = hierarchy.coarsest();
    for direction in [Vec3::X, -Vec3::Z] {
        let unit = Aabb {
            min: Vec3::splat(-1.0),
            max: Vec3::ONE,
        };
        let criteria = ViewAndLight {
            camera: Camera::looking_at(unit, direction, 0.6),
            ..ViewAndLight::default()
        };
        if cut.refine(&criteria, Budget::UNLIMITED).is_ok() {
            cut.validate().expect("what is taken can be cut");
        }
    }
});
