//! Cages from files, refined where they are looked at: no cracks, the same for any number of
//! threads, as close to the surface as asked, and no jumps while the camera moves.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "it is a test, and tells what it measures"
)]

use karui::geom::{Aabb, Camera, DVec3, Light, Vec3, turntable_directions};
use karui::spatial::Bvh;
use karui::subdiv::adaptive::{Adaptive, AdaptiveMesh, AdaptiveOptions, View};
use karui::subdiv::{ControlMesh, SubdivOptions};
use karui::{TriMesh, mesh::PolyMesh};
use std::collections::HashMap;
use std::path::PathBuf;

const CAGES: [&str; 6] = [
    "hand.off",
    "head.off",
    "fish_control_mesh.obj",
    "spot_control_mesh.obj",
    "suzanne.ply",
    "opensubdiv/catmark_helmet.obj",
];

fn cage(name: &str) -> Option<ControlMesh> {
    let models = std::env::var_os("KARUI_MODELS").map_or_else(
        || {
            PathBuf::from(concat!(
                env!("CARGO_MANIFEST_DIR"),
                "/../../../shared/models"
            ))
        },
        PathBuf::from,
    );
    let path = models.join("subdivision").join(name);
    if !path.exists() {
        println!("SKIPPED: no {}", path.display());
        return None;
    }
    Some(karui_io::read_control(path).unwrap().mesh)
}

fn adaptive(control: &ControlMesh) -> Adaptive {
    let options = control.rules.apply(SubdivOptions::default());
    Adaptive::new(&control.cage, &control.positions, &options).unwrap()
}

fn view(control: &ControlMesh, direction: Vec3) -> View {
    let bounds = Aabb::of(control.positions.iter().copied());
    View {
        camera: Camera::looking_at(bounds, direction, 0.6),
        size: [1024, 1024],
        lights: Vec::new(),
    }
}

/// Edges that only one face has, by points, in the sense in which it has them.
fn open_edges(mesh: &PolyMesh, point: impl Fn(u32) -> u32) -> Vec<[u32; 2]> {
    let mut seen: HashMap<[u32; 2], u32> = HashMap::new();
    for face in mesh.faces() {
        for i in 0..face.len() {
            let edge = [face[i], face[(i + 1) % face.len()]].map(&point);
            *seen.entry(edge).or_default() += 1;
        }
    }
    assert!(
        seen.values().all(|&n| n == 1),
        "an edge of two faces in one sense"
    );
    let open = seen.keys().filter(|[a, b]| !seen.contains_key(&[*b, *a]));
    let mut open: Vec<[u32; 2]> = open.copied().collect();
    open.sort_unstable();
    open
}

/// Walks boundaries: which vertices of the cage follow each other.
fn boundary(open: &[[u32; 2]], cage: u32) -> Vec<[u32; 2]> {
    let mut next: HashMap<u32, u32> = HashMap::new();
    for &[a, b] in open.iter().filter(|e| e[0] >= cage) {
        assert_eq!(
            next.insert(a, b),
            None,
            "a boundary that forks at a new vertex"
        );
    }
    let starts = open.iter().filter(|e| e[0] < cage);
    let mut ends: Vec<[u32; 2]> = starts
        .map(|&[a, mut b]| {
            while b >= cage {
                b = next.remove(&b).unwrap();
            }
            [a, b]
        })
        .collect();
    assert!(
        next.is_empty(),
        "a boundary of new vertices alone is a crack"
    );
    ends.sort_unstable();
    ends
}

#[test]
fn real_cages_have_no_cracks() {
    for name in CAGES {
        let Some(control) = cage(name) else { continue };
        let whole = PolyMesh {
            positions: control.positions.clone(),
            indices: control.cage.indices.clone(),
            offsets: control.cage.offsets.clone(),
            ..PolyMesh::default()
        };
        let holes = !control.cage.holes.is_empty();
        let before = open_edges(&whole, |v| v);
        let mut adaptive = adaptive(&control);
        for direction in turntable_directions(5, 0.3) {
            let view = view(&control, direction);
            for options in [AdaptiveOptions::default(), AdaptiveOptions::within(0.5)] {
                let drawn = adaptive.refine(&view, &options).unwrap();
                assert!(!drawn.truncated && drawn.mesh.face_count() > 2 * whole.face_count());
                let open = open_edges(&drawn.mesh, |v| drawn.points[v as usize]);
                let after = boundary(&open, control.positions.len() as u32);
                assert!(holes || after == before, "{name}");
            }
        }
    }
}

#[test]
fn threads_and_frames_before_change_nothing() {
    let Some(control) = cage("spot_control_mesh.obj") else {
        return;
    };
    let lit = |direction| {
        let mut view = view(&control, direction);
        view.lights = Light::three_points(&view.camera).unwrap();
        view
    };
    let options = AdaptiveOptions {
        terminator_pixels: Some(0.2),
        ..AdaptiveOptions::within(0.5)
    };
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let mut adaptive = adaptive(&control);
            let all = turntable_directions(3, 0.2).into_iter();
            all.map(|d| adaptive.refine(&lit(d), &options).unwrap())
                .collect::<Vec<_>>()
        })
    };
    let one = run(1);
    assert!(run(2) == one && run(8) == one);
    let fresh = adaptive(&control)
        .refine(&lit(turntable_directions(3, 0.2)[2]), &options)
        .unwrap();
    assert!(fresh == one[2]);
}

/// Points of what a mesh shows to the eye: vertices and middles of front faces.
fn seen(mesh: &TriMesh, eye: DVec3) -> Vec<DVec3> {
    let mut points = Vec::new();
    for t in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(t);
        if (b - a).cross(c - a).dot(eye - a) > 0.0 {
            points.extend([a, b, c, (a + b + c) / 3.0, (a + b) / 2.0, (b + c) / 2.0]);
        }
    }
    points
}

/// Largest distance of what is seen of `from` to `to`, pixels of the view.
fn distance(from: &TriMesh, to: &TriMesh, view: &View) -> f64 {
    let bvh = Bvh::build(to).unwrap();
    let eye = view.camera.eye.as_dvec3();
    let scale = 0.5 * f64::from(view.size[1]) / (0.3f64).tan();
    let points = seen(from, eye).into_iter().step_by(5);
    let far = points.map(|p| bvh.closest(p).point.distance(p) / p.distance(eye));
    far.fold(0.0, f64::max) * scale
}

#[test]
fn the_surface_is_as_close_as_asked() {
    for name in [
        "fish_control_mesh.obj",
        "spot_control_mesh.obj",
        "suzanne.ply",
    ] {
        let Some(control) = cage(name) else { continue };
        let view = view(&control, Vec3::new(0.5, 0.3, 1.0));
        let mut adaptive = adaptive(&control);
        let fine = adaptive
            .refine(&view, &AdaptiveOptions::uniform(10))
            .unwrap()
            .to_tri_mesh();
        for pixels in [4.0, 1.0, 0.5] {
            let drawn = adaptive
                .refine(&view, &AdaptiveOptions::within(pixels))
                .unwrap();
            let found = distance(&drawn.to_tri_mesh(), &fine, &view);
            println!(
                "{name}: {pixels} px asked, {found:.3} found, {}",
                drawn.mesh.face_count()
            );
            assert!(
                found <= pixels,
                "{name}: {found} pixels instead of {pixels}"
            );
        }
    }
}

#[test]
fn nothing_jumps_while_the_camera_moves() {
    for name in [
        "fish_control_mesh.obj",
        "spot_control_mesh.obj",
        "suzanne.ply",
    ] {
        let Some(control) = cage(name) else { continue };
        let mut adaptive = adaptive(&control);
        let options = AdaptiveOptions::within(1.0);
        let mut last: Option<TriMesh> = None;
        let mut most = 0f64;
        let mut reused = AdaptiveMesh::default();
        for direction in turntable_directions(720, 0.3).into_iter().take(40) {
            let view = view(&control, direction);
            adaptive.refine_into(&view, &options, &mut reused).unwrap();
            let drawn = reused.to_tri_mesh();
            if let Some(last) = &last {
                most = most
                    .max(distance(&drawn, last, &view))
                    .max(distance(last, &drawn, &view));
            }
            last = Some(drawn);
        }
        println!("{name}: at most {most:.3} px from frame to frame");
        assert!(most <= 1.0, "{name}: a jump of {most} pixels");
    }
}
