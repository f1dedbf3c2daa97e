#![no_main]

use karui::simplify::simplify;
use karui_fuzz::dirty::Dirty;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|dirty: Dirty| {
    let Ok(coarse) = simplify(&dirty.mesh, &dirty.options()) else {
        return;
    };
    coarse.mesh.validate().expect("the result is valid");
    assert!(coarse.mesh.triangles.len() <= dirty.mesh.triangles.len());
    assert!(coarse.error >= 0.0, "error {}", coarse.error);
});
