//! Pictures against an independent ray caster, closed forms and themselves.

mod common_render;

use common_render::*;
use karui::geom::{Camera, Light, Mat4, Vec2, Vec3, Vec4, fibonacci_directions};
use karui::mesh::{AlphaMode, Material, Scene, shapes};
use karui::render::{
    Faces, Frame, Hit, Instance, Model, Normals, Outputs, Paint, Picture, RenderOptions, Renderer,
    Scalar, Shading, Wireframe, render,
};
use karui::{Error, TriMesh};
use proptest::prelude::*;

const UNLIT: RenderOptions<'static> = RenderOptions {
    width: 40,
    height: 30,
    samples: 1,
    outputs: Outputs {
        color: true,
        depth: true,
        hits: true,
    },
    background: [0; 4],
    shading: Shading::Unlit,
    normals: Normals::Smooth,
    ambient: karui::render::Ambient {
        sky: Vec3::ZERO,
        ground: Vec3::ZERO,
    },
    faces: Faces::Both,
    paint: Paint::Material,
    wireframe: None,
};

#[test]
fn zoo_agrees_with_rays() {
    let (mut unsure, mut pixels) = (0, 0);
    for (name, mesh) in shapes::zoo() {
        let bounds = mesh.bounds();
        for direction in fibonacci_directions(6) {
            let camera = Camera::looking_at(bounds, direction, 0.8);
            for camera in [camera, camera.without_perspective()] {
                unsure += agrees_with_rays(&mesh, &camera, name);
                pixels += 40 * 30;
            }
        }
    }
    assert!(
        unsure * 20 < pixels,
        "{unsure} of {pixels} pixels say nothing"
    );
}

#[test]
fn what_crosses_the_near_plane_is_cut_there() {
    let mesh = shapes::torus(1.0, 0.45, 24, 12);
    let mut camera = Camera::looking_at(mesh.bounds(), Vec3::Z, 1.5);
    // Within the ring, looking along it, and a wall that runs past the eye.
    for (eye, target) in [
        (Vec3::new(1.0, 0.1, 0.0), Vec3::new(1.0, 0.1, 1.0)),
        (Vec3::new(0.2, 0.3, 0.1), Vec3::new(1.0, 0.0, 0.4)),
        (Vec3::new(1.3, 0.5, 0.0), Vec3::new(1.2, 0.0, 0.3)),
    ] {
        camera = Camera {
            eye,
            target,
            ..camera
        };
        agrees_with_rays(&mesh, &camera, "no planes");
        camera.near = Some(0.2);
        camera.far = Some(1.7);
        agrees_with_rays(&mesh, &camera, "near and far plane");
        agrees_with_rays(&mesh, &camera.without_perspective(), "no perspective");
        (camera.near, camera.far) = (None, None);
    }
    let s = 1e7;
    let corners = vec![
        Vec3::new(-s, -1.0, s),
        Vec3::new(s, -1.0, s),
        Vec3::new(0.0, -1.0, -s),
    ];
    let floor = TriMesh::new(corners, vec![[0, 1, 2]]);
    camera.near = Some(0.1);
    (camera.eye, camera.target) = (Vec3::ZERO, Vec3::new(0.3, -0.4, -1.0));
    agrees_with_rays(&floor, &camera, "a floor far beyond the guard band");
}

/// Triangles over few positions, so that edges are shared, and any camera.
fn soup_and_camera() -> impl Strategy<Value = (TriMesh, Camera)> {
    let point = || [-2i8..3, -2i8..3, -2i8..3].prop_map(|[x, y, z]| [x, y, z].map(f32::from));
    let points = prop::collection::vec(point(), 4..12);
    (points, point(), point(), any::<bool>(), 0.3f32..2.5).prop_flat_map(
        |(points, eye, target, perspective, fov_y)| {
            let n = points.len() as u32;
            let triangles = prop::collection::vec([0..n, 0..n, 0..n], 1..20);
            triangles.prop_map(move |triangles| {
                let positions = points.iter().map(|&p| Vec3::from(p)).collect();
                let mesh = TriMesh::new(positions, triangles);
                let mut camera = Camera::looking_at(mesh.bounds(), Vec3::Z, fov_y);
                camera.eye = Vec3::from(eye) * 1.37 + Vec3::new(0.11, 0.23, 0.05);
                camera.target = Vec3::from(target) * 0.31;
                let flat = camera.without_perspective();
                (mesh, if perspective { camera } else { flat })
            })
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    #[test]
    fn any_soup_agrees_with_rays((mesh, camera) in soup_and_camera()) {
        agrees_with_rays(&mesh, &camera, "soup");
    }

    #[test]
    fn any_soup_has_the_same_bits_for_any_number_of_threads((mesh, camera) in soup_and_camera()) {
        let mut scene = Scene::from_mesh(mesh);
        scene.materials = vec![blended(Vec4::new(0.2, 0.5, 0.9, 0.4))];
        use_material(&mut scene, 0);
        let lights = Light::three_points(&camera).unwrap();
        let options = RenderOptions { samples: 2, ..UNLIT };
        let [one, three] = [1, 3].map(|n| with_threads(n, || {
            render(&scene, &[], &camera, &lights, &options)
        }));
        prop_assert_eq!(one, three);
    }
}

/// In a plane cut into triangles, every pixel is covered once: a half transparent
/// surface is half transparent everywhere.
#[test]
fn shared_edges_have_no_gaps_and_no_overlaps() {
    let mut mesh = shapes::grid(37, 23);
    let mut seed = 7u64;
    for p in &mut mesh.positions {
        let mut jitter = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            ((seed >> 40) as f32 / (1 << 24) as f32 - 0.5) * 0.02
        };
        let inner = |x: f32| x > 0.0 && x < 1.0;
        if inner(p.x) && inner(p.z) {
            *p += Vec3::new(jitter(), 0.0, jitter());
        }
    }
    let mut scene = Scene::from_mesh(mesh);
    scene.materials = vec![blended(Vec4::new(1.0, 1.0, 1.0, 0.5))];
    use_material(&mut scene, 0);
    let over = Camera::looking_at(scene.bounds(), Vec3::Y, 0.3);
    let inside = Camera {
        eye: Vec3::new(0.5, 0.02, 0.5),
        target: Vec3::new(0.6, 0.0, 0.55),
        near: Some(0.001),
        ..over
    };
    for (camera, least) in [
        (over, 5000),
        (over.without_perspective(), 5000),
        (inside, 5000),
    ] {
        let options = RenderOptions {
            width: 120,
            height: 120,
            ..UNLIT
        };
        let frame = render(&scene, &[], &camera, &[], &options).unwrap();
        let alphas: Vec<u8> = frame.color.pixels().iter().map(|p| p[3]).collect();
        assert!(alphas.iter().all(|&a| a == 0 || a == 128), "{alphas:?}");
        assert!(alphas.iter().filter(|&&a| a == 128).count() > least);
        assert!(frame.hits.iter().all(|hit| *hit == Hit::MISS));
    }
}

#[test]
fn bits_do_not_depend_on_threads() {
    let (scene, images) = rich_scene();
    let camera = Camera::looking_at(scene.bounds(), Vec3::new(0.3, 0.5, 1.0), 0.7);
    let lights = some_lights(&camera);
    for (samples, shading) in [
        (1, Shading::Pbr),
        (2, Shading::BlinnPhong),
        (4, Shading::Unlit),
    ] {
        let options = RenderOptions {
            width: 150,
            height: 110,
            samples,
            shading,
            faces: Faces::ByMaterial,
            wireframe: Some(Wireframe::default()),
            ..UNLIT
        };
        let [one, two, eight] = [1, 2, 8].map(|n| {
            with_threads(n, || {
                let frame = render(&scene, &images, &camera, &lights, &options).unwrap();
                bits(&frame)
            })
        });
        assert!(one == two && one == eight, "{shading:?}");
    }
}

fn bits(frame: &Frame) -> (Vec<[u8; 4]>, Vec<u32>, Vec<[u32; 4]>) {
    let depth = frame.depth.iter().map(|d| d.to_bits()).collect();
    let hits = frame.hits.iter().map(|h| {
        let [b, c] = h.barycentric.map(f32::to_bits);
        [h.instance, h.triangle, b, c]
    });
    (frame.color.pixels().to_vec(), depth, hits.collect())
}

/// Three panes one behind the other, their triangles in any order.
#[test]
fn panes_are_blended_from_back_to_front() {
    let colors = [
        Vec4::new(1.0, 0.2, 0.0, 0.5),
        Vec4::new(0.0, 1.0, 0.3, 0.25),
        Vec4::new(0.1, 0.0, 1.0, 0.7),
    ];
    for order in [[0, 1, 2], [2, 0, 1], [1, 2, 0], [2, 1, 0]] {
        let mut scene = Scene::default();
        for pane in order {
            add_pane(&mut scene, -(pane as f32), blended(colors[pane]));
        }
        let options = RenderOptions {
            background: [255, 255, 255, 255],
            ..UNLIT
        };
        let frame = render(&scene, &[], &facing(), &[], &options).unwrap();
        let over = |behind: Vec3, pane: usize| {
            let c = colors[pane];
            c.truncate() * c.w + behind * (1.0 - c.w)
        };
        let expected = [2, 1, 0].into_iter().fold(Vec3::ONE, over);
        close(frame.color.get(20, 15).unwrap(), expected.extend(1.0));
    }
}

#[test]
fn a_pane_before_nothing_keeps_its_own_colour() {
    let mut scene = Scene::default();
    let color = Vec4::new(0.8, 0.1, 0.3, 0.25);
    add_pane(&mut scene, 0.0, blended(color));
    for samples in [1, 2, 4] {
        let options = RenderOptions { samples, ..UNLIT };
        let frame = render(&scene, &[], &facing(), &[], &options).unwrap();
        close(frame.color.get(20, 15).unwrap(), color);
        assert_eq!(frame.color.get(0, 0), Some([0; 4]));
    }
}

#[test]
fn more_panes_than_are_kept_are_the_closest() {
    let mut scene = Scene::default();
    for pane in 0..50 {
        let light = if pane < 32 { 0.0 } else { 1.0 };
        let color = Vec4::new(light, light, light, 0.02);
        add_pane(&mut scene, -0.01 * pane as f32, blended(color));
    }
    let frame = render(&scene, &[], &facing(), &[], &UNLIT).unwrap();
    let alpha = 1.0 - 0.98f32.powi(32);
    close(
        frame.color.get(20, 15).unwrap(),
        Vec4::new(0.0, 0.0, 0.0, alpha),
    );
}

#[test]
fn a_mask_has_holes_through_which_one_sees() {
    // Columns with alpha 0, 0.4, 0.6 and 1.
    let image = Picture::new(4, 1, [0, 102, 153, 255].map(|a| [255, 0, 0, a]).to_vec()).unwrap();
    let mut scene = Scene::default();
    add_pane(&mut scene, -1.0, Material::default());
    let mut masked = textured();
    masked.alpha_mode = AlphaMode::Mask(0.5);
    add_pane(&mut scene, 0.0, masked);
    add_texture(&mut scene, true);
    let images = [Some(image)];
    let frame = render(&scene, &images, &facing(), &[], &UNLIT).unwrap();
    for (x, mesh, color) in [
        (13, 0, [255; 4]),
        (17, 0, [255; 4]),
        (22, 1, [255, 0, 0, 255]),
    ] {
        assert_eq!(frame.hit(x, 15).unwrap().instance, mesh, "{x}");
        assert_eq!(frame.color.get(x, 15), Some(color), "{x}");
    }
    let all = with_cutoff(&scene, 0.0, &images);
    assert_eq!(all.hit(13, 15).unwrap().instance, 1);
    let none = with_cutoff(&scene, 1.01, &images);
    assert_eq!(none.hit(26, 15).unwrap().instance, 0);
}

fn with_cutoff(scene: &Scene, cutoff: f32, images: &[Option<Picture>]) -> Frame {
    let mut scene = scene.clone();
    scene.materials[1].alpha_mode = AlphaMode::Mask(cutoff);
    render(&scene, images, &facing(), &[], &UNLIT).expect("sound")
}

/// A picture on a wall that fills the picture comes out as it went in.
#[test]
fn a_texture_seen_straight_on_is_itself() {
    let pixels = (0..64u32).map(|i| [i as u8 * 4, 255 - i as u8, (i * 37) as u8, 255]);
    let image = Picture::new(8, 8, pixels.collect()).unwrap();
    let mut scene = Scene::default();
    add_pane(&mut scene, 0.0, textured());
    add_texture(&mut scene, false);
    let camera = Camera {
        projection: karui::geom::Projection::Orthographic { height: 1.0 },
        ..facing()
    };
    let options = RenderOptions {
        width: 8,
        height: 8,
        ..UNLIT
    };
    let frame = render(&scene, &[Some(image.clone())], &camera, &[], &options).unwrap();
    assert_eq!(frame.color, image);
    // Four times as large, each pixel is a block of its colour.
    scene.textures[0].nearest = true;
    let options = RenderOptions {
        width: 32,
        height: 32,
        ..UNLIT
    };
    let frame = render(&scene, &[Some(image.clone())], &camera, &[], &options).unwrap();
    for (x, y) in (0..1024).map(|i| (i % 32, i / 32)) {
        assert_eq!(frame.color.get(x, y), image.get(x / 4, y / 4));
    }
}

/// A line through the picture of a floor: distances are hyperbolic in it, and so is
/// what is painted on.
#[test]
fn scalars_are_interpolated_in_space_not_in_the_picture() {
    let mesh = shapes::grid(1, 1);
    let values: Vec<f32> = mesh.positions.iter().map(|p| p.z).collect();
    let values = [&values[..]];
    let map = std::array::from_fn(|i| [i as u8; 3]);
    let paint = Paint::Scalar(Scalar {
        values: &values,
        low: 0.0,
        high: 1.0,
        map: &map,
    });
    let camera = Camera {
        eye: Vec3::new(0.5, 0.3, 1.4),
        target: Vec3::new(0.5, 0.0, 0.5),
        ..Camera::looking_at(mesh.bounds(), Vec3::Y, 1.0)
    };
    let options = RenderOptions { paint, ..UNLIT };
    let renderer = Renderer::of_mesh(&mesh).unwrap();
    let frame = renderer.frame(&camera, &[], &options).unwrap();
    let caster = Caster::new(&mesh, &camera, (40, 30));
    let mut seen = 0;
    for y in 0..30 {
        let Some(_) = frame.hit(20, y) else { continue };
        let (from, step) = caster.ray(20.5, f64::from(y) + 0.5);
        let z = from.z - step.z * from.y / step.y;
        let [code, ..] = frame.color.get(20, y).unwrap();
        assert!((f64::from(code) - 255.0 * z).abs() < 1.0, "{y} {code} {z}");
        seen += 1;
    }
    assert!(seen > 10, "{seen}");
}

#[test]
fn four_samples_are_the_mean_of_a_larger_picture() {
    let mesh = shapes::torus(1.0, 0.4, 20, 10);
    let renderer = Renderer::of_mesh(&mesh).unwrap();
    let camera = Camera::looking_at(renderer.bounds(), Vec3::ONE, 0.7);
    let lights = Light::three_points(&camera).unwrap();
    let background = [20, 90, 200, 255];
    let options = RenderOptions {
        samples: 2,
        background,
        ..RenderOptions::default()
    };
    let options = RenderOptions {
        width: 60,
        height: 50,
        ..options
    };
    let mean = renderer.frame(&camera, &lights, &options).unwrap();
    let options = RenderOptions {
        width: 120,
        height: 100,
        samples: 1,
        ..options
    };
    let large = renderer.frame(&camera, &lights, &options).unwrap();
    for (x, y) in (0..3000).map(|i| (i % 60, i / 60)) {
        let corner = |k: u32| linear(large.color.get(2 * x + k % 2, 2 * y + k / 2).unwrap());
        let expected = (0..4).map(corner).sum::<Vec4>() / 4.0;
        close(mean.color.get(x, y).unwrap(), expected);
        assert_eq!(mean.hit(x, y), large.hit(2 * x, 2 * y));
    }
}

#[test]
fn light_adds_up() {
    let mesh = shapes::uv_sphere(24, 48);
    let renderer = Renderer::of_mesh(&mesh).unwrap();
    let camera = Camera::looking_at(renderer.bounds(), Vec3::new(1.0, 0.5, 2.0), 0.6);
    let position = camera.eye + Vec3::new(2.0, 1.0, 0.0);
    let point = Light::Point {
        position,
        color: Vec3::new(0.3, 1.0, 0.5),
        intensity: 3.0,
    };
    let lights = [some_lights(&camera)[0], point];
    for shading in [Shading::Pbr, Shading::BlinnPhong] {
        let options = RenderOptions { shading, ..UNLIT };
        let shaded = |lights: &[Light]| renderer.frame(&camera, lights, &options).unwrap().color;
        let (both, first, second) = (shaded(&lights), shaded(&lights[..1]), shaded(&lights[1..]));
        let mut bright = 0;
        for (i, &pixel) in both.pixels().iter().enumerate() {
            let sum = linear(first.pixels()[i]) + linear(second.pixels()[i]);
            let most = sum.truncate().max_element();
            if pixel[3] == 255 && most < 0.99 {
                let difference = (linear(pixel) - sum.with_w(1.0)).abs().max_element();
                assert!(difference < 0.01, "{pixel:?} {sum}");
                bright += usize::from(most > 0.2);
            }
        }
        assert!(bright > 50, "{bright}");
        assert!(shaded(&[]).pixels().iter().all(|p| p[..3] == [0, 0, 0]));
    }
}

#[test]
fn a_white_matte_wall_facing_the_light_is_white_and_its_back_is_lit_too() {
    for faces in [Faces::Both, Faces::Front] {
        for from_behind in [false, true] {
            let mut scene = Scene::default();
            let rough = Material {
                metallic: 0.0,
                ..Material::default()
            };
            add_pane(&mut scene, 0.0, rough);
            let mut camera = facing();
            if from_behind {
                camera.eye.z = -camera.eye.z;
            }
            let light = Light::headlight(&camera).unwrap();
            let options = RenderOptions {
                shading: Shading::Pbr,
                faces,
                ..UNLIT
            };
            let frame = render(&scene, &[], &camera, &[light], &options).unwrap();
            let [r, .., a] = frame.color.get(20, 15).unwrap();
            let seen = !(from_behind && faces == Faces::Front);
            assert_eq!((r > 240, a), (seen, if seen { 255 } else { 0 }));
        }
    }
}

#[test]
fn a_normal_map_that_says_nothing_changes_nothing() {
    let mut scene = Scene::default();
    let mut material = Material {
        metallic: 0.0,
        roughness: 0.6,
        ..Material::default()
    };
    add_pane(&mut scene, 0.0, material.clone());
    let mut bumpy = scene.clone();
    add_texture(&mut bumpy, false);
    material.normal_texture = textured().base_color_texture;
    bumpy.materials[0] = material;
    let camera = facing();
    let lights = some_lights(&camera);
    let options = RenderOptions {
        shading: Shading::Pbr,
        ..UNLIT
    };
    let shaded = |scene: &Scene, color| {
        let images = [Some(Picture::filled(2, 2, color))];
        let frame = render(scene, &images, &camera, &lights, &options).unwrap();
        linear(frame.color.get(20, 15).unwrap())
    };
    let flat = shaded(&scene, [0; 4]);
    assert!(
        (flat - shaded(&bumpy, [128, 128, 255, 255]))
            .abs()
            .max_element()
            < 0.02
    );
    // Leaning to the right and up, to where the light is: brighter.
    let right = shaded(&bumpy, [200, 128, 230, 255]);
    let up = shaded(&bumpy, [128, 200, 230, 255]);
    assert!(
        right.x > flat.x + 0.02 && up.x > flat.x + 0.02,
        "{flat} {right} {up}"
    );
}

#[test]
fn a_mirrored_instance_looks_like_a_mirrored_mesh() {
    let mesh = shapes::terrain(12, 12, 3);
    let matrix = Mat4::from_scale(Vec3::new(-1.0, 2.0, 1.0));
    let mut baked = mesh.clone();
    for p in &mut baked.positions {
        *p = matrix.transform_point3(*p);
    }
    baked.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    let mut placed = Model::of_mesh(&mesh);
    placed.instances = vec![Instance {
        mesh: 0,
        node: None,
        world_from_mesh: matrix,
    }];
    let camera = Camera::looking_at(baked.bounds(), Vec3::new(0.2, 1.0, 0.5), 0.7);
    let lights = some_lights(&camera);
    for normals in [Normals::Flat, Normals::Smooth] {
        let options = RenderOptions {
            shading: Shading::Pbr,
            faces: Faces::Front,
            normals,
            ..UNLIT
        };
        let [a, b] = [&placed, &Model::of_mesh(&baked)].map(|model| {
            let renderer = Renderer::of_model(model).unwrap();
            renderer.frame(&camera, &lights, &options).unwrap()
        });
        let seen = a.hits.iter().filter(|h| h.is_some()).count();
        assert!(seen > 200, "{seen}");
        assert_eq!(a.depth, b.depth);
        let same = a
            .color
            .pixels()
            .iter()
            .zip(b.color.pixels())
            .filter(|(a, b)| {
                (0..4).all(|k| a[k].abs_diff(b[k]) <= if normals == Normals::Flat { 1 } else { 40 })
            });
        assert!(same.count() > 1190);
    }
}

#[test]
fn lines_are_drawn_along_edges_only() {
    let mut scene = Scene::default();
    add_pane(&mut scene, 0.0, Material::default());
    let lines = Wireframe {
        color: [0, 0, 0, 255],
        width: 1.0,
    };
    let camera = Camera {
        projection: karui::geom::Projection::Orthographic { height: 1.0 },
        ..facing()
    };
    let options = RenderOptions {
        width: 31,
        height: 31,
        wireframe: Some(lines),
        ..UNLIT
    };
    let frame = render(&scene, &[], &camera, &[], &options).unwrap();
    // The diagonal runs through the middle.
    assert_eq!(frame.color.get(15, 15), Some([0, 0, 0, 255]));
    assert_eq!(frame.color.get(8, 15), Some([255; 4]));
    assert_eq!(frame.hits.iter().filter(|h| h.is_some()).count(), 31 * 31);
}

#[test]
fn nothing_to_see_is_the_background() {
    let point = TriMesh::new(vec![Vec3::ONE], Vec::new());
    let flat = TriMesh::new(vec![Vec3::ONE; 3], vec![[0, 1, 2], [0, 0, 0]]);
    let line = TriMesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::X * 2.0], vec![[0, 1, 2]]);
    for mesh in [shapes::empty(), point, flat, line] {
        let renderer = Renderer::of_mesh(&mesh).unwrap();
        let camera = Camera::looking_at(renderer.bounds(), Vec3::ONE, 0.7);
        let background = [1, 2, 3, 255];
        let options = RenderOptions {
            background,
            samples: 2,
            ..UNLIT
        };
        let frame = renderer.frame(&camera, &[], &options).unwrap();
        assert!(frame.color.pixels().iter().all(|&p| p == background));
        assert!(frame.depth.iter().all(|d| *d == f32::INFINITY));
        assert_eq!(frame.hit(3, 3), None);
    }
}

#[test]
fn damaged_input_is_an_error() {
    let fails = |mesh: &TriMesh| Renderer::of_mesh(mesh).unwrap_err();
    let mut mesh = shapes::triangle();
    mesh.triangles[0][1] = 9;
    assert!(matches!(
        fails(&mesh),
        Error::IndexOutOfRange { index: 9, .. }
    ));
    let mut mesh = shapes::triangle();
    mesh.positions[1].y = f32::NAN;
    assert!(matches!(fails(&mesh), Error::NotFinite { index: 1, .. }));
    let mut mesh = shapes::triangle();
    mesh.attributes.normals = Some(vec![Vec3::Z]);
    assert!(matches!(fails(&mesh), Error::LengthMismatch { .. }));
    let mut scene = Scene::from_mesh(shapes::triangle());
    use_material(&mut scene, 3);
    assert!(Renderer::new(&scene, &[]).is_ok());
    scene.materials = vec![Material::default()];
    assert!(matches!(
        Renderer::new(&scene, &[]),
        Err(Error::BadReference { to: 3, .. })
    ));
    scene.materials = vec![textured(); 4];
    assert!(matches!(
        Renderer::new(&scene, &[]),
        Err(Error::BadReference { to: 0, .. })
    ));
}

#[test]
fn options_out_of_range_are_errors() {
    let mesh = shapes::triangle();
    let renderer = Renderer::of_mesh(&mesh).unwrap();
    let camera = Camera::looking_at(mesh.bounds(), Vec3::Z, 0.7);
    let frame = |options: RenderOptions<'_>| renderer.frame(&camera, &[], &options);
    for bad in [
        RenderOptions { width: 0, ..UNLIT },
        RenderOptions {
            height: 16_385,
            ..UNLIT
        },
        RenderOptions {
            samples: 3,
            ..UNLIT
        },
        RenderOptions {
            wireframe: Some(Wireframe {
                color: [0; 4],
                width: -1.0,
            }),
            ..UNLIT
        },
    ] {
        assert!(
            matches!(frame(bad), Err(Error::BadOption { .. })),
            "{bad:?}"
        );
    }
    let map = [[0; 3]; 256];
    let scalar = |values, low, high| RenderOptions {
        paint: Paint::Scalar(Scalar {
            values,
            low,
            high,
            map: &map,
        }),
        ..UNLIT
    };
    assert!(matches!(
        frame(scalar(&[], 0.0, 1.0)),
        Err(Error::LengthMismatch { .. })
    ));
    assert!(matches!(
        frame(scalar(&[&[0.0]], 0.0, 1.0)),
        Err(Error::LengthMismatch { .. })
    ));
    assert!(matches!(
        frame(scalar(&[&[0.0; 3]], 1.0, 1.0)),
        Err(Error::BadOption { .. })
    ));
    assert!(frame(scalar(&[&[0.0, f32::NAN, 2.0]], 0.0, 1.0)).is_ok());
    let nowhere = Camera {
        target: camera.eye,
        ..camera
    };
    assert!(matches!(
        renderer.frame(&nowhere, &[], &UNLIT),
        Err(Error::BadOption { .. })
    ));
}

#[test]
fn pictures_of_one_pixel_and_of_the_longest_side() {
    let mesh = shapes::uv_sphere(8, 12);
    let renderer = Renderer::of_mesh(&mesh).unwrap();
    let camera = Camera::looking_at(mesh.bounds(), Vec3::Z, 0.7);
    let lights = some_lights(&camera);
    for (width, height, samples) in [(1, 1, 1), (1, 1, 4), (16_384, 3, 1), (3, 16_384, 4)] {
        let options = RenderOptions {
            width,
            height,
            samples,
            ..UNLIT
        };
        let frame = renderer.frame(&camera, &lights, &options).unwrap();
        assert_eq!(frame.color.pixels().len(), (width * height) as usize);
        assert!(frame.hits.iter().any(Hit::is_some));
    }
}

#[test]
fn bad_normals_are_done_without() {
    let mut mesh = shapes::cube(2);
    let camera = Camera::looking_at(mesh.bounds(), Vec3::new(1.0, 2.0, 3.0), 0.7);
    let lights = some_lights(&camera);
    let options = RenderOptions {
        shading: Shading::Pbr,
        ..UNLIT
    };
    let shaded = |mesh: &TriMesh| {
        let renderer = Renderer::of_mesh(mesh).unwrap();
        renderer.frame(&camera, &lights, &options).unwrap().color
    };
    let good = shaded(&mesh);
    for bad in [Vec3::NAN, Vec3::ZERO, Vec3::INFINITY, Vec3::splat(f32::MAX)] {
        mesh.attributes.normals = Some(vec![bad; mesh.positions.len()]);
        assert_eq!(shaded(&mesh), good, "{bad}");
    }
    let count = mesh.positions.len();
    mesh.attributes.uvs = vec![vec![Vec2::NAN; count]];
    mesh.attributes.colors = vec![vec![Vec4::NAN; count]];
    shaded(&mesh);
}

#[test]
fn images_may_be_missing_empty_tiny_or_long() {
    let mut scene = Scene::default();
    add_pane(&mut scene, 0.0, textured());
    add_texture(&mut scene, false);
    let shown = |images: &[Option<Picture>]| {
        let frame = render(&scene, images, &facing(), &[], &UNLIT).unwrap();
        frame.color.get(20, 15).unwrap()
    };
    let grey = [90, 90, 90, 255];
    assert_eq!(shown(&[]), [255; 4]);
    assert_eq!(shown(&[None]), [255; 4]);
    assert_eq!(shown(&[Some(Picture::default())]), [255; 4]);
    assert_eq!(shown(&[Some(Picture::filled(1, 1, grey))]), grey);
    assert_eq!(shown(&[Some(Picture::filled(16_384, 2, grey))]), grey);
    let mut without_uvs = scene.clone();
    without_uvs.meshes[0].mesh.attributes.uvs.clear();
    let images = [Some(Picture::filled(1, 1, grey))];
    let frame = render(&without_uvs, &images, &facing(), &[], &UNLIT).unwrap();
    assert_eq!(frame.color.get(20, 15), Some([255; 4]));
}
