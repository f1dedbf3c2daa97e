//! Stand-ins of real models, looked at from where they take over. With
//! `KARUI_PICTURES=FOLDER`, pictures of the members and their stand-ins are
//! written there.
#![allow(clippy::unwrap_used, reason = "a failed unwrap fails the test")]
#![allow(clippy::print_stdout, reason = "figures, and what is skipped")]

mod common;

use common::models;
use karui::Scene;
use karui::geom::{Camera, DMat4, DVec3, Light, Vec3};
use karui::hlod::proxy::{
    BoxOptions, ChooseOptions, FEATURE_ID, Group, ImpostorOptions, Look, Member, MergedOptions,
    NO_OBJECT, Objects, Proxy, ProxyKind, box_proxy, choose, impostor, merged,
};
use karui::mesh::AttributeValues;
use karui::metrics::image::{PIXELS_PER_DEGREE, flip};
use karui::render::{Instance, Model, Picture, RenderOptions, Renderer};
use karui::simplify::Stop;
use std::path::Path;
use std::time::Instant;

/// A file as read, its images decoded.
struct Loaded {
    scene: Scene,
    images: Vec<Option<Picture>>,
}

fn load(path: &Path) -> Loaded {
    let scene = karui_io::read(path).unwrap();
    let images = scene.images.iter();
    let images = images.map(|i| karui_io::picture_of(i).unwrap()).collect();
    Loaded { scene, images }
}

/// Every placed mesh of every scene, each scene an object or each mesh one.
fn members<'a>(
    placed: &[(&'a Loaded, DMat4)],
    looks: &'a [Look<'a>],
    whole: bool,
) -> Vec<Member<'a>> {
    let mut members = Vec::new();
    for (object, ((loaded, place), look)) in (0u32..).zip(placed.iter().zip(looks)) {
        for (node, matrix) in loaded.scene.instances() {
            let mesh = loaded.scene.nodes[node as usize].mesh.unwrap();
            members.push(Member {
                mesh: &loaded.scene.meshes[mesh as usize].mesh,
                world_from_mesh: *place * matrix.as_dmat4(),
                look,
                objects: Objects::One(if whole { object } else { members.len() as u32 }),
                error: 0.0,
            });
        }
    }
    members
}

/// Draws the members as they are in their files.
fn pictures_of(placed: &[(&Loaded, DMat4)], group: &Group<'_>, pixels: u32) -> Vec<Picture> {
    let mut pictures = vec![Picture::filled(pixels, pixels, [0; 4]); DIRECTIONS.len()];
    let mut whole = Scene::default();
    let mut images = Vec::new();
    for (loaded, place) in placed {
        append(&mut whole, &mut images, loaded, *place, group.origin());
    }
    let model = Model::of_scene(&whole, &images);
    draw(&model, group, pixels, &mut pictures);
    pictures
}

/// A scene under a new root of another.
fn append(
    whole: &mut Scene,
    images: &mut Vec<Option<Picture>>,
    loaded: &Loaded,
    place: DMat4,
    origin: DVec3,
) {
    let scene = &loaded.scene;
    let (meshes, materials) = (whole.meshes.len() as u32, whole.materials.len() as u32);
    let (textures, first_image) = (whole.textures.len() as u32, images.len() as u32);
    images.extend(loaded.images.iter().cloned());
    for texture in &scene.textures {
        let image = texture.image.map(|i| i + first_image);
        whole
            .textures
            .push(karui::mesh::Texture { image, ..*texture });
    }
    for material in &scene.materials {
        let mut material = material.clone();
        for used in [
            &mut material.base_color_texture,
            &mut material.metallic_roughness_texture,
            &mut material.normal_texture,
            &mut material.occlusion_texture,
            &mut material.emissive_texture,
        ] {
            used.iter_mut().for_each(|used| used.texture += textures);
        }
        whole.materials.push(material);
    }
    for mesh in &scene.meshes {
        let mut mesh = mesh.clone();
        for range in &mut mesh.mesh.ranges {
            range.material = range.material.map(|m| m + materials);
        }
        whole.meshes.push(mesh);
    }
    for (node, matrix) in scene.instances() {
        let world = DMat4::from_translation(-origin) * place * matrix.as_dmat4();
        let node = karui::mesh::Node {
            transform: karui::mesh::Transform::Matrix(world.as_mat4()),
            mesh: scene.nodes[node as usize].mesh.map(|m| m + meshes),
            ..karui::mesh::Node::default()
        };
        whole.roots.push(whole.nodes.len() as u32);
        whole.nodes.push(node);
    }
}

const DIRECTIONS: [Vec3; 3] = [
    Vec3::new(0.3, 0.3, 1.0),
    Vec3::new(-1.0, 0.6, 0.4),
    Vec3::new(0.7, 1.2, -0.8),
];

fn draw(model: &Model<'_>, group: &Group<'_>, pixels: u32, into: &mut [Picture]) {
    let renderer = Renderer::of_model(model).unwrap();
    let options = RenderOptions {
        width: pixels,
        height: pixels,
        samples: 4,
        ..RenderOptions::default()
    };
    for (direction, picture) in DIRECTIONS.into_iter().zip(into) {
        let camera = Camera::looking_at(group.bounds(), direction, 0.6);
        let lights = Light::three_points(&camera).unwrap();
        *picture = renderer.frame(&camera, &lights, &options).unwrap().color;
    }
}

fn pictures_of_proxy(proxy: &Proxy, group: &Group<'_>, pixels: u32) -> Vec<Picture> {
    let images = proxy.pictures();
    let mut model = Model::of_scene(&proxy.scene, &images);
    let move_by = (proxy.origin - group.origin()).as_vec3();
    let world_from_mesh = karui::geom::Mat4::from_translation(move_by);
    model.instances = vec![Instance {
        mesh: 0,
        node: None,
        world_from_mesh,
    }];
    let mut pictures = vec![Picture::filled(pixels, pixels, [0; 4]); DIRECTIONS.len()];
    draw(&model, group, pixels, &mut pictures);
    pictures
}

/// Mean FLIP over what either shows.
fn difference(a: &[Picture], b: &[Picture]) -> f64 {
    let one = |(a, b): (&Picture, &Picture)| {
        let map = flip(a, b, PIXELS_PER_DEGREE).unwrap().map;
        let either = a
            .pixels()
            .iter()
            .zip(b.pixels())
            .map(|(a, b)| a[3].max(b[3]) > 0);
        let (mut sum, mut count) = (0.0, 0.0);
        for (error, _) in map.iter().zip(either).filter(|(_, e)| *e) {
            (sum, count) = (sum + f64::from(*error), count + 1.0);
        }
        sum / f64::max(count, 1.0)
    };
    a.iter().zip(b).map(one).sum::<f64>() / a.len() as f64
}

/// Rows of pictures of one size, over grey.
fn sheet(rows: &[Vec<Picture>]) -> Picture {
    let side = rows[0][0].width() as usize;
    let columns = rows[0].len();
    let mut sheet = Picture::filled(
        (side * columns) as u32,
        (side * rows.len()) as u32,
        [70, 80, 90, 255],
    );
    let width = side * columns;
    for (r, row) in rows.iter().enumerate() {
        for (c, picture) in row.iter().enumerate() {
            for (i, p) in picture.pixels().iter().enumerate() {
                let at = (r * side + i / side) * width + c * side + i % side;
                let alpha = u32::from(p[3]);
                for (code, under) in p.iter().take(3).zip(&mut sheet.pixels_mut()[at]) {
                    let mixed = u32::from(*code) * alpha + u32::from(*under) * (255 - alpha);
                    *under = (mixed / 255) as u8;
                }
            }
        }
    }
    sheet
}

/// What must hold for every stand-in.
fn check(name: &str, proxy: &Proxy, group: &Group<'_>, objects: u32) {
    proxy.scene.validate().unwrap();
    assert!(proxy.triangles() < group.triangles(), "{name}");
    let ids = proxy
        .mesh()
        .attributes
        .custom
        .iter()
        .find(|a| a.name == FEATURE_ID);
    let AttributeValues::U32(ids) = &ids.unwrap().values else {
        panic!("{name}: ids are not u32");
    };
    for triangle in &proxy.mesh().triangles {
        let [a, b, c] = triangle.map(|v| ids[v as usize]);
        assert!(a == b && b == c, "{name}");
        assert!(a < objects || proxy.kind != ProxyKind::Merged && a == NO_OBJECT);
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("proxy.glb");
    karui_io::write(&path, &proxy.scene).unwrap();
    let back = load(&path);
    assert_eq!(back.images, proxy.pictures(), "{name}");
    assert_eq!(back.scene.triangle_count(), proxy.triangles(), "{name}");
}

/// Makes all kinds, at the size of `pixels`; FLIP of each.
fn run(name: &str, placed: &[(&Loaded, DMat4)], whole: bool, pixels: u32) -> Vec<(ProxyKind, f64)> {
    let looks: Vec<Look> = placed
        .iter()
        .map(|(l, _)| Look::of_scene(&l.scene, &l.images))
        .collect();
    let members = members(placed, &looks, whole);
    let objects = if whole { placed.len() } else { members.len() } as u32;
    let group = Group::new(&members).unwrap();
    println!(
        "{name}: {} members, {} triangles",
        members.len(),
        group.triangles()
    );
    let error = group.bounds().diagonal() / f64::from(pixels);
    let start = Instant::now();
    let solid = box_proxy(&group, &BoxOptions::default()).unwrap();
    let after_box = start.elapsed();
    let cards = ImpostorOptions {
        pixels,
        ..ImpostorOptions::default()
    };
    let cards = impostor(&group, &cards).unwrap();
    let after_cards = start.elapsed();
    let joined = MergedOptions {
        stop: Stop::error(error),
        pixels,
        ..MergedOptions::default()
    };
    let joined = merged(&group, &joined).unwrap();
    println!(
        "  box {after_box:?}, cards {:?}, merged {:?}",
        after_cards - after_box,
        start.elapsed() - after_cards
    );
    let original = pictures_of(placed, &group, pixels);
    let mut rows = vec![original];
    let mut found = Vec::new();
    for proxy in [solid, cards, joined].into_iter().flatten() {
        check(name, &proxy, &group, objects);
        let pictures = pictures_of_proxy(&proxy, &group, pixels);
        let seen = difference(&rows[0], &pictures);
        println!(
            "  {:?}: {} triangles, {} bytes, error {:.4} ({:.1} px), FLIP {seen:.4}, {} materials, {} images",
            proxy.kind,
            proxy.triangles(),
            proxy.bytes,
            proxy.error,
            proxy.error / error,
            proxy.scene.materials.len(),
            proxy.scene.images.len(),
        );
        found.push((proxy.kind, seen));
        if let Some(folder) = std::env::var_os("KARUI_PICTURES") {
            for (i, picture) in proxy.pictures().into_iter().flatten().enumerate() {
                let file = format!("{name}-{:?}-{i}.png", proxy.kind);
                let bytes = karui_io::encode_png(&picture).unwrap();
                std::fs::write(Path::new(&folder).join(file), bytes).unwrap();
            }
        }
        rows.push(pictures);
    }
    if let Some(folder) = std::env::var_os("KARUI_PICTURES") {
        let bytes = karui_io::encode_png(&sheet(&rows)).unwrap();
        std::fs::write(Path::new(&folder).join(format!("{name}.png")), bytes).unwrap();
    }
    let options = ChooseOptions {
        pixels,
        ..ChooseOptions::default()
    };
    let start = Instant::now();
    let choice = choose(&group, &options).unwrap();
    let proxy = choice.proxy.unwrap();
    println!(
        "  chosen {:?}, {} triangles, FLIP {:.4}, within {}, {:?}",
        proxy.kind,
        proxy.triangles(),
        proxy.image_error.unwrap(),
        choice.within,
        start.elapsed()
    );
    found
}

/// The kinds are there, and what they show differs by no more than these.
fn assert_seen(name: &str, found: &[(ProxyKind, f64)], most: [f64; 3]) {
    let kinds = [ProxyKind::Box, ProxyKind::Impostor, ProxyKind::Merged];
    for (kind, most) in kinds.into_iter().zip(most) {
        let seen = found.iter().find(|f| f.0 == kind).map(|f| f.1);
        assert!(seen.is_some_and(|s| s < most), "{name} {kind:?}: {seen:?}");
    }
}

#[test]
fn models_of_many_parts_are_merged() {
    let Some(folder) = models() else { return };
    for (name, file, most) in [
        (
            "helmet",
            "gltf/FlightHelmet/FlightHelmet.gltf",
            [1.0, 0.75, 0.3],
        ),
        ("palm", "gltf/PalmTree/PalmTree.gltf", [1.0, 0.75, 0.3]),
        ("engine", "gltf/2CylinderEngine.glb", [1.0, 0.75, 0.3]),
    ] {
        let loaded = load(&folder.join(file));
        let found = run(name, &[(&loaded, DMat4::IDENTITY)], false, 128);
        assert_seen(name, &found, most);
    }
}

#[test]
fn a_block_of_a_city_is_merged() {
    let Some(folder) = models() else { return };
    let parts = [
        "building_A",
        "building_C",
        "building_E",
        "car_taxi",
        "bush",
        "streetlight",
        "watertower",
        "base",
        "bench",
        "dumpster",
    ];
    let folder = folder.join("scenes/kaykit-city");
    let loaded: Vec<Loaded> = parts
        .iter()
        .map(|part| load(&folder.join(format!("{part}.gltf"))))
        .collect();
    let placed: Vec<(&Loaded, DMat4)> = (0..30)
        .map(|i: usize| {
            let cell = DVec3::new((i % 6) as f64 * 2.0, 0.0, (i / 6) as f64 * 2.0);
            // Far away, where f32 knows no centimetres.
            let place = DMat4::from_translation(cell + DVec3::new(1e7, 0.0, -1e7));
            let turn = DMat4::from_rotation_y(i as f64 * std::f64::consts::FRAC_PI_2);
            (&loaded[i * 7 % 10], place * turn)
        })
        .collect();
    let found = run("city", &placed, true, 128);
    assert_seen("city", &found, [1.0, 0.75, 0.3]);
}
