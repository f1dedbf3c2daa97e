//! Simplification out of core, end to end.

use karui::geom::{Vec2, Vec3};
use karui::mesh::{Attributes, TopologyReport, diagnose, shapes};
use karui::metrics::{SurfaceDistanceOptions, surface_distance};
use karui::outofcore::{
    Error, Folder, Manifest, Memory, Next, PLAN, Plan, PlanOptions, Result, RunOptions, Scheme,
    Sink, Source, Store, Summary, Vertices, manifests, next, run, run_task, verify, write,
};
use karui::simplify::{Quality, Stopped};
use karui::{Progress, Silent, SimplifyOptions, Stop, TriMesh, simplify};
use proptest::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use tempfile::tempdir;

/// Puts the result together in memory.
#[derive(Default)]
struct Whole {
    mesh: TriMesh,
    announced: [u64; 2],
}

impl Sink for Whole {
    fn begin(&mut self, vertices: u64, triangles: u64, layout: &Attributes) -> Result<()> {
        self.announced = [vertices, triangles];
        // Enough to see that attributes come along.
        self.mesh.attributes.normals.clone_from(&layout.normals);
        self.mesh.attributes.uvs.clone_from(&layout.uvs);
        Ok(())
    }

    fn vertices(&mut self, vertices: &Vertices) -> Result<()> {
        self.mesh.positions.extend(&vertices.positions);
        let attributes = &mut self.mesh.attributes;
        if let (Some(all), Some(more)) = (&mut attributes.normals, &vertices.attributes.normals) {
            all.extend(more);
        }
        for (all, more) in attributes.uvs.iter_mut().zip(&vertices.attributes.uvs) {
            all.extend(more);
        }
        Ok(())
    }

    fn triangles(&mut self, triangles: &[[u64; 3]]) -> Result<()> {
        let triangles = triangles.iter().map(|t| t.map(|v| v as u32));
        self.mesh.triangles.extend(triangles);
        Ok(())
    }
}

fn finished(
    store: &Folder,
    source: &dyn Source,
    plan: &Plan,
    workers: usize,
) -> Result<(TriMesh, Summary)> {
    let options = RunOptions {
        workers,
        ..RunOptions::default()
    };
    let last = run(store, source, plan, &options)?;
    let mut whole = Whole::default();
    let summary = write(store, &last, &mut whole, &Silent)?;
    let mesh = whole.mesh;
    let sizes = [mesh.positions.len(), mesh.triangles.len()].map(|n| n as u64);
    assert_eq!(sizes, whole.announced);
    assert_eq!(sizes, [summary.vertices, summary.triangles]);
    mesh.validate().expect("valid");
    Ok((mesh, summary))
}

fn tried(mesh: &TriMesh, options: PlanOptions, workers: usize) -> Result<(TriMesh, Summary)> {
    let folder = tempdir().expect("folder");
    let store = Folder::create(folder.path())?;
    let source = Memory(mesh);
    let plan = Plan::new(&source, "memory", options)?;
    plan.save(&store)?;
    finished(&store, &source, &plan, workers)
}

fn simplified(mesh: &TriMesh, options: PlanOptions, workers: usize) -> TriMesh {
    tried(mesh, options, workers).expect("simplified").0
}

fn by_ratio(ratio: f64, block_triangles: u64) -> PlanOptions {
    PlanOptions {
        ratio: Some(ratio),
        block_triangles,
        ..PlanOptions::default()
    }
}

fn report(mesh: &TriMesh) -> TopologyReport {
    diagnose(mesh).expect("report")
}

/// Collapses take two triangles, on a border one: a count may be missed by one. Blocks of
/// some thousand triangles are mended after they have come to their count.
fn assert_near(found: usize, wanted: f64) {
    let off = (found as f64 - wanted).abs() / wanted;
    assert!(off < 0.03, "{found} triangles instead of {wanted}");
}

#[test]
fn spheres_in_blocks_stay_closed_and_come_to_the_count() {
    let sphere = shapes::icosphere(6);
    for scheme in [Scheme::Cells, Scheme::Sweep, Scheme::Slabs] {
        for ratio in [0.5, 0.1, 0.02] {
            let options = PlanOptions {
                scheme,
                ..by_ratio(ratio, 3000)
            };
            let mesh = simplified(&sphere, options, 2);
            let report = report(&mesh);
            println!("{scheme:?} {ratio}: {}", mesh.triangles.len());
            assert!(
                report.closed && report.manifold && report.oriented,
                "{report:?}"
            );
            assert_eq!(report.euler_characteristic, 2);
            assert_near(mesh.triangles.len(), sphere.triangles.len() as f64 * ratio);
        }
    }
}

#[test]
fn land_in_blocks_keeps_one_border_that_is_simplified_too() {
    let land = shapes::landscape(301, 301, 3);
    let mesh = simplified(&land, by_ratio(0.1, 10_000), 2);
    let report = report(&mesh);
    assert!(report.manifold && report.oriented, "{report:?}");
    assert_eq!((report.boundary_loops, report.components), (1, 1));
    assert_eq!(report.euler_characteristic, 1);
    // 1200 at first.
    assert!(report.boundary_edges < 700, "{}", report.boundary_edges);
}

#[test]
fn error_in_blocks_is_that_of_the_whole_and_none_is_seen_where_borders_were() {
    let land = shapes::landscape(401, 401, 5);
    let blocks = simplified(&land, by_ratio(0.1, 20_000), 2);
    let options = SimplifyOptions {
        quality: Quality::Fast,
        stop: Stop::triangles(blocks.triangles.len()),
        ..SimplifyOptions::default()
    };
    let whole = simplify(&land, &options).expect("simplified").mesh;
    let distance = |mesh: &TriMesh| {
        let distance = surface_distance(&land, mesh, &SurfaceDistanceOptions::default());
        distance.expect("distance").rms()
    };
    let (in_blocks, in_one) = (distance(&blocks), distance(&whole));
    println!("RMS {in_blocks} in blocks, {in_one} as a whole");
    assert!(in_blocks < 1.05 * in_one, "{in_blocks} against {in_one}");
}

#[test]
fn any_number_of_workers_makes_the_same_bytes() {
    let land = shapes::landscape(200, 150, 9);
    let one = simplified(&land, by_ratio(0.2, 4000), 1);
    for workers in [2, 4, 8] {
        assert!(
            simplified(&land, by_ratio(0.2, 4000), workers) == one,
            "{workers}"
        );
    }
}

#[test]
fn attributes_are_carried_and_seams_stay() {
    let sphere = shapes::textured_sphere(60, 120);
    let mesh = simplified(&sphere, by_ratio(0.3, 2000), 2);
    assert!(report(&mesh).closed);
    let uvs = &mesh.attributes.uvs[0];
    assert_eq!(uvs.len(), mesh.positions.len());
    let inside = |uv: &Vec2| (-0.1..1.1).contains(&uv.x) && (-0.1..1.1).contains(&uv.y);
    assert!(uvs.iter().all(inside));
    // A seam is there as long as vertices outnumber places.
    assert!(report(&mesh).positions < mesh.positions.len());
}

/// The same mesh with vertices and triangles in another order.
fn shuffled(mesh: &TriMesh) -> TriMesh {
    let stride = |n: usize| {
        (1..n)
            .rev()
            .find(|&s| s < 2 * n / 3 && gcd(s, n) == 1)
            .unwrap_or(1)
    };
    let vertices = mesh.positions.len();
    let by = stride(vertices);
    let moved = |v: u32| (v as usize * by % vertices) as u32;
    let mut other = mesh.clone();
    for (v, &position) in mesh.positions.iter().enumerate() {
        other.positions[moved(v as u32) as usize] = position;
    }
    let triangles = mesh.triangles.len();
    let by = stride(triangles);
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        other.triangles[t * by % triangles] = triangle.map(moved);
    }
    other
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[test]
fn scattered_vertices_are_brought_together() {
    let sphere = shapes::icosphere(6);
    let other = shuffled(&sphere);
    let folder = tempdir().expect("folder");
    let store = Folder::create(folder.path()).expect("store");
    let source = Sparing(Memory(&other), AtomicUsize::new(0));
    let plan = Plan::new(&source, "memory", by_ratio(0.1, 5000)).expect("plan");
    assert!(plan.scattered);
    assert!(
        !Plan::new(&Memory(&sphere), "", by_ratio(0.1, 5000))
            .expect("plan")
            .scattered
    );
    plan.save(&store).expect("saved");
    let (mesh, _) = finished(&store, &source, &plan, 2).expect("simplified");
    assert!(report(&mesh).closed);
    assert_near(mesh.triangles.len(), 8192.0);
    let names: Vec<_> = manifests(&store)
        .expect("all")
        .iter()
        .map(Manifest::name)
        .collect();
    assert!(names.contains(&"01-scan.tasks".into()) && names.contains(&"02-fetch.tasks".into()));
    // Once for the box and once for the faces, whatever their order.
    assert_eq!(source.1.into_inner(), 2 * other.positions.len());
}

/// Triangles of a portion.
const FEW: usize = 512;

/// Counts the vertices that are read; its portions are small.
struct Sparing<'a>(Memory<'a>, AtomicUsize);

impl Source for Sparing<'_> {
    fn vertices(&self) -> u64 {
        self.0.vertices()
    }
    fn chunks(&self) -> u64 {
        self.0.0.triangles.len().div_ceil(FEW) as u64
    }
    fn read_vertices(&self, ids: Range<u64>) -> Result<Vertices> {
        let count = (ids.end - ids.start) as usize;
        self.1.fetch_add(count, Ordering::Relaxed);
        self.0.read_vertices(ids)
    }
    fn read_triangles(&self, chunk: u64) -> Result<Vec<[u64; 3]>> {
        let few = self.0.0.triangles.chunks(FEW).nth(chunk as usize);
        let few = few.unwrap_or_default().iter();
        Ok(few.map(|t| t.map(u64::from)).collect())
    }
}

#[test]
fn an_error_bound_is_kept_by_estimate() {
    let land = shapes::landscape(200, 200, 2);
    let options = PlanOptions {
        error: Some(0.5),
        block_triangles: 10_000,
        ..PlanOptions::default()
    };
    let (mesh, summary) = tried(&land, options, 2).expect("simplified");
    assert!(
        summary.error <= 0.5 && summary.error > 0.05,
        "{}",
        summary.error
    );
    assert!(mesh.triangles.len() < land.triangles.len() / 2);
}

#[test]
fn tasks_in_any_order_and_by_anybody_make_the_same() {
    let land = shapes::landscape(120, 120, 4);
    let source = Memory(&land);
    let expected = simplified(&land, by_ratio(0.2, 3000), 2);
    let folder = tempdir().expect("folder");
    let plan = Plan::new(&source, "memory", by_ratio(0.2, 3000)).expect("plan");
    plan.save(&Folder::create(folder.path()).expect("store"))
        .expect("saved");
    let last = loop {
        // Each time as if nothing were known but what lies in the folder.
        let store = Folder::open(folder.path());
        let plan = Plan::load(&store).expect("plan");
        let manifest = match next(&store, &plan).expect("next") {
            Next::Run(manifest) => manifest,
            Next::Done(manifest) => break manifest,
        };
        assert_eq!(
            Manifest::load(&store, &manifest.name()).expect("saved"),
            manifest
        );
        let rows = (0..manifest.rows.len() as u64).rev();
        let twice = rows.clone().chain(rows);
        let result = |row| run_task(&store, &source, &manifest, row, &Silent).expect("done");
        let results = twice.map(result).collect();
        let missing = manifest.commit(&store, Vec::new());
        assert!(manifest.rows.is_empty() || matches!(missing, Err(Error::NotDone { row: 0, .. })));
        manifest.commit(&store, results).expect("closed");
    };
    let mut whole = Whole::default();
    write(&Folder::open(folder.path()), &last, &mut whole, &Silent).expect("written");
    assert!(whole.mesh == expected);
}

/// Stops after so many questions.
struct Impatient(AtomicUsize);

impl Progress for Impatient {
    fn report(&self, _: &'static str, _: f32) {}
    fn cancelled(&self) -> bool {
        let left = self
            .0
            .fetch_update(Ordering::SeqCst, Ordering::SeqCst, |n| {
                Some(n.saturating_sub(1))
            });
        left == Ok(0)
    }
}

#[test]
fn stopped_work_goes_on_where_it_was() {
    let land = shapes::landscape(120, 120, 4);
    let source = Memory(&land);
    let expected = simplified(&land, by_ratio(0.2, 3000), 2);
    let folder = tempdir().expect("folder");
    let store = Folder::create(folder.path()).expect("store");
    let plan = Plan::new(&source, "memory", by_ratio(0.2, 3000)).expect("plan");
    plan.save(&store).expect("saved");
    let mut stops = 0;
    for patience in (5..).step_by(7) {
        let progress = Impatient(AtomicUsize::new(patience));
        let options = RunOptions {
            workers: 2,
            progress: &progress,
        };
        match run(&store, &source, &plan, &options) {
            Err(Error::Block(karui::Error::Cancelled)) => stops += 1,
            outcome => {
                outcome.expect("done");
                break;
            }
        }
    }
    assert!(stops > 3, "{stops}");
    let (mesh, _) = finished(&store, &source, &plan, 1).expect("done");
    assert!(mesh == expected);
}

#[test]
fn flipped_bits_are_found_and_mended() {
    let land = shapes::landscape(100, 100, 4);
    let source = Memory(&land);
    let folder = tempdir().expect("folder");
    let store = Folder::create(folder.path()).expect("store");
    let plan = Plan::new(&source, "memory", by_ratio(0.2, 3000)).expect("plan");
    plan.save(&store).expect("saved");
    let (expected, _) = finished(&store, &source, &plan, 2).expect("done");
    assert_eq!(verify(&store).expect("verified"), Vec::<String>::new());
    let kinds = [".block", ".rims", ".json"];
    for name in store.list().expect("names") {
        if name == PLAN || !kinds.iter().any(|kind| name.ends_with(kind)) {
            continue;
        }
        let good = store.get(&name).expect("bytes");
        let places = [0, 9, 40, good.len() / 2, good.len() - 1];
        for at in places.into_iter().filter(|&at| at < good.len()) {
            let mut bad = good.clone();
            bad[at] ^= 4;
            store.put(&name, &bad).expect("put");
            assert_eq!(verify(&store).expect("verified"), [name.as_str()], "{at}");
        }
        store.put(&name, &good[..good.len() / 2]).expect("put");
        assert_eq!(verify(&store).expect("verified"), [name.as_str()]);
        karui::outofcore::rebuild(&store, &source, &name).expect("made anew");
        assert_eq!(store.get(&name).expect("bytes"), good, "{name}");
    }
    // In the middle of the work: blocks of the first level are lost when they are needed.
    for name in store.list().expect("names") {
        if name.as_str() > "03" && !name.ends_with(".json") {
            store.remove(&name).expect("removed");
        }
    }
    for name in ["01-read-000000.block", "01-read.done"] {
        let mut bytes = store.get(name).expect("bytes");
        let at = bytes.len() / 2;
        bytes[at] ^= 1;
        store.put(name, &bytes).expect("put");
    }
    plan.save(&store).expect("saved");
    let (mesh, _) = finished(&store, &source, &plan, 2).expect("done");
    assert!(mesh == expected);
}

#[test]
fn another_plan_is_not_mixed_in() {
    let land = shapes::landscape(20, 20, 4);
    let folder = tempdir().expect("folder");
    let store = Folder::create(folder.path()).expect("store");
    let plan = |ratio| Plan::new(&Memory(&land), "memory", by_ratio(ratio, 100)).expect("plan");
    plan(0.5).save(&store).expect("saved");
    plan(0.5).save(&store).expect("the same");
    let other = plan(0.4).save(&store);
    assert!(matches!(
        other,
        Err(Error::OtherPlan {
            what: "options",
            ..
        })
    ));
}

fn is_bad(mesh: &TriMesh, options: PlanOptions) -> Error {
    tried(mesh, options, 1).map(drop).expect_err("an error")
}

#[test]
fn what_cannot_be_is_an_error() {
    let mut land = shapes::landscape(30, 30, 4);
    for options in [
        by_ratio(1.5, 1000),
        by_ratio(f64::NAN, 1000),
        by_ratio(0.5, 3),
    ] {
        let error = is_bad(&land, options);
        assert!(
            matches!(error, Error::Block(karui::Error::BadOption { .. })),
            "{error}"
        );
    }
    let empty = is_bad(&TriMesh::default(), by_ratio(0.5, 1000));
    assert!(
        matches!(empty, Error::Block(karui::Error::Empty { .. })),
        "{empty}"
    );
    land.positions[77].y = f32::NAN;
    let error = is_bad(&land, by_ratio(0.5, 1000));
    assert!(matches!(error, Error::NotFinite { vertex: 77 }), "{error}");
    land.positions[77].y = 0.0;
    land.triangles[8][1] = 1_000_000;
    let error = is_bad(&land, by_ratio(0.5, 1000));
    let expected = matches!(
        error,
        Error::IndexOutOfRange {
            triangle: 8,
            index: 1_000_000,
            ..
        }
    );
    assert!(expected, "{error}");
}

#[test]
fn odd_models_come_through() {
    for (name, mesh) in shapes::zoo() {
        if mesh.triangles.is_empty() || mesh.validate().is_err() {
            continue;
        }
        for block_triangles in [64, 1 << 20] {
            let (coarse, _) = tried(&mesh, by_ratio(0.5, block_triangles), 2).expect(name);
            assert!(coarse.triangles.len() <= mesh.triangles.len(), "{name}");
        }
    }
}

#[test]
fn many_edges_at_a_vertex_and_triangles_across_the_whole_model() {
    // A fan of 100,000 triangles that all meet in the middle.
    let count = 100_000u32;
    let angle = |i: u32| f64::from(i) / f64::from(count) * std::f64::consts::TAU;
    let rim = |i| Vec3::new(angle(i).cos() as f32, angle(i).sin() as f32, 0.0);
    let mut fan = TriMesh::new(vec![[0.0, 0.0, 1.0].into()], Vec::new());
    fan.positions.extend((0..count).map(rim));
    fan.triangles = (0..count)
        .map(|i| [0, 1 + i, 1 + (i + 1) % count])
        .collect();
    let mesh = simplified(&fan, by_ratio(0.1, 8000), 2);
    let found = report(&mesh);
    println!("fan: {found:?}");
    assert_eq!((found.boundary_loops, found.components), (1, 1));
    assert_near(mesh.triangles.len(), 10_000.0);
    // Long slivers, each from one end to the other.
    let strip = |i: u32| [[0.0, i as f32, 0.0], [5000.0, i as f32, (i % 7) as f32]];
    let positions = (0..=5000).flat_map(strip).map(Into::into).collect();
    let pair = |i: u32| [[2 * i, 2 * i + 1, 2 * i + 3], [2 * i, 2 * i + 3, 2 * i + 2]];
    let slivers = TriMesh::new(positions, (0..5000).flat_map(pair).collect());
    let (mesh, summary) = tried(&slivers, by_ratio(0.2, 500), 2).expect("simplified");
    let found = report(&mesh);
    println!("slivers: {found:?}");
    assert_eq!((found.boundary_loops, found.components), (1, 1));
    // All lies on borders, which is told.
    assert!(summary.triangles > summary.target, "{summary:?}");
    assert_eq!(summary.stopped, Some(Stopped::Locked));
}

#[test]
fn a_count_that_is_met_needs_no_reason() {
    let land = shapes::landscape(100, 100, 4);
    let (mesh, summary) = tried(&land, by_ratio(0.2, 3000), 2).expect("simplified");
    assert!(mesh.triangles.len() as u64 <= summary.target);
    assert_eq!((summary.target, summary.stopped), (4000, None));
}

#[test]
fn writers_of_one_folder_do_not_meet() {
    let folder = tempdir().expect("folder");
    std::thread::scope(|scope| {
        for _ in 0..2 {
            // As if each were on another machine, with the same process number.
            let store = Folder::create(folder.path()).expect("store");
            scope.spawn(move || {
                for _ in 0..500 {
                    store.put("a", &[7; 4096]).expect("put");
                    assert_eq!(store.get("a").expect("bytes"), [7; 4096]);
                }
            });
        }
    });
}

#[test]
fn one_place_for_all_and_huge_coordinates() {
    let mut land = shapes::landscape(60, 60, 4);
    land.positions.iter_mut().for_each(|p| *p = *p * 1e9 - 3e10);
    assert!(report(&simplified(&land, by_ratio(0.3, 1000), 2)).components >= 1);
    land.positions.fill([1.0, 2.0, 3.0].into());
    assert!(tried(&land, by_ratio(0.3, 1000), 2).is_ok());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Whatever the triangles: edges with two sides keep both, as far as the simplifier
    /// does without blocks.
    #[test]
    fn soups_come_through_the_same_for_all(
        positions in prop::collection::vec(prop::array::uniform3(-4i8..5), 3..40),
        corners in prop::collection::vec(prop::array::uniform3(0usize..40), 1..200),
        ratio in 0.0f64..1.0,
    ) {
        let count = positions.len();
        let mesh = TriMesh::new(
            positions.iter().map(|p| p.map(f32::from).into()).collect(),
            corners.iter().map(|t| t.map(|c| (c % count) as u32)).collect(),
        );
        let one = tried(&mesh, by_ratio(ratio, 64), 1).expect("simplified");
        let many = tried(&mesh, by_ratio(ratio, 64), 4).expect("simplified");
        prop_assert!(one == many);
        prop_assert!(one.0.triangles.len() <= mesh.triangles.len());
    }
}
