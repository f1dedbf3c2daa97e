//! A page that follows the deltas has the library's surface, whatever it was sent before.

#[allow(dead_code, reason = "each test file uses a part of it")]
mod replay;

use glam::Vec3;
use karui::PolyMesh;
use karui::geom::{Aabb, Camera};
use karui::progress::Silent;
use karui::subdiv::adaptive::{Adaptive, AdaptiveOptions, View};
use karui::subdiv::{
    Cage, ControlMesh, CreaseMethod, Scheme, SubdivOptions, SurfaceOptions, subdivide,
};
use karui_viewer::adaptive::AdaptiveSession;
use karui_viewer::live::{FLAG_TRUNCATED, Session};
use proptest::prelude::*;
use replay::{Corners, Page, word};
use serde_json::{Value, json};

const SIZE: [u32; 2] = [800, 600];

/// A cube whose upper face is a fan of four triangles, with one sharp edge.
fn house() -> ControlMesh {
    let quads = [
        [0, 1, 3, 2],
        [4, 6, 7, 5],
        [0, 4, 5, 1],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
    ];
    let roof = [[1, 5, 8], [5, 7, 8], [7, 3, 8], [3, 1, 8]];
    let mut cage = Cage {
        vertices: 9,
        offsets: vec![0],
        ..Cage::default()
    };
    for face in quads
        .iter()
        .map(|f| &f[..])
        .chain(roof.iter().map(|f| &f[..]))
    {
        cage.indices.extend(face);
        cage.offsets.push(cage.indices.len() as u32);
    }
    let corner = |i: u32| Vec3::new((i >> 2) as f32, (i >> 1 & 1) as f32, (i & 1) as f32);
    let mut positions: Vec<Vec3> = (0..8).map(corner).collect();
    positions.push(Vec3::new(0.5, 0.5, 1.6));
    ControlMesh {
        cage,
        positions,
        ..ControlMesh::default()
    }
}

/// Five corners a face: nothing is split where it is not seen.
fn prism() -> ControlMesh {
    let mut cage = Cage {
        vertices: 10,
        offsets: vec![0, 5, 10],
        indices: vec![4, 3, 2, 1, 0, 5, 6, 7, 8, 9],
        ..Cage::default()
    };
    for i in 0..5u32 {
        let j = (i + 1) % 5;
        cage.indices.extend([i, j, j + 5, i + 5]);
        cage.offsets.push(cage.indices.len() as u32);
    }
    let place = |i: u32| {
        let angle = 1.256_637 * (i % 5) as f32;
        Vec3::new(angle.cos(), angle.sin(), (i / 5) as f32)
    };
    ControlMesh {
        cage,
        positions: (0..10).map(place).collect(),
        ..ControlMesh::default()
    }
}

fn camera(control: &ControlMesh, angle: f32, distance: f32) -> Camera {
    let bounds = Aabb::of(control.positions.iter().copied());
    let direction = Vec3::new(angle.sin(), 0.5 * (2.0 * angle).cos(), angle.cos());
    let mut camera = Camera::looking_at(bounds, direction, 30f32.to_radians());
    camera.eye = camera.target + (camera.eye - camera.target) * distance;
    camera
}

fn message(camera: &Camera, seq: u32, more: &Value) -> String {
    let mut message = json!({
        "seq": seq, "size": SIZE,
        "frame": { "camera": {
            "eye": camera.eye.to_array(), "target": camera.target.to_array(), "fov": 30,
        }, "lights": [] },
    });
    let all = message.as_object_mut().expect("an object");
    all.extend(more.as_object().expect("an object").clone());
    message.to_string()
}

/// Every face as a fan from its first corner.
fn corners(mesh: &PolyMesh) -> Vec<Corners> {
    let place = |v: u32| mesh.positions[v as usize].to_array().map(f32::to_bits);
    let mut all = Vec::new();
    for ends in mesh.offsets.windows(2) {
        let face = &mesh.indices[ends[0] as usize..ends[1] as usize];
        let fan = (1..face.len() - 1).map(|i| [face[0], face[i], face[i + 1]].map(place));
        all.extend(fan);
    }
    all.sort_unstable();
    all
}

/// The library's mesh, with nothing kept from other frames.
fn adaptive(control: &ControlMesh, camera: Camera, how: &AdaptiveOptions) -> Vec<Corners> {
    let options = SubdivOptions::default();
    let mut fresh = Adaptive::new(&control.cage, &control.positions, &options).expect("a cage");
    let view = View {
        camera,
        size: SIZE,
        lights: Vec::new(),
    };
    corners(&fresh.refine(&view, how).expect("refines").mesh)
}

#[test]
fn surfaces_are_the_librarys_along_a_path() {
    for control in [house(), prism()] {
        let mut session = AdaptiveSession::new(&control);
        let mut page = Page::default();
        for (seq, i) in (1..).zip(0u16..20) {
            let at = camera(&control, 0.2 * f32::from(i), 0.6 + 0.05 * f32::from(i));
            let how = json!({ "options": { "how": { "scheme": "adaptive", "pixels": 2.0 } } });
            let frame = session.answer(&message(&at, seq, &how)).expect("answers");
            page.apply(&frame);
            let expected = adaptive(&control, at, &AdaptiveOptions::within(2.0));
            assert!(page.triangles() == expected, "{seq}");
        }
    }
}

#[test]
fn depths_and_budgets_do_as_in_the_library() {
    let control = house();
    let mut session = AdaptiveSession::new(&control);
    let mut page = Page::default();
    let at = camera(&control, 0.4, 1.0);
    let depths = json!({ "options": { "how": {
        "scheme": "adaptive", "depth_front": 3, "depth_silhouette": 6,
    } } });
    page.apply(&session.answer(&message(&at, 1, &depths)).expect("answers"));
    let how = AdaptiveOptions {
        depth_front: 3,
        depth_silhouette: 6,
        ..AdaptiveOptions::default()
    };
    assert!(page.triangles() == adaptive(&control, at, &how));
    let few = json!({ "budget": { "triangles": 200 } });
    let frame = session.answer(&message(&at, 2, &few)).expect("answers");
    page.apply(&frame);
    assert_eq!(word(&frame, 3) & FLAG_TRUNCATED, FLAG_TRUNCATED);
}

#[test]
fn uniform_schemes_are_the_librarys() {
    let control = house();
    let mut session = AdaptiveSession::new(&control);
    let mut page = Page::default();
    let at = camera(&control, 0.4, 1.0);
    let schemes = [
        ("catmull-clark", Scheme::CatmullClark),
        ("sqrt2", Scheme::Sqrt2),
        ("bilinear", Scheme::Bilinear),
    ];
    for (seq, (name, scheme)) in (1..).zip(schemes) {
        let how =
            json!({ "options": { "how": { "scheme": name, "levels": 3 }, "creases": "chaikin" } });
        page.apply(&session.answer(&message(&at, seq, &how)).expect("answers"));
        let options = SubdivOptions {
            scheme,
            levels: 3,
            creases: CreaseMethod::Chaikin,
            ..SubdivOptions::default()
        };
        let looks = SurfaceOptions {
            normals: true,
            ..SurfaceOptions::default()
        };
        let made = subdivide(&control, &options, looks, &Silent).expect("a surface");
        assert!(page.triangles() == corners(&made.mesh), "{name}");
    }
}

#[test]
fn hostile_messages_are_refused() {
    let control = house();
    let mut session = AdaptiveSession::new(&control);
    let mut page = Page::default();
    let at = camera(&control, 0.4, 1.0);
    page.apply(
        &session
            .answer(&message(&at, 1, &json!({})))
            .expect("answers"),
    );
    let before = page.triangles();
    let wrong = [
        json!({ "scheme": "adaptive", "pixels": 0 }),
        json!({ "scheme": "adaptive", "pixels": -1 }),
        json!({ "scheme": "adaptive", "pixels": "wide" }),
        json!({ "scheme": "adaptive", "depth_front": 31 }),
        json!({ "scheme": "none", "levels": 1 }),
        json!({ "scheme": "catmull-clark", "levels": 13 }),
        json!({ "scheme": "catmull-clark", "levels": 12 }),
        json!({ "scheme": "catmull-clark" }),
        // Quads are no triangles.
        json!({ "scheme": "loop", "levels": 1 }),
        json!(7),
    ];
    for how in &wrong {
        let text = message(&at, 2, &json!({ "options": { "how": how } }));
        assert!(session.answer(&text).is_err(), "{how}");
    }
    for text in ["", "{}", "\u{0}", &message(&at, 1, &json!({}))] {
        assert!(session.answer(text).is_err(), "{text}");
    }
    let mut far = at;
    far.eye = Vec3::splat(f32::MAX);
    far.target = -far.eye;
    // Whatever becomes of numbers that are no picture, it is no panic.
    let _told = session.answer(&message(&far, 2, &json!({})));
    page = Page::default();
    let mut session = AdaptiveSession::new(&control);
    page.apply(
        &session
            .answer(&message(&at, 1, &json!({})))
            .expect("answers"),
    );
    assert!(page.triangles() == before);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Views, tolerances and schemes in any order.
    #[test]
    fn deltas_add_up(steps in prop::collection::vec((-7f32..7.0, 0.2f32..3.0, 0.3f64..30.0, 0u32..4), 1..10)) {
        let control = prism();
        let mut session = AdaptiveSession::new(&control);
        let mut page = Page::default();
        for (seq, (angle, distance, pixels, levels)) in (1..).zip(steps) {
            let at = camera(&control, angle, distance);
            let uniform = levels > 2;
            let how = match uniform {
                true => json!({ "scheme": "catmull-clark", "levels": levels - 1 }),
                false => json!({ "scheme": "adaptive", "pixels": pixels }),
            };
            let text = message(&at, seq, &json!({ "options": { "how": how } }));
            page.apply(&session.answer(&text).expect("answers"));
            if !uniform {
                let expected = adaptive(&control, at, &AdaptiveOptions::within(pixels));
                prop_assert!(page.triangles() == expected);
            }
        }
    }
}
