#![no_main]

use karui::simplify::{
    ClusterOptions, FoliageOptions, PruneOptions, cluster, foliage, prune, simplify,
};
use karui_fuzz::dirty::Dirty;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|dirty: Dirty| {
    collapsed(&dirty);
    clustered(&dirty);
    pruned(&dirty);
    thinned(&dirty);
});

fn collapsed(dirty: &Dirty) {
    let Ok(coarse) = simplify(&dirty.mesh, &dirty.options()) else {
        return;
    };
    coarse.mesh.validate().expect("the result is valid");
    assert!(coarse.mesh.triangles.len() <= dirty.mesh.triangles.len());
    assert!(coarse.error >= 0.0, "error {}", coarse.error);
}

fn clustered(dirty: &Dirty) {
    let all = dirty.options();
    let options = ClusterOptions {
        stop: all.stop,
        locks: all.locks,
        ..ClusterOptions::default()
    };
    let Ok(coarse) = cluster(&dirty.mesh, &options) else {
        return;
    };
    coarse.mesh.validate().expect("the result is valid");
    assert!(coarse.mesh.triangles.len() <= dirty.mesh.triangles.len());
    assert!(coarse.error >= 0.0, "error {}", coarse.error);
}

fn pruned(dirty: &Dirty) {
    let stop = dirty.options().stop;
    let options = PruneOptions {
        error: stop.error,
        relative_error: stop.relative_error,
    };
    let Ok(pruned) = prune(&dirty.mesh, &options) else {
        return;
    };
    pruned.mesh.validate().expect("the result is valid");
    let none_left = pruned.mesh.triangles.is_empty();
    assert_eq!(none_left, dirty.mesh.triangles.is_empty());
}

fn thinned(dirty: &Dirty) {
    let options = FoliageOptions {
        simplify: dirty.options(),
        card: 3,
        ..FoliageOptions::default()
    };
    let Ok(thin) = foliage(&dirty.mesh, &options) else {
        return;
    };
    thin.mesh.validate().expect("the result is valid");
    assert!(thin.mesh.triangles.len() <= dirty.mesh.triangles.len());
}
