//! Simplification out of core, end to end.

use karui::mesh::{Attributes, diagnose, shapes};
use karui::outofcore::{
    Folder, Memory, Plan, PlanOptions, Result, RunOptions, Scheme, Sink, Summary, Vertices, run,
    write,
};
use karui::{Silent, TriMesh};
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
        self.mesh.attributes = layout.clone();
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

fn simplified(mesh: &TriMesh, options: PlanOptions, workers: usize) -> (TriMesh, Summary) {
    let folder = tempdir().expect("folder");
    let store = Folder::create(folder.path()).expect("store");
    let source = Memory(mesh);
    let plan = Plan::new(&source, "memory", options).expect("plan");
    plan.save(&store).expect("saved");
    let options = RunOptions {
        workers,
        ..RunOptions::default()
    };
    let last = run(&store, &source, &plan, &options).expect("run");
    let mut whole = Whole::default();
    let summary = write(&store, &last, &mut whole, &Silent).expect("written");
    let mesh = whole.mesh;
    let sizes = [mesh.positions.len(), mesh.triangles.len()].map(|n| n as u64);
    assert_eq!(sizes, whole.announced);
    assert_eq!(sizes, [summary.vertices, summary.triangles]);
    mesh.validate().expect("valid");
    (mesh, summary)
}

/// Waves over a square of `side` x `side` cells.
fn terrain(side: u32) -> TriMesh {
    let mut mesh = TriMesh::default();
    for y in 0..=side {
        for x in 0..=side {
            let [u, v] = [x, y].map(|c| c as f32 / side as f32);
            let z = 0.05 * (13.0 * u).sin() * (9.0 * v).cos() + 0.01 * (57.0 * u * v).sin();
            mesh.positions.push([u, v, z].into());
        }
    }
    for y in 0..side {
        for x in 0..side {
            let a = y * (side + 1) + x;
            let [b, c, d] = [a + 1, a + side + 1, a + side + 2];
            mesh.triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    mesh
}

fn by_ratio(ratio: f64, block_triangles: u64) -> PlanOptions {
    PlanOptions {
        ratio: Some(ratio),
        block_triangles,
        ..PlanOptions::default()
    }
}

#[test]
fn spheres_in_blocks_stay_closed() {
    let sphere = shapes::icosphere(6);
    for scheme in [Scheme::Cells, Scheme::Sweep] {
        for ratio in [0.5, 0.1, 0.02] {
            let options = PlanOptions {
                scheme,
                ..by_ratio(ratio, 3000)
            };
            let (mesh, summary) = simplified(&sphere, options, 2);
            let report = diagnose(&mesh).expect("report");
            println!("{scheme:?} {ratio} {summary:?} {report:?}");
            assert_eq!(report.boundary_edges, 0);
            assert_eq!(
                mesh.triangles.len(),
                (sphere.triangles.len() as f64 * ratio).round() as usize
            );
        }
    }
}

#[test]
fn terrains_in_blocks_have_one_border() {
    let (mesh, summary) = simplified(&terrain(300), by_ratio(0.1, 10_000), 2);
    let report = diagnose(&mesh).expect("report");
    println!("{summary:?} {report:?}");
    assert_eq!(mesh.triangles.len(), 18_000);
}
