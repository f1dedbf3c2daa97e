#![no_main]

use karui::mesh::shapes;
use karui::simplify::{CollapseLog, Stop};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    // Hashes are hard to guess, so that a seed should be a log of one of these.
    let meshes = [shapes::icosphere(1), shapes::loaded_sphere(6, 8)];
    let Ok(log) = CollapseLog::from_bytes(bytes) else {
        return;
    };
    let again = CollapseLog::from_bytes(&log.to_bytes()).expect("what was written is read");
    assert_eq!(again.len(), log.len());
    for mesh in &meshes {
        if let Ok(level) = log.level(mesh, Stop::default()) {
            level.mesh.validate().expect("the level is valid");
            assert_eq!(level.map.len(), mesh.positions.len());
        }
    }
});
