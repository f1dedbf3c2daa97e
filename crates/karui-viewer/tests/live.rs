//! A page that follows the deltas has the library's cut, whatever it was sent before.

#[allow(dead_code, reason = "each test file uses a part of it")]
mod replay;

use glam::Vec3;
use karui::TriMesh;
use karui::geom::{Camera, Light, Projection};
use karui::hierarchy::cluster::{ClusterDag, ClusterDagOptions, View};
use karui::hierarchy::{Budget, Hierarchy, HierarchyOptions, Silhouette, ViewAndLight};
use karui::mesh::shapes;
use karui_viewer::live::{
    ClusterSession, FLAG_TRUNCATED, Geometry, HalfEdgeSession, LiveError, Session,
};
use proptest::prelude::*;
use replay::{Corners, Page, word};
use serde_json::{Value, json};

const SIZE: [u32; 2] = [640, 480];

fn meshes() -> Vec<TriMesh> {
    vec![
        shapes::icosphere(5),
        shapes::torus(1.0, 0.4, 80, 40),
        shapes::terrain(50, 60, 2),
    ]
}

/// What is looked at in step `i` of a walk: closer, farther, aside, with the light moving.
#[derive(Debug, Clone)]
struct Look {
    camera: Camera,
    light: Vec3,
}

impl Look {
    fn around(mesh: &TriMesh, angle: f32, distance: f32) -> Self {
        let direction = Vec3::new(angle.sin(), 0.4 * (1.7 * angle).cos(), angle.cos());
        let mut camera = Camera::looking_at(mesh.bounds(), direction, 30f32.to_radians());
        camera.eye = camera.target + (camera.eye - camera.target) * distance;
        // Aside, so that some of it is outside the picture.
        camera.target += Vec3::splat(0.1 * (3.0 * angle).sin());
        let light = camera.eye + Vec3::new(3.0 * (2.0 * angle).sin(), 2.0, 0.0);
        Self { camera, light }
    }

    /// As a page sends it.
    fn message(&self, seq: u32, more: &Value) -> String {
        let Projection::Perspective { fov_y } = self.camera.projection else {
            panic!("has a perspective");
        };
        let mut message = json!({
            "seq": seq, "size": SIZE,
            "frame": {
                "camera": {
                    "eye": self.camera.eye.to_array(), "target": self.camera.target.to_array(),
                    "fov": fov_y.to_degrees(),
                },
                "lights": [{ "type": "point", "position": self.light.to_array() }],
            },
        });
        let all = message.as_object_mut().expect("an object");
        all.extend(more.as_object().expect("an object").clone());
        message.to_string()
    }

    /// As the message has it: an angle in degrees is not the same to the last bit.
    fn sent(&self) -> Camera {
        let Projection::Perspective { fov_y } = self.camera.projection else {
            panic!("has a perspective");
        };
        let fov_y = fov_y.to_degrees().to_radians();
        Camera {
            projection: Projection::Perspective { fov_y },
            ..self.camera
        }
    }

    /// The library's criteria, spelt out.
    fn criteria(&self, area: f64) -> ViewAndLight {
        ViewAndLight {
            camera: self.sent(),
            size: SIZE,
            lights: vec![Light::Point {
                position: self.light,
                color: Vec3::ONE,
                intensity: 1.0,
            }],
            area,
            silhouette: Silhouette::Kept { area: 9.0 },
            highlight: 10.0,
            ..ViewAndLight::default()
        }
    }
}

fn walk(mesh: &TriMesh) -> Vec<Look> {
    let look = |i: u16| {
        let i = f32::from(i);
        Look::around(mesh, 0.13 * i, 0.35 + 0.3 * (0.5 * i).sin().abs())
    };
    (0..24).map(look).collect()
}

fn half_edge_options(area: f64) -> Value {
    json!({ "options": { "area": area, "silhouette": 9.0, "highlight": 10.0 } })
}

fn corners(mesh: &TriMesh, triangles: impl IntoIterator<Item = [u32; 3]>) -> Vec<Corners> {
    let place = |v: u32| mesh.positions[v as usize].to_array().map(f32::to_bits);
    let mut all: Vec<Corners> = triangles.into_iter().map(|t| t.map(place)).collect();
    all.sort_unstable();
    all
}

/// The library's cut, made from the finest mesh down: the session comes from the other side.
fn half_edge_cut(mesh: &TriMesh, hierarchy: &Hierarchy, criteria: &ViewAndLight) -> Vec<Corners> {
    let mut cut = hierarchy.finest();
    cut.refine(criteria, Budget::UNLIMITED).expect("refines");
    corners(mesh, cut.triangles().into_iter().map(|t| t.1))
}

#[test]
fn half_edges_are_the_librarys_cut_along_a_path() {
    for mesh in meshes() {
        let geometry = Geometry::of(&mesh).expect("geometry");
        let hierarchy = Hierarchy::build(&mesh, &HierarchyOptions::default()).expect("builds");
        let mut session = HalfEdgeSession::new(&geometry, &hierarchy).expect("fits");
        let mut page = Page::default();
        for (seq, look) in (1..).zip(walk(&mesh)) {
            let message = look.message(seq, &half_edge_options(30.0));
            let frame = session.answer(&message).expect("answers");
            page.apply(&frame);
            let expected = half_edge_cut(&mesh, &hierarchy, &look.criteria(30.0));
            assert!(page.triangles() == expected, "frame {seq}");
            assert_eq!((word(&frame, 2), word(&frame, 3)), (seq, 2));
        }
        // The same again: nothing but a header.
        let last = walk(&mesh).pop().expect("a walk");
        let frame = session.answer(&last.message(99, &half_edge_options(30.0)));
        assert_eq!(frame.expect("answers").len(), 64);
    }
}

#[test]
fn clusters_are_the_librarys_cut_along_a_path() {
    for mesh in meshes() {
        let geometry = Geometry::of(&mesh).expect("geometry");
        let dag = ClusterDag::build(&mesh, &ClusterDagOptions::default()).expect("builds");
        let mut session = ClusterSession::new(&geometry, &dag).expect("fits");
        let mut page = Page::default();
        for (seq, look) in (1..).zip(walk(&mesh)) {
            let options = json!({ "options": { "threshold": 0.8 } });
            let frame = session
                .answer(&look.message(seq, &options))
                .expect("answers");
            page.apply(&frame);
            let view = View {
                height: SIZE[1] as f32,
                aspect: SIZE[0] as f32 / SIZE[1] as f32,
                threshold: 0.8,
                frustum: true,
                ..View::new(look.sent())
            };
            let cut = dag.cut(&view).expect("cuts");
            assert_eq!(session.cut(), cut.clusters());
            assert_eq!(page.cut(), cut.clusters());
            assert!(page.triangles() == corners(&mesh, cut.triangles()), "{seq}");
        }
    }
}

#[test]
fn a_budget_of_clusters_is_kept_with_the_librarys_cut_of_the_threshold_told() {
    let mesh = shapes::icosphere(6);
    let geometry = Geometry::of(&mesh).expect("geometry");
    let dag = ClusterDag::build(&mesh, &ClusterDagOptions::default()).expect("builds");
    let mut session = ClusterSession::new(&geometry, &dag).expect("fits");
    let mut page = Page::default();
    let look = Look::around(&mesh, 0.3, 0.6);
    for (seq, most) in [(1, 20_000), (2, 3000), (3, 1500), (4, 0)] {
        let more = json!({ "options": { "threshold": 0.05 }, "budget": { "triangles": most } });
        let frame = session.answer(&look.message(seq, &more)).expect("answers");
        page.apply(&frame);
        let threshold = f32::from_bits(word(&frame, 13));
        let view = View {
            height: SIZE[1] as f32,
            aspect: SIZE[0] as f32 / SIZE[1] as f32,
            threshold,
            frustum: true,
            ..View::new(look.sent())
        };
        let cut = dag.cut(&view).expect("cuts");
        assert!(
            page.triangles() == corners(&mesh, cut.triangles()),
            "{most}"
        );
        let kept = cut.triangle_count() <= most || cut.triangle_count() <= dag.triangles_of_roots();
        assert!(kept, "{most}: {}", cut.triangle_count());
        assert_eq!(word(&frame, 3) & FLAG_TRUNCATED != 0, threshold > 0.05);
        if most == 3000 {
            assert!(cut.triangle_count() > most / 3, "{}", cut.triangle_count());
        }
    }
}

#[test]
fn a_budget_of_half_edges_is_kept() {
    let mesh = shapes::terrain(60, 60, 3);
    let geometry = Geometry::of(&mesh).expect("geometry");
    let hierarchy = Hierarchy::build(&mesh, &HierarchyOptions::default()).expect("builds");
    let mut session = HalfEdgeSession::new(&geometry, &hierarchy).expect("fits");
    let mut page = Page::default();
    for (seq, look) in (1..).zip(walk(&mesh)) {
        let mut more = half_edge_options(4.0);
        more["budget"] = json!({ "triangles": 2000 });
        page.apply(&session.answer(&look.message(seq, &more)).expect("answers"));
        let mut cut = hierarchy.coarsest();
        let criteria = look.criteria(4.0);
        cut.refine(&criteria, Budget::triangles(2000))
            .expect("refines");
        let expected = corners(&mesh, cut.triangles().into_iter().map(|t| t.1));
        assert!(page.triangles() == expected && expected.len() <= 2000);
    }
}

/// A frame without the time that it took.
fn timeless(mut frame: Vec<u8>) -> Vec<u8> {
    frame[40..44].fill(0);
    frame
}

#[test]
fn frames_are_the_same_bytes_for_any_number_of_threads() {
    let mesh = shapes::terrain(120, 130, 5);
    let geometry = Geometry::of(&mesh).expect("geometry");
    let frames = |threads| -> Vec<Vec<u8>> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("a pool").install(|| {
            let hierarchy = Hierarchy::build(&mesh, &HierarchyOptions::default()).expect("builds");
            let dag = ClusterDag::build(&mesh, &ClusterDagOptions::default()).expect("builds");
            let mut half_edges = HalfEdgeSession::new(&geometry, &hierarchy).expect("fits");
            let mut clusters = ClusterSession::new(&geometry, &dag).expect("fits");
            let mut all = Vec::new();
            for (seq, look) in (1..).zip(walk(&mesh)) {
                let message = look.message(seq, &half_edge_options(4.0));
                all.push(timeless(half_edges.answer(&message).expect("answers")));
                let message = look.message(seq, &json!({}));
                all.push(timeless(clusters.answer(&message).expect("answers")));
            }
            all
        })
    };
    let one = frames(1);
    assert!(frames(2) == one && frames(8) == one);
}

/// Messages that are none; the answer is an error, and nothing has changed.
fn hostile(look: &Look) -> Vec<String> {
    let good: Value = serde_json::from_str(&look.message(50, &json!({}))).expect("JSON");
    let with = |pointer: &str, value: Value| {
        let mut bad = good.clone();
        *bad.pointer_mut(pointer).expect("there") = value;
        bad.to_string()
    };
    let light = json!({ "type": "point", "position": [0, 0, 0] });
    let mut all: Vec<String> = ["", "bytes", "{}", "[]", "null", "\u{0}\u{1}", "{\"seq\":1"]
        .map(str::to_owned)
        .to_vec();
    all.extend([
        with("/frame/camera/eye", json!([null, 0, 0])),
        with("/frame/camera/eye/0", json!(1e39)),
        with("/frame/camera/target/2", json!(-1e300)),
        with("/frame/camera/fov", json!(0)),
        with("/frame/camera/fov", json!(1e9)),
        with("/frame/camera/eye", json!(look.camera.target.to_array())),
        with("/size", json!([0, 480])),
        with("/size", json!([640, -1])),
        with("/size", json!([640, 1e12])),
        with("/seq", json!(-1)),
        with("/seq", json!(1e10)),
        with("/frame/lights", json!(vec![light; 9])),
        with("/frame", json!({})),
        good.to_string().replace("NaN", "").replace("640", "NaN"),
        format!("{}x", look.message(51, &json!({}))),
        look.message(52, &json!({ "budget": { "milliseconds": -1 } })),
        look.message(53, &json!({ "budget": { "milliseconds": 1e300 } })),
        look.message(54, &json!({ "budget": { "triangles": -5 } })),
        look.message(55, &json!({ "budget": { "triangles": 1e30 } })),
        look.message(56, &json!({ "options": { "no such option": 1 } })),
        look.message(57, &json!({ "more": 1 })),
        "[".repeat(100_000),
    ]);
    all
}

fn stands_fast(session: &mut dyn Session, mesh: &TriMesh, wrong: &[Value]) {
    let looks = walk(mesh);
    let mut page = Page::default();
    page.apply(
        &session
            .answer(&looks[0].message(7, &json!({})))
            .expect("answers"),
    );
    let before = page.triangles();
    let mut bad = hostile(&looks[1]);
    bad.extend(
        wrong
            .iter()
            .map(|w| looks[1].message(60, &json!({ "options": w }))),
    );
    for message in &bad {
        let shown: String = message.chars().take(200).collect();
        assert!(session.answer(message).is_err(), "{shown}");
    }
    for seq in [0, 3, 7] {
        let old = session.answer(&looks[1].message(seq, &json!({})));
        assert!(matches!(old, Err(LiveError::OutOfOrder { last: 7, .. })));
    }
    // Nothing has changed: the same view is the same picture, without another word.
    let frame = session
        .answer(&looks[0].message(8, &json!({})))
        .expect("answers");
    assert_eq!(frame.len(), 64);
    page.apply(&frame);
    assert!(page.triangles() == before);
    // The largest numbers that make sense do.
    let huge = json!({ "budget": { "triangles": u64::MAX, "milliseconds": 1e9 } });
    let frame = session
        .answer(&looks[2].message(u32::MAX, &huge))
        .expect("answers");
    page.apply(&frame);
    assert!(session.answer(&looks[2].message(u32::MAX, &huge)).is_err());
}

#[test]
fn hostile_messages_are_refused() {
    let mesh = shapes::torus(1.0, 0.4, 60, 30);
    let geometry = Geometry::of(&mesh).expect("geometry");
    let hierarchy = Hierarchy::build(&mesh, &HierarchyOptions::default()).expect("builds");
    let dag = ClusterDag::build(&mesh, &ClusterDagOptions::default()).expect("builds");
    let mut half_edges = HalfEdgeSession::new(&geometry, &hierarchy).expect("fits");
    let wrong = [
        json!({ "area": -1 }),
        json!({ "flatness": 91 }),
        json!({ "highlight": 1e9 }),
    ];
    stands_fast(&mut half_edges, &mesh, &wrong);
    let mut clusters = ClusterSession::new(&geometry, &dag).expect("fits");
    let wrong = [
        json!({ "threshold": -1 }),
        json!({ "light_factor": 0 }),
        json!({ "light_factor": 2 }),
    ];
    stands_fast(&mut clusters, &mesh, &wrong);
}

#[test]
fn sessions_over_another_mesh_are_refused() {
    let [mesh, other] = [shapes::icosphere(4), shapes::icosphere(2)];
    let geometry = Geometry::of(&other).expect("geometry");
    let hierarchy = Hierarchy::build(&mesh, &HierarchyOptions::default()).expect("builds");
    assert!(HalfEdgeSession::new(&geometry, &hierarchy).is_err());
    let dag = ClusterDag::build(&mesh, &ClusterDagOptions::default()).expect("builds");
    assert!(ClusterSession::new(&geometry, &dag).is_err());
}

/// Where a page may be taken next, and what it may ask for there.
fn steps() -> impl Strategy<Value = Vec<(f32, f32, f64, Option<u32>, bool)>> {
    let step = (
        -7f32..7.0,
        0.2f32..3.0,
        prop_oneof![Just(0.0), 1f64..500.0],
        prop::option::of(0u32..6000),
        any::<bool>(),
    );
    prop::collection::vec(step, 1..12)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// However it jumps about, with budgets on and off and nonsense in between.
    #[test]
    fn deltas_add_up(steps in steps(), seed in 0u64..20) {
        let mesh = shapes::terrain(40, 37, seed);
        let geometry = Geometry::of(&mesh).expect("geometry");
        let hierarchy = Hierarchy::build(&mesh, &HierarchyOptions::default()).expect("builds");
        let dag = ClusterDag::build(&mesh, &ClusterDagOptions::default()).expect("builds");
        let mut half_edges = HalfEdgeSession::new(&geometry, &hierarchy).expect("fits");
        let mut clusters = ClusterSession::new(&geometry, &dag).expect("fits");
        let mut pages = [Page::default(), Page::default()];
        for (seq, (angle, distance, amount, most, nonsense)) in (1..).zip(steps) {
            let look = Look::around(&mesh, angle, distance);
            if nonsense {
                prop_assert!(half_edges.answer("nonsense").is_err());
                let wrong = look.message(seq, &json!({ "x": 0 }));
                prop_assert!(clusters.answer(&wrong).is_err());
            }
            let mut more = half_edge_options(amount);
            more["budget"] = json!({ "triangles": most });
            pages[0].apply(&half_edges.answer(&look.message(seq, &more)).expect("answers"));
            let mut cut = hierarchy.coarsest();
            let budget = Budget { triangles: most.map(|m| m as usize), time: None };
            cut.refine(&look.criteria(amount), budget).expect("refines");
            let expected = corners(&mesh, cut.triangles().into_iter().map(|t| t.1));
            prop_assert!(pages[0].triangles() == expected);
            let more = json!({
                "options": { "threshold": amount * 0.01 }, "budget": { "triangles": most },
            });
            pages[1].apply(&clusters.answer(&look.message(seq, &more)).expect("answers"));
            let drawn = clusters.cut().iter().flat_map(|&c| dag.triangles_of(c));
            prop_assert!(pages[1].triangles() == corners(&mesh, drawn));
        }
    }
}
