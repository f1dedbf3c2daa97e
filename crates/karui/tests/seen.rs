//! From where on a level may be shown, by what is seen of it.

use karui::geom::{Camera, Light, Projection, Vec3, fibonacci_directions};
use karui::lod::{
    Levels, LodOptions, Reached, Screen, SeenOptions, chain_scene, chain_seen, seen_distance,
    seen_flip, to_msft_lod,
};
use karui::mesh::{Attributes, Scene, shapes};
use karui::metrics::image::{PIXELS_PER_DEGREE, flip};
use karui::progress::Progress;
use karui::render::{Model, Outputs, RenderOptions, Renderer};
use karui::{Error, TriMesh};
use proptest::prelude::*;

/// A small screen and few views, for tests are built without much optimisation.
fn options(bound: f64) -> SeenOptions<'static> {
    SeenOptions {
        bound,
        views: 4,
        samples: 2,
        screen: Screen {
            height_px: 120.0,
            ..Screen::default()
        },
        ..SeenOptions::default()
    }
}

/// Where the sphere around the model's box fits a screen of 60 degrees.
fn nearest(mesh: &TriMesh) -> f64 {
    mesh.bounds().diagonal()
}

/// Mean FLIP by the definition, view by view and pixel by pixel.
fn plain_flip(a: &TriMesh, b: &TriMesh, distance: f64, options: &SeenOptions<'_>) -> f64 {
    let renderers = [a, b].map(|mesh| Renderer::of_mesh(mesh).expect("model"));
    let bounds = a.bounds();
    let radius = 0.5 * bounds.diagonal();
    let height = options.screen.height_px;
    let pixel = 2.0 * (0.5 * options.screen.fov_y).tan() / height;
    let seen = 2.0 * (radius / distance).asin().tan() / pixel;
    let side = (seen.ceil() as u32).clamp(16, height as u32);
    let half = (0.5 * options.screen.fov_y).tan() * f64::from(side) / height;
    let mut total = 0.0;
    for direction in fibonacci_directions(options.views) {
        // To the last bit the same eye: at a silhouette one sample tells.
        let towards = direction.as_dvec3().normalize();
        let camera = Camera {
            eye: (bounds.center().as_dvec3() + towards * distance).as_vec3(),
            target: bounds.center(),
            up: Vec3::Y,
            projection: Projection::Perspective {
                fov_y: (2.0 * half.atan()) as f32,
            },
            near: None,
            far: None,
        };
        let lights = Light::three_points(&camera).expect("lights");
        let drawn = RenderOptions {
            width: side,
            height: side,
            samples: options.samples,
            outputs: Outputs::COLOR,
            ..RenderOptions::default()
        };
        let [a, b] = renderers.each_ref().map(|r| {
            let frame = r.frame(&camera, &lights, &drawn);
            frame.expect("picture").color
        });
        let map = flip(&a, &b, PIXELS_PER_DEGREE).expect("FLIP").map;
        let covered: Vec<f64> = (0..map.len())
            .filter(|&i| a.pixels()[i][3] != 0 || b.pixels()[i][3] != 0)
            .map(|i| f64::from(map[i]))
            .collect();
        // From so far that no sample meets it there is nothing to tell apart.
        total += covered.iter().sum::<f64>() / covered.len().max(1) as f64;
    }
    total / f64::from(options.views)
}

#[test]
fn a_model_looks_like_itself_from_as_near_as_it_fits() {
    let mesh = shapes::torus(1.0, 0.4, 24, 16);
    let model = Model::of_mesh(&mesh);
    for start in [0.0, 50.0, f64::NAN] {
        let seen = seen_distance(&model, &model, start, &options(0.0)).expect("distance");
        assert_eq!((seen.flip, seen.reached), (0.0, Reached::Nearest));
        assert!((seen.distance / nearest(&mesh) - 1.0).abs() < 1e-6);
    }
}

#[test]
fn what_is_inside_is_not_seen() {
    let mut outside = shapes::icosphere(3);
    outside.attributes = Attributes::default();
    let mut both = outside.clone();
    let inside = shapes::cube(2);
    let first = both.positions.len() as u32;
    both.positions
        .extend(inside.positions.iter().map(|&p| p * 0.3));
    let moved = inside.triangles.iter().map(|t| t.map(|v| v + first));
    both.triangles.extend(moved);
    let (before, after) = (Model::of_mesh(&both), Model::of_mesh(&outside));
    let seen = seen_distance(&before, &after, 30.0, &options(0.001)).expect("distance");
    assert_eq!((seen.flip, seen.reached), (0.0, Reached::Nearest));
}

#[test]
fn nowhere_near_is_said() {
    let fine = shapes::icosphere(2);
    let mut half = fine.clone();
    half.triangles.truncate(fine.triangles.len() / 2);
    // On a usual screen it would be less than a sample there, and not be seen.
    let mut options = options(0.001);
    options.screen.height_px = 16_000.0;
    let (before, after) = (Model::of_mesh(&fine), Model::of_mesh(&half));
    let seen = seen_distance(&before, &after, 5000.0, &options).expect("distance");
    assert_eq!(seen.reached, Reached::Never);
    assert!(seen.flip > 0.001);
    let diagonals = seen.distance / fine.bounds().diagonal();
    assert!((diagonals - 4096.0).abs() < 0.01, "{diagonals}");
}

#[test]
fn nonsense_is_refused() {
    let mesh = shapes::cube(1);
    let model = Model::of_mesh(&mesh);
    let refused = |options: &SeenOptions<'_>| {
        let error = seen_flip(&model, &model, 9.0, options).expect_err("nonsense");
        assert!(matches!(error, Error::BadOption { .. }), "{error}");
    };
    refused(&options(-0.1));
    refused(&options(f64::NAN));
    refused(&SeenOptions {
        views: 0,
        ..options(0.1)
    });
    refused(&SeenOptions {
        samples: 3,
        ..options(0.1)
    });
    let empty = Model::default();
    let error = seen_flip(&empty, &model, 9.0, &options(0.1));
    assert!(matches!(error, Err(Error::Empty { .. })));
}

/// Stops the work at once.
struct Stop;

impl Progress for Stop {
    fn report(&self, _: &'static str, fraction: f32) {
        assert!((0.0..=1.0).contains(&fraction));
    }

    fn cancelled(&self) -> bool {
        true
    }
}

#[test]
fn it_stops_when_told_to() {
    let mesh = shapes::cube(1);
    let model = Model::of_mesh(&mesh);
    let options = SeenOptions {
        progress: &Stop,
        ..options(0.1)
    };
    let stopped = seen_distance(&model, &model, 9.0, &options);
    assert_eq!(stopped, Err(Error::Cancelled));
}

#[test]
fn a_chain_switches_where_its_levels_look_alike() {
    let mesh = shapes::torus(1.0, 0.4, 48, 32);
    let mut scene = Scene::from_mesh(mesh.clone());
    scene.nodes[0].transform = karui::mesh::Transform::Trs {
        translation: Vec3::new(4.0, 0.0, 0.0),
        rotation: karui::geom::Quat::IDENTITY,
        scale: Vec3::splat(3.0),
    };
    let of_chain = LodOptions {
        levels: Levels::Ratios(vec![0.5, 0.1, 0.03]),
        samples: 2000,
        ..LodOptions::default()
    };
    let before = chain_scene(&scene, &of_chain).expect("chain");
    let mut chain = before.clone();
    let options = options(0.03);
    let found = chain_seen(&scene, &[], &mut chain, &options).expect("distances");
    assert_eq!(found.len(), 3);
    assert!(found.is_sorted_by(|a, b| a.distance <= b.distance));
    let original = Model::of_scene(&scene, &[]);
    let levels = chain.chains[0].iter().flat_map(|c| &c.levels);
    for (k, (seen, level)) in found.iter().zip(levels).enumerate() {
        assert_eq!(level.switch_distance, seen.distance);
        let coarse = chain.scene_at(&scene, k + 1);
        let coarse = Model::of_scene(&coarse, &[]);
        let there = seen_flip(&original, &coarse, seen.distance, &options).expect("FLIP");
        assert_eq!(there, seen.flip);
        assert!(there <= options.bound);
    }
    // Distances are the world's, so the mesh's scale leaves them as they are,
    // and what MSFT_lod says follows from them.
    assert_eq!(chain.summary(&scene, 3).switch_distance, found[2].distance);
    let linked = to_msft_lod(&scene, &chain).scene;
    let lods = linked.nodes.iter().find_map(|n| n.lods.as_ref());
    let radius = chain.chains[0].as_ref().map_or(0.0, |c| c.radius);
    let expected = chain.screen.coverage(radius, found[1].distance) as f32;
    assert_eq!(lods.expect("links").coverage[1], expected);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn the_bound_holds_and_a_larger_one_is_no_farther(
        rings in 8u32..32, bound in 0.01f64..0.2, more in 1.0f64..3.0, start in 0.1f64..200.0,
    ) {
        let fine = shapes::torus(1.0, 0.4, 48, 32);
        let coarse = shapes::torus(1.0, 0.4, rings, 8);
        let models = [&fine, &coarse].map(Model::of_mesh);
        let (strict, lax) = (options(bound), options(bound * more));
        let seen = seen_distance(&models[0], &models[1], start, &strict).unwrap();
        let plain = plain_flip(&fine, &coarse, seen.distance, &strict);
        prop_assert!((plain - seen.flip).abs() < 1e-6, "{} {}", plain, seen.flip);
        prop_assert!(seen.flip <= bound || seen.reached == Reached::Never);
        if seen.reached == Reached::Bound {
            let nearer = seen_flip(&models[0], &models[1], seen.distance / 2.0, &strict).unwrap();
            prop_assert!(seen.distance > nearest(&fine) && nearer >= 0.0);
        }
        let far = seen_distance(&models[0], &models[1], start, &lax).unwrap();
        prop_assert!(far.distance <= seen.distance);
    }

    #[test]
    fn the_number_of_threads_changes_nothing(rings in 8u32..32) {
        let fine = shapes::torus(1.0, 0.4, 48, 32);
        let coarse = shapes::torus(1.0, 0.4, rings, 12);
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let [a, b] = [&fine, &coarse].map(Model::of_mesh);
            let seen = pool.install(|| seen_distance(&a, &b, 10.0, &options(0.05))).unwrap();
            (seen.distance.to_bits(), seen.flip.to_bits(), seen.reached)
        };
        prop_assert_eq!(run(1), run(2));
    }
}
