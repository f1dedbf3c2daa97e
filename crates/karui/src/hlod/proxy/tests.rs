//! Stand-ins against closed forms and against the members themselves.

use super::join::ids_of;
use super::*;
use crate::Error;
use crate::geom::{DMat4, DVec3, Vec4, normal_times_two_areas};
use crate::lod::{Screen, SeenOptions, seen_flip};
use crate::mesh::{AlphaMode, Material, MaterialRange, Texture, TextureRef, TriMesh, Wrap, shapes};
use crate::render::{Model, Picture};
use crate::simplify::Stop;
use crate::spatial::Bvh;
use proptest::prelude::*;

mod looks;

fn at(x: f64, y: f64, z: f64) -> DMat4 {
    DMat4::from_translation(DVec3::new(x, y, z))
}

fn member<'a>(mesh: &'a TriMesh, place: DMat4, look: &'a Look<'a>, id: u32) -> Member<'a> {
    Member {
        mesh,
        world_from_mesh: place,
        look,
        objects: Objects::One(id),
        error: 0.0,
    }
}

fn of_material(mut mesh: TriMesh, material: u32) -> TriMesh {
    mesh.ranges = vec![MaterialRange {
        count: mesh.triangles.len() as u32,
        material: Some(material),
        ..MaterialRange::default()
    }];
    mesh
}

fn colored(color: Vec4) -> Material {
    Material {
        base_color: color,
        ..Material::default()
    }
}

const RED: Vec4 = Vec4::new(1.0, 0.0, 0.0, 1.0);
const BLUE: Vec4 = Vec4::new(0.0, 0.0, 1.0, 1.0);

/// Every triangle's object; fails where its corners are not of one.
fn objects(mesh: &TriMesh) -> Vec<u32> {
    let ids = ids_of(&mesh.attributes).unwrap();
    let of = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| ids[v as usize]);
        assert!(a == b && b == c, "{a} {b} {c}");
        a
    };
    mesh.triangles.iter().map(of).collect()
}

fn volume(mesh: &TriMesh) -> f64 {
    let six = |t| {
        let [a, b, c] = mesh.corners(t);
        a.dot(b.cross(c))
    };
    (0..mesh.triangles.len()).map(six).sum::<f64>() / 6.0
}

fn in_pool<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.build().unwrap().install(work)
}

#[test]
fn the_corners_of_a_box_are_as_far_from_a_ball_as_they_are() {
    let (ball, look) = (shapes::icosphere(5), Look::default());
    let members = [member(&ball, at(5.0, 6.0, 7.0), &look, 3)];
    let group = Group::new(&members).unwrap();
    let proxy = box_proxy(&group, &BoxOptions::default()).unwrap().unwrap();
    assert_eq!((proxy.triangles(), proxy.kind), (12, ProxyKind::Box));
    assert!(
        (proxy.error - (3f64.sqrt() - 1.0)).abs() < 0.01,
        "{}",
        proxy.error
    );
    assert!(proxy.origin.distance(DVec3::new(5.0, 6.0, 7.0)) < 1e-6);
    assert!((volume(proxy.mesh()) - 8.0).abs() < 1e-3);
    assert_eq!(objects(proxy.mesh()), [3; 12]);
}

#[test]
fn a_box_has_the_mean_colour_of_what_is_seen_and_may_be_seen_through() {
    let materials = [colored(RED), colored(BLUE)];
    let look = Look::new(&materials, &[], &[]);
    let (red, blue) = (
        of_material(shapes::cube(2), 0),
        of_material(shapes::cube(2), 1),
    );
    let inner = of_material(shapes::icosphere(1), 1);
    let members = [
        member(&red, at(0.0, 0.0, 0.0), &look, 0),
        member(&blue, at(1.0, 0.0, 0.0), &look, 1),
        // Not seen, and does not count.
        member(
            &inner,
            at(0.0, 0.0, 0.0) * DMat4::from_scale(DVec3::splat(0.1)),
            &look,
            2,
        ),
    ];
    let group = Group::new(&members).unwrap();
    let solid = box_proxy(&group, &BoxOptions::default()).unwrap().unwrap();
    let color = solid.scene.materials[0].base_color;
    assert!(
        (color - Vec4::new(0.5, 0.0, 0.5, 1.0)).abs().max_element() < 0.02,
        "{color}"
    );
    assert_eq!(objects(solid.mesh()), [NO_OBJECT; 12]);
    // Half of what is seen from along two axes, all along the third.
    let apart = [members[0], member(&blue, at(2.0, 0.0, 0.0), &look, 1)];
    let options = BoxOptions { blended: true };
    let group = Group::new(&apart).unwrap();
    let veil = box_proxy(&group, &options).unwrap().unwrap();
    let material = &veil.scene.materials[0];
    let expected = (4.0 * 2.0 + 2.0) / (4.0 * 3.0 + 2.0);
    assert!(
        (material.base_color.w - expected).abs() < 0.05,
        "{}",
        material.base_color.w
    );
    assert_eq!(material.alpha_mode, AlphaMode::Blend);
}

#[test]
fn triangles_of_merged_members_keep_their_object() {
    let (ball, torus, look) = (
        shapes::icosphere(3),
        shapes::torus(1.0, 0.4, 32, 16),
        Look::default(),
    );
    let members: Vec<Member> = (0..30)
        .map(|i| {
            let mesh = if i % 2 == 0 { &ball } else { &torus };
            let place = at(f64::from(i % 6) * 3.0, 0.0, f64::from(i / 6) * 3.0);
            member(mesh, place, &look, 100 + i)
        })
        .collect();
    let group = Group::new(&members).unwrap();
    let proxy = merged(&group, &MergedOptions::default()).unwrap().unwrap();
    proxy.scene.validate().unwrap();
    assert!(proxy.triangles() <= group.triangles() / 4);
    let mesh = proxy.mesh();
    let index = Bvh::build(&group.mesh).unwrap();
    let known = objects(&group.mesh);
    for (t, id) in objects(mesh).into_iter().enumerate() {
        let [a, b, c] = mesh.corners(t);
        let hit = index.closest((a + b + c) / 3.0);
        assert_eq!(known[hit.triangle as usize], id);
    }
    assert!(proxy.error > 0.0 && proxy.error < 0.5, "{}", proxy.error);
}

#[test]
fn objects_that_touch_are_not_mixed() {
    let (block, look) = (shapes::cube(6), Look::default());
    let members: Vec<Member> = (0..8)
        .map(|i| {
            let place = at(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
            member(&block, place, &look, i)
        })
        .collect();
    let group = Group::new(&members).unwrap();
    let options = MergedOptions {
        stop: Stop::ratio(0.1),
        ..MergedOptions::default()
    };
    let proxy = merged(&group, &options).unwrap().unwrap();
    let mut seen = objects(proxy.mesh());
    seen.sort_unstable();
    seen.dedup();
    assert_eq!(seen, [0, 1, 2, 3, 4, 5, 6, 7]);
}

#[test]
fn what_is_inside_is_left_out_unless_it_can_be_seen() {
    let glass = Material {
        alpha_mode: AlphaMode::Blend,
        ..colored(RED)
    };
    let materials = [colored(RED), glass];
    let look = Look::new(&materials, &[], &[]);
    let ball = of_material(shapes::icosphere(3), 0);
    let small = DMat4::from_scale(DVec3::splat(0.2));
    let kept = |shell: &TriMesh, place: DMat4| {
        let members = [
            member(shell, place, &look, 0),
            member(&ball, small, &look, 1),
        ];
        let group = Group::new(&members).unwrap();
        let options = MergedOptions {
            stop: Stop::error(1e-4),
            ..MergedOptions::default()
        };
        let hidden = hidden::hidden(&group).unwrap();
        let merged = merged(&group, &options).unwrap();
        let kept = hidden.iter().filter(|h| !**h).count();
        if let Some(merged) = merged {
            assert!(merged.triangles() <= kept);
        }
        kept == group.triangles()
    };
    let shell = of_material(shapes::closed_cube(8), 0);
    let whole = DMat4::IDENTITY;
    assert!(!kept(&shell, whole));
    // A window of one in 384.
    let mut window = shell.clone();
    window.retain_triangles(|t| t != 37);
    assert!(kept(&window, whole));
    // Glass, the insides of one-sided walls, walls that do not reach far enough.
    assert!(kept(&of_material(shapes::closed_cube(8), 1), whole));
    let mut inside_out = shell.clone();
    inside_out.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    assert!(kept(&inside_out, whole));
    assert!(kept(&shell, at(0.4, 0.0, 0.0)));
    // Mirroring turns nothing inside out.
    assert!(!kept(&shell, DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0))));
}

#[test]
fn errors_do_not_shrink_towards_the_root() {
    let (ball, look) = (shapes::icosphere(3), Look::default());
    let group_at = |x: f64| {
        let placed = |i: u32| Member {
            error: 0.01,
            ..member(&ball, at(x + 3.0 * f64::from(i), 0.0, 0.0), &look, i)
        };
        let members: Vec<Member> = (0..4).map(placed).collect();
        Group::new(&members).unwrap()
    };
    let options = MergedOptions::default();
    let groups = [group_at(0.0), group_at(12.0)];
    let children: Vec<Proxy> = groups
        .iter()
        .map(|g| merged(g, &options).unwrap().unwrap())
        .collect();
    let pictures = children[0].pictures();
    let looks: Vec<Look> = children
        .iter()
        .map(|c| Look::of_scene(&c.scene, &pictures))
        .collect();
    let members: Vec<Member> = children
        .iter()
        .zip(&looks)
        .map(|(c, l)| c.member(l))
        .collect();
    let parent = Group::new(&members).unwrap();
    let least = children.iter().map(|c| c.error).fold(0.01, f64::max);
    let solid = box_proxy(&parent, &BoxOptions::default()).unwrap().unwrap();
    let joined = merged(&parent, &options).unwrap().unwrap();
    for proxy in [solid, joined] {
        assert!(proxy.error > least, "{} {least}", proxy.error);
    }
}

#[test]
fn far_from_the_origin_everything_is_as_near_it() {
    let (ball, look) = (shapes::icosphere(3), Look::default());
    let made = |far: f64| {
        let place = |i: u32| at(far + 3.0 * f64::from(i), -far, 0.5 * far);
        let members: Vec<Member> = (0..4).map(|i| member(&ball, place(i), &look, i)).collect();
        let group = Group::new(&members).unwrap();
        merged(&group, &MergedOptions::default()).unwrap().unwrap()
    };
    let (near, far) = (made(0.0), made(1e9));
    assert_eq!(near.triangles(), far.triangles());
    assert!((near.error - far.error).abs() < 1e-3 * near.error.max(0.1));
    assert_eq!(far.origin, near.origin + DVec3::new(1e9, -1e9, 0.5e9));
}

#[test]
fn mirrored_members_still_face_outwards() {
    let (ball, look) = (shapes::uv_sphere(16, 24), Look::default());
    let mirror = DMat4::from_scale(DVec3::new(-1.0, 2.0, 1.0));
    let members = [member(&ball, mirror, &look, 0)];
    let group = Group::new(&members).unwrap();
    assert!(volume(&group.mesh) > 8.0);
    let proxy = merged(&group, &MergedOptions::default()).unwrap().unwrap();
    assert!(volume(proxy.mesh()) > 7.0);
    let normals = proxy.mesh().attributes.normals.as_ref();
    for (t, triangle) in proxy.mesh().triangles.iter().enumerate() {
        let Some(normals) = normals else { break };
        let normal = normal_times_two_areas(proxy.mesh().corners(t)).as_vec3();
        assert!(
            triangle
                .iter()
                .all(|&v| normals[v as usize].dot(normal) > 0.0)
        );
    }
}

/// A board of 256 x 256 texels, `cell` texels a field.
fn checks(cell: u32) -> Picture {
    let field = |i: u32| {
        let (x, y) = (i % 256 / cell, i / 256 / cell);
        if (x + y) % 2 == 0 {
            [255; 4]
        } else {
            [0, 0, 0, 255]
        }
    };
    Picture::new(256, 256, (0..256 * 256).map(field).collect()).unwrap()
}

struct Textured {
    materials: Vec<Material>,
    textures: Vec<Texture>,
    images: Vec<Option<Picture>>,
}

impl Textured {
    fn new(pictures: Vec<Picture>) -> Self {
        let materials = (0..pictures.len() as u32).map(|texture| Material {
            base_color_texture: Some(TextureRef {
                texture,
                uv_set: 0,
                transform: None,
            }),
            metallic: 0.0,
            ..Material::default()
        });
        let textures = (0..pictures.len() as u32).map(|image| Texture {
            image: Some(image),
            wrap: [Wrap::Repeat; 2],
            nearest: false,
        });
        Self {
            materials: materials.collect(),
            textures: textures.collect(),
            images: pictures.into_iter().map(Some).collect(),
        }
    }

    fn look(&self) -> Look<'_> {
        Look::new(&self.materials, &self.textures, &self.images)
    }
}

/// Mean FLIP of a proxy against its group, both `pixels` high.
fn flip_at(group: &Group<'_>, proxy: &Proxy, pixels: f64) -> f64 {
    let outfit = outfit::Outfit::of(&group.slots);
    let pictures = proxy.pictures();
    let options = SeenOptions {
        views: 6,
        ..SeenOptions::default()
    };
    let screen = Screen {
        tolerance_px: pixels,
        ..options.screen
    };
    let distance = screen.switch_distance(group.bounds().diagonal());
    let level = Model::of_scene(&proxy.scene, &pictures);
    seen_flip(&outfit.model(&group.mesh), &level, distance, &options).unwrap()
}

#[test]
fn threads_change_nothing() {
    let textured = Textured::new(vec![checks(64), checks(32)]);
    let look = textured.look();
    let ball = of_material(shapes::textured_sphere(24, 48), 0);
    let block = of_material(shapes::cube(4), 1);
    let made = |threads| {
        in_pool(threads, || {
            let members: Vec<Member> = (0..6)
                .map(|i| {
                    member(
                        if i % 2 == 0 { &ball } else { &block },
                        at(f64::from(i), 0.3, 0.0),
                        &look,
                        i,
                    )
                })
                .collect();
            let group = Group::new(&members).unwrap();
            let options = MergedOptions {
                materials: 0,
                ..MergedOptions::default()
            };
            let solid = box_proxy(&group, &BoxOptions::default()).unwrap();
            let cards = impostor(&group, &ImpostorOptions::default()).unwrap();
            (solid, cards, merged(&group, &options).unwrap())
        })
    };
    let one = made(1);
    assert!(one.0.is_some() && one.1.is_some() && one.2.is_some());
    assert!(made(2) == one && made(8) == one);
}

/// All kinds of a group.
fn all(group: &Group<'_>) -> Vec<Proxy> {
    let solid = box_proxy(group, &BoxOptions::default()).unwrap();
    let cards = impostor(group, &ImpostorOptions::default()).unwrap();
    let joined = merged(group, &MergedOptions::default()).unwrap();
    [solid, cards, joined].into_iter().flatten().collect()
}

#[test]
fn nothing_to_stand_in_for_has_no_stand_in() {
    let look = Look::default();
    let (ball, empty, tiny) = (shapes::icosphere(2), shapes::empty(), shapes::triangle());
    let nowhere = DMat4::from_scale(DVec3::ZERO);
    let cases: [&[Member<'_>]; 4] = [
        &[],
        &[member(&empty, DMat4::IDENTITY, &look, 0)],
        &[member(&ball, nowhere, &look, 0); 3],
        &[member(&tiny, DMat4::IDENTITY, &look, 0)],
    ];
    for members in cases {
        assert_eq!(all(&Group::new(members).unwrap()), []);
    }
    // Flattened, but there.
    let flat = DMat4::from_scale(DVec3::new(1.0, 0.0, 1.0));
    let group = Group::new(&[member(&ball, flat, &look, 0)]).unwrap();
    all(&group).iter().for_each(|p| p.scene.validate().unwrap());
}

#[test]
fn what_makes_no_sense_is_an_error() {
    let look = Look::default();
    let ball = shapes::icosphere(1);
    let good = member(&ball, DMat4::IDENTITY, &look, 0);
    let mut broken = ball.clone();
    broken.positions[0].x = f32::NAN;
    let bad = [
        Member {
            world_from_mesh: DMat4::NAN,
            ..good
        },
        Member {
            world_from_mesh: at(f64::INFINITY, 0.0, 0.0),
            ..good
        },
        Member {
            world_from_mesh: DMat4::from_scale(DVec3::splat(1e300)),
            ..good
        },
        Member {
            error: f64::NAN,
            ..good
        },
        Member {
            error: -1.0,
            ..good
        },
        Member {
            mesh: &broken,
            ..good
        },
    ];
    for member in bad {
        assert!(Group::new(&[good, member]).is_err(), "{member:?}");
    }
    let materials = [colored(RED)];
    let (other, stray) = (
        Look::new(&materials, &[], &[]),
        of_material(ball.clone(), 7),
    );
    let stray = Member {
        look: &other,
        ..member(&stray, DMat4::IDENTITY, &look, 0)
    };
    assert!(matches!(
        Group::new(&[stray]),
        Err(Error::BadReference { to: 7, .. })
    ));
    let group = Group::new(&[good]).unwrap();
    for (pixels, side) in [(0, 64), (64, 16), (64, 1 << 20)] {
        let options = MergedOptions {
            pixels,
            side,
            ..MergedOptions::default()
        };
        assert!(merged(&group, &options).is_err());
        let options = ImpostorOptions {
            pixels,
            side,
            ..ImpostorOptions::default()
        };
        assert!(impostor(&group, &options).is_err());
    }
}

#[test]
fn many_at_one_place_are_no_trouble() {
    let (ball, look) = (shapes::icosphere(2), Look::default());
    let members: Vec<Member> = (0..100)
        .map(|i| member(&ball, DMat4::IDENTITY, &look, i))
        .collect();
    let group = Group::new(&members).unwrap();
    let options = MergedOptions {
        stop: Stop::ratio(0.02),
        ..MergedOptions::default()
    };
    let proxy = merged(&group, &options).unwrap().unwrap();
    assert!(proxy.triangles() < group.triangles());
    objects(proxy.mesh());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    #[test]
    fn never_more_triangles_nor_a_smaller_error(
        picks in prop::collection::vec((0usize..22, -3.0f64..3.0, -3.0f64..3.0, -1.5f64..1.5), 1..5),
        ratio in 0.0f64..1.2,
        error in 0.0f64..0.1,
    ) {
        let (zoo, look) = (shapes::zoo(), Look::default());
        let members: Vec<Member> = (0..).zip(&picks).map(|(i, &(shape, x, z, scale))| {
            let place = at(x, 0.0, z) * DMat4::from_scale(DVec3::new(scale, 1.0, 1.0));
            Member { error, ..member(&zoo[shape].1, place, &look, i) }
        }).collect();
        let group = Group::new(&members).unwrap();
        let options = MergedOptions { stop: Stop::ratio(ratio), ..MergedOptions::default() };
        let joined = merged(&group, &options).unwrap();
        for proxy in all(&group).into_iter().chain(joined) {
            prop_assert!(proxy.triangles() < group.triangles());
            prop_assert!(proxy.error >= error);
            proxy.scene.validate().unwrap();
            objects(proxy.mesh());
            prop_assert!(proxy.bytes > 0);
        }
    }
}
