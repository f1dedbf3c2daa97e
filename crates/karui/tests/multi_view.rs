//! Image saliency brought back to vertices.

use karui::geom::Vec2;
use karui::geom::{Vec3, Vec4};
use karui::mesh::{Image, ImageData, Material, MaterialRange, Scene, Texture, TextureRef};
use karui::mesh::{Wrap, shapes};
use karui::progress::Progress;
use karui::render::{Model, Picture};
use karui::saliency::{MeshSaliencyOptions, mesh_saliency};
use karui::saliency::{MultiView, MultiViewOptions, Unseen, Views, multi_view};
use karui::{Error, Silent, TriMesh};

/// A green sphere, red near +x.
fn patched() -> TriMesh {
    let mut mesh = shapes::uv_sphere(24, 48);
    let red = |p: &Vec3| {
        if is_patch(*p) {
            Vec4::new(1.0, 0.0, 0.0, 1.0)
        } else {
            Vec4::new(0.0, 0.6, 0.0, 1.0)
        }
    };
    mesh.attributes.colors = vec![mesh.positions.iter().map(red).collect()];
    mesh
}

fn is_patch(p: Vec3) -> bool {
    p.normalize().x > 0.93
}

fn seen_from(mesh: &TriMesh, views: Views, unseen: Unseen) -> MultiView {
    let options = MultiViewOptions {
        views,
        unseen,
        size: 256,
        ..MultiViewOptions::default()
    };
    let mut all = multi_view(&Model::of_mesh(mesh), &options, &Silent).expect("views");
    all.remove(0)
}

#[test]
fn the_grid_has_614_directions() {
    let directions = Views::Grid { n1: 36, n2: 36 }.directions();
    assert_eq!(directions.len(), 614);
    for (k, a) in directions.iter().enumerate() {
        assert!((a.length() - 1.0).abs() < 1e-6);
        assert!(directions[..k].iter().all(|b| a.distance(*b) > 1e-3));
    }
    // Odd numbers, against the distances themselves.
    for (n1, n2) in [(1, 1), (2, 3), (5, 7), (6, 5), (5, 6)] {
        let mut plain: Vec<Vec3> = Vec::new();
        for k in 0..n1 {
            for l in 0..n2 {
                let turn = |at: u32, of: u32| {
                    (std::f64::consts::TAU * f64::from(at) / f64::from(of)).sin_cos()
                };
                let ((sa, ca), (sb, cb)) = (turn(k, n1), turn(l, n2));
                let d = Vec3::new((sa * cb) as f32, (sa * sb) as f32, ca as f32);
                if plain.iter().all(|p| p.distance(d) > 1e-4) {
                    plain.push(d);
                }
            }
        }
        assert_eq!(
            Views::Grid { n1, n2 }.directions().len(),
            plain.len(),
            "{n1} {n2}"
        );
    }
}

#[test]
fn a_red_patch_is_salient() {
    let mesh = patched();
    let result = seen_from(&mesh, Views::Fibonacci(40), Unseen::Ignored);
    let mean = |values: &[f32], patch: bool| {
        let chosen = (0..mesh.positions.len()).filter(|&v| is_patch(mesh.positions[v]) == patch);
        let values: Vec<f32> = chosen.map(|v| values[v]).collect();
        values.iter().sum::<f32>() / values.len() as f32
    };
    // Every view's map reaches 1 somewhere, so the maxima are close together.
    for (values, name) in [(&result.maximum, "maximum"), (&result.mean, "mean")] {
        let (patch, rest) = (mean(values, true), mean(values, false));
        assert!(patch > rest, "{name}: {patch} and {rest}");
    }
    for v in 0..mesh.positions.len() {
        assert!(result.seen[v] > 0 && result.seen[v] < 40);
        assert!(result.minimum[v] <= result.mean[v] && result.mean[v] <= result.maximum[v]);
    }
}

#[test]
fn a_view_sees_the_front_alone() {
    let mesh = patched();
    let one = Views::Directions(vec![Vec3::X]);
    let result = seen_from(&mesh, one, Unseen::Ignored);
    // Of a unit sphere an eye sees what is above the tangents' circle.
    let radius = mesh.bounds().diagonal() / 12f64.sqrt();
    let horizon = radius / (1.4 * mesh.bounds().diagonal());
    for (p, &seen) in mesh.positions.iter().zip(&result.seen) {
        let height = f64::from(p.normalize().x);
        if (height - horizon).abs() > 0.15 {
            assert_eq!(seen == 1, height > horizon, "{p}");
        }
    }
}

#[test]
fn unseen_may_count_as_zero() {
    let mesh = patched();
    let ignored = seen_from(&mesh, Views::Fibonacci(20), Unseen::Ignored);
    let zero = seen_from(&mesh, Views::Fibonacci(20), Unseen::Zero);
    assert!(zero.minimum.iter().all(|&v| v == 0.0));
    assert_eq!(
        (&zero.maximum, &zero.seen),
        (&ignored.maximum, &ignored.seen)
    );
    for v in 0..mesh.positions.len() {
        let expected = ignored.mean[v] * ignored.seen[v] as f32 / 20.0;
        assert!((zero.mean[v] - expected).abs() < 1e-5);
    }
}

#[test]
fn threads_do_not_matter() {
    let mesh = patched();
    let by = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads")
            .install(|| seen_from(&mesh, Views::Fibonacci(20), Unseen::Ignored))
    };
    let one = by(1);
    assert_eq!(one, by(2));
    assert_eq!(one, by(8));
}

struct Stop;

impl Progress for Stop {
    fn report(&self, _: &'static str, _: f32) {}
    fn cancelled(&self) -> bool {
        true
    }
}

#[test]
fn views_may_be_cancelled_and_must_be_there() {
    let mesh = patched();
    let model = Model::of_mesh(&mesh);
    let result = multi_view(&model, &MultiViewOptions::default(), &Stop);
    assert_eq!(result, Err(Error::Cancelled));
    let none = MultiViewOptions {
        views: Views::Fibonacci(0),
        ..MultiViewOptions::default()
    };
    assert!(multi_view(&model, &none, &Silent).is_err());
}

/// A flat strip with one texture: even grey, and a chequered patch within 0.1 of u = 0.7,
/// v = 0.5.
fn strip() -> (Scene, Picture) {
    let mut mesh = shapes::grid(60, 20);
    let uv = |p: &Vec3| Vec2::new(p.x, p.z);
    mesh.attributes.uvs = vec![mesh.positions.iter().map(uv).collect()];
    mesh.positions.iter_mut().for_each(|p| p.x *= 3.0);
    mesh.ranges = vec![MaterialRange {
        count: mesh.triangles.len() as u32,
        material: Some(0),
        ..MaterialRange::default()
    }];
    let mut scene = Scene::from_mesh(mesh);
    scene.materials = vec![Material {
        base_color_texture: Some(TextureRef {
            texture: 0,
            uv_set: 0,
            transform: None,
        }),
        double_sided: true,
        ..Material::default()
    }];
    scene.textures = vec![Texture {
        image: Some(0),
        wrap: [Wrap::Clamp; 2],
        nearest: false,
    }];
    scene.images = vec![Image {
        name: None,
        mime: String::new(),
        data: ImageData::Missing { uri: String::new() },
    }];
    let texel = |k: u32| {
        let [x, y] = [k % 192, k / 192];
        let chequered = is_chequered(Vec2::new(x as f32 / 192.0, y as f32 / 64.0));
        match (chequered, (x / 6 + y / 6) % 2) {
            (false, _) => [110, 110, 110, 255],
            (true, 0) => [240, 230, 60, 255],
            (true, _) => [20, 20, 120, 255],
        }
    };
    let picture = Picture::new(192, 64, (0..192 * 64).map(texel).collect()).expect("all texels");
    (scene, picture)
}

fn is_chequered(uv: Vec2) -> bool {
    (uv.x - 0.7).abs() < 0.1 && (uv.y - 0.5).abs() < 0.3
}

#[test]
fn views_see_a_texture_where_the_shape_says_nothing() {
    let (scene, picture) = strip();
    let mesh = &scene.meshes[0].mesh;
    let shape = mesh_saliency(mesh, &MeshSaliencyOptions::default()).expect("a mesh");
    assert!(shape.iter().all(|s| *s == 0.0));
    let options = MultiViewOptions {
        views: Views::Directions(vec![Vec3::Y, Vec3::new(0.2, 1.0, 0.1), Vec3::NEG_Y]),
        ..MultiViewOptions::default()
    };
    let images = [Some(picture)];
    let found = multi_view(&Model::of_scene(&scene, &images), &options, &Silent).expect("views");
    let mean = |inside: bool| {
        // Ends of the strip are outlines, which stand out from what is behind them.
        let uvs = mesh.attributes.uvs[0].iter().zip(&found[0].mean);
        let within = |uv: Vec2| (0.1..0.9).contains(&uv.x) && (0.2..0.8).contains(&uv.y);
        let values: Vec<f32> = uvs
            .filter(|(uv, _)| within(**uv) && is_chequered(**uv) == inside)
            .map(|(_, value)| *value)
            .collect();
        values.iter().sum::<f32>() / values.len() as f32
    };
    let (patch, rest) = (mean(true), mean(false));
    assert!(patch > 2.0 * rest, "{patch}, {rest} elsewhere");
}
