//! The hierarchy of boxes against looking at every triangle.
#![allow(clippy::unwrap_used, reason = "a failed unwrap fails the test")]

use glam::{DVec3, Vec3};
use karui::geom::closest_point;
use karui::spatial::Bvh;
use karui::{Error, TriMesh};
use proptest::prelude::*;

fn brute_force(mesh: &TriMesh, p: DVec3) -> f64 {
    let distance = |t| closest_point(p, mesh.corners(t)).distance_squared(p);
    (0..mesh.triangles.len())
        .map(distance)
        .fold(f64::INFINITY, f64::min)
}

/// Built either way.
fn indices(mesh: &TriMesh) -> [Bvh; 2] {
    [Bvh::build(mesh).unwrap(), Bvh::build_quick(mesh).unwrap()]
}

/// Few coordinates, so that triangles coincide, degenerate and pile up.
fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        -1.0f32..1.0,
        (-2i8..=2).prop_map(f32::from),
        Just(1e-3f32),
        Just(-40.0f32),
    ]
}

fn point() -> impl Strategy<Value = Vec3> {
    [coordinate(), coordinate(), coordinate()].prop_map(Vec3::from)
}

fn soup() -> impl Strategy<Value = TriMesh> {
    proptest::collection::vec(point(), 1..60).prop_flat_map(|points| {
        let corner = 0..points.len() as u32;
        let triangle = [corner.clone(), corner.clone(), corner];
        proptest::collection::vec(triangle, 1..120)
            .prop_map(move |triangles| TriMesh::new(points.clone(), triangles))
    })
}

proptest! {
    #[test]
    fn closest_is_the_closest(
        mesh in soup(),
        points in proptest::collection::vec(point(), 10),
        offset in prop_oneof![Just(0.0f32), Just(5e5)],
        scale in prop_oneof![Just(1.0f32), Just(1e-9), Just(1e18)],
    ) {
        let mut mesh = mesh;
        mesh.positions.iter_mut().for_each(|p| *p = *p * scale + offset);
        let [bvh, quick] = indices(&mesh);
        prop_assert_eq!(bvh.bounds(), quick.bounds());
        let mut near = bvh.closest(DVec3::ZERO);
        let mut near_quick = quick.closest(DVec3::ZERO);
        for p in points {
            let p = (p * scale + offset).as_dvec3() + DVec3::splat(f64::from(scale) * 1e-3);
            let hit = bvh.closest(p);
            prop_assert_eq!(hit.distance_squared, brute_force(&mesh, p));
            let also = quick.closest(p);
            prop_assert_eq!(also.triangle, hit.triangle);
            prop_assert_eq!(also.distance_squared, hit.distance_squared);
            prop_assert_eq!(quick.closest_near(p, &near_quick), also);
            near_quick = also;
            prop_assert_eq!(bvh.closest_near(p, &near), hit);
            let corners = mesh.corners(hit.triangle as usize);
            let from_weights = corners[0] * hit.barycentric[0]
                + corners[1] * hit.barycentric[1]
                + corners[2] * hit.barycentric[2];
            let size = corners.iter().map(|c| c.length()).fold(0.0, f64::max);
            prop_assert!(from_weights.distance(hit.point) <= 1e-14 * size);
            near = hit;
        }
    }
}

/// Enough triangles for subtrees to be built as separate tasks.
fn waves(side: u32) -> TriMesh {
    let height = |x: u32, y: u32| (x as f32 * 0.13).sin() * (y as f32 * 0.07).cos();
    let at = |i: u32| {
        Vec3::new(
            (i % side) as f32,
            (i / side) as f32,
            height(i % side, i / side),
        )
    };
    let mut triangles = Vec::new();
    for i in (0..side * (side - 1)).filter(|i| i % side != side - 1) {
        triangles.push([i, i + 1, i + side]);
        triangles.push([i + 1, i + side + 1, i + side]);
    }
    TriMesh::new((0..side * side).map(at).collect(), triangles)
}

/// One triangle many times over.
fn repeated(triangles: usize) -> TriMesh {
    let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    TriMesh::new(corners, vec![[0, 1, 2]; triangles])
}

#[test]
fn large_meshes_are_searched_whole() {
    let mesh = waves(90);
    for bvh in indices(&mesh) {
        let mut order = bvh.order().to_vec();
        order.sort_unstable();
        assert!(order.iter().copied().eq(0..mesh.triangles.len() as u32));
        for i in 0..50 {
            let p = DVec3::new(
                f64::from(i) * 1.9,
                f64::from(i * i % 91),
                f64::from(i % 7) - 3.0,
            );
            assert_eq!(
                bvh.closest(p).distance_squared,
                brute_force(&mesh, p),
                "{p}"
            );
        }
    }
}

#[test]
fn points_of_the_surface_are_on_it() {
    let mesh = waves(60);
    for bvh in indices(&mesh) {
        let worst = (0..mesh.triangles.len())
            .map(|t| mesh.corners(t))
            .map(|[a, b, c]| a * 0.17 + b * 0.5 + c * 0.33)
            .map(|p| bvh.closest(p).distance_squared.sqrt())
            .fold(0.0, f64::max);
        assert!(worst <= 1e-15 * bvh.bounds().diagonal(), "{worst}");
    }
}

#[test]
fn of_equal_triangles_the_first_is_named() {
    for triangles in [1, 2, 3, 4, 5, 6, 5000, 70_000] {
        for bvh in indices(&repeated(triangles)) {
            assert_eq!(bvh.len(), triangles);
            assert_eq!(bvh.closest(DVec3::ONE).triangle, 0);
        }
    }
}

#[test]
fn triangles_in_one_point_are_found() {
    for place in [Vec3::ZERO, Vec3::splat(7e20), Vec3::new(-1e-40, 0.0, 3.0)] {
        let mesh = TriMesh::new(vec![place; 3], vec![[0, 1, 2]; 9000]);
        for bvh in indices(&mesh) {
            let hit = bvh.closest(DVec3::ONE);
            assert_eq!(
                (hit.triangle, hit.point, hit.distance_squared),
                (0, place.as_dvec3(), brute_force(&mesh, DVec3::ONE))
            );
        }
    }
}

#[test]
fn a_few_huge_triangles_among_many_small_ones_are_found() {
    let mut mesh = waves(60);
    let first = mesh.positions.len() as u32;
    mesh.positions.extend([
        Vec3::splat(-1e6),
        Vec3::splat(1e6),
        Vec3::new(1e6, -1e6, 5.0),
    ]);
    mesh.triangles
        .extend([[first, first + 1, first + 2], [0, first, first + 1]]);
    for bvh in indices(&mesh) {
        for i in 0..40 {
            let p = DVec3::new(f64::from(i * 7 % 61), f64::from(i), f64::from(i * i));
            assert_eq!(bvh.closest(p).distance_squared, brute_force(&mesh, p));
        }
    }
}

/// The threads decide who builds what, not what is built.
#[test]
fn any_number_of_threads_builds_the_same() {
    let mesh = waves(200);
    let built = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| indices(&mesh))
    };
    let [one, many] = [built(1), built(7)];
    for (a, b) in one.iter().zip(&many) {
        assert_eq!(a.order(), b.order());
        assert_eq!(format!("{a:?}"), format!("{b:?}"));
    }
}

#[test]
fn extreme_coordinates_do_no_harm() {
    let far = f32::MAX;
    let points: Vec<Vec3> = (0..300)
        .map(|i| Vec3::new(far / (i + 1) as f32, -far, 1.0 / (i + 1) as f32 * 1e-38))
        .collect();
    let triangles = (0..298).map(|i| [i, i + 1, i + 2]).collect();
    let mut mesh = TriMesh::new(points, triangles);
    // What can and what cannot be added up.
    for scale in [1.0, 0.1] {
        mesh.positions.iter_mut().for_each(|p| *p *= scale);
        for bvh in indices(&mesh) {
            let p = DVec3::new(3.0, 1e30, 0.0);
            assert_eq!(bvh.closest(p).distance_squared, brute_force(&mesh, p));
            assert!(!bvh.closest(DVec3::NAN).distance_squared.is_finite());
            assert!(!bvh.closest(DVec3::INFINITY).distance_squared.is_finite());
        }
    }
}

#[test]
fn damaged_meshes_are_errors() {
    let error = |mesh: &TriMesh| {
        let error = Bvh::build(mesh).err();
        assert_eq!(error, Bvh::build_quick(mesh).err());
        error
    };
    assert_eq!(
        error(&TriMesh::default()),
        Some(Error::Empty { what: "mesh" })
    );
    let mut mesh = TriMesh::new(vec![Vec3::ZERO, Vec3::NAN], vec![[0, 0, 0]]);
    assert_eq!(error(&mesh), None, "a stray vertex is not looked at");
    mesh.triangles.push([0, 1, 0]);
    assert!(matches!(
        error(&mesh),
        Some(Error::NotFinite { index: 1, .. })
    ));
    mesh.triangles[1] = [0, 0, 2];
    let found = error(&mesh);
    assert!(matches!(
        found,
        Some(Error::IndexOutOfRange {
            face: 1,
            index: 2,
            vertices: 2
        })
    ));
}
