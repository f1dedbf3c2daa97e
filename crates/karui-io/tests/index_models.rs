//! The two ways to build an index over real models: the same answers.
#![allow(clippy::unwrap_used, reason = "a failed unwrap fails the test")]

mod common;

use common::models;
use karui::geom::DVec3;
use karui::spatial::Bvh;

const FILES: [&str; 6] = [
    "scans/bun_zipper.ply.gz",
    "gltf/DragonAttenuation.glb",
    "gltf/FlightHelmet/FlightHelmet.gltf",
    "hard/sponza.obj.gz",
    "scans/boot.obj",
    "hard/Spider_binary.stl",
];

#[test]
fn both_indices_give_the_same_answers() {
    let Some(folder) = models() else { return };
    for file in FILES.iter().filter(|file| folder.join(file).is_file()) {
        let mesh = karui_io::read(folder.join(file)).unwrap();
        let mesh = mesh.into_single_mesh().unwrap();
        let (bvh, quick) = (Bvh::build(&mesh).unwrap(), Bvh::build_quick(&mesh).unwrap());
        assert_eq!(bvh.bounds(), quick.bounds());
        let size = bvh.bounds().diagonal();
        let mut near = quick.closest(DVec3::ZERO);
        for t in (0..mesh.triangles.len()).step_by(7) {
            let corners = mesh.corners(t);
            let centre = corners.iter().sum::<DVec3>() / 3.0;
            for p in [
                centre,
                corners[0],
                centre + DVec3::new(0.01, -0.02, 0.03) * size,
            ] {
                let (a, b) = (bvh.closest(p), quick.closest(p));
                assert_eq!(
                    (a.triangle, a.distance_squared),
                    (b.triangle, b.distance_squared)
                );
                assert_eq!((a.point, a.barycentric), (b.point, b.barycentric));
                assert_eq!(quick.closest_near(p, &near), b, "{file}");
                near = b;
            }
        }
    }
}
