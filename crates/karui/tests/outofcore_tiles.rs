//! Levels kept as tiles, out of core, end to end.

use karui::geom::Vec3;
use karui::mesh::{diagnose, shapes};
use karui::metrics::{Samples, Surface, SurfaceDistanceOptions, surface_distance_between};
use karui::outofcore::{
    Error, Folder, Memory, Plan, PlanOptions, RunOptions, Scheme, Store, TileCut, TileTree, run,
    tile_mesh, tile_tree,
};
use karui::{TriMesh, geom};
use proptest::prelude::*;
use tempfile::{TempDir, tempdir};

/// A finished plan.
struct Tiled {
    store: Folder,
    tree: TileTree,
    _folder: TempDir,
}

fn options(triangles: u64, aligned: bool) -> PlanOptions {
    PlanOptions {
        block_triangles: 8 * triangles,
        tiles: Some(TileCut { triangles, aligned }),
        ..PlanOptions::default()
    }
}

fn tried(mesh: &TriMesh, options: PlanOptions, workers: usize) -> karui::outofcore::Result<Tiled> {
    let folder = tempdir().expect("folder");
    let store = Folder::create(folder.path())?;
    let source = Memory(mesh);
    let plan = Plan::new(&source, "memory", options)?;
    plan.save(&store)?;
    let workers = RunOptions {
        workers,
        ..RunOptions::default()
    };
    run(&store, &source, &plan, &workers)?;
    Ok(Tiled {
        tree: tile_tree(&store)?,
        store,
        _folder: folder,
    })
}

fn tiled(mesh: &TriMesh, triangles: u64, aligned: bool) -> Tiled {
    tried(mesh, options(triangles, aligned), 2).expect("tiled")
}

impl Tiled {
    fn mesh(&self, node: usize) -> TriMesh {
        tile_mesh(&self.store, &self.tree.nodes[node]).expect("mesh")
    }

    fn children(&self, node: usize) -> Vec<usize> {
        let is_child = |&n: &usize| self.tree.nodes[n].parent == Some(node as u32);
        (0..self.tree.nodes.len()).filter(is_child).collect()
    }

    fn leaves(&self) -> Vec<usize> {
        let is_leaf = |&n: &usize| self.children(n).is_empty();
        (0..self.tree.nodes.len()).filter(is_leaf).collect()
    }

    /// All that is seen with some tiles refined, in one mesh.
    fn front(&self, seed: u64) -> TriMesh {
        let mut open = vec![0];
        let mut all = TriMesh::default();
        while let Some(node) = open.pop() {
            let children = self.children(node);
            let hash = (node as u64 + 1).wrapping_mul(seed | 1) >> 3;
            if !hash.is_multiple_of(3) && !children.is_empty() {
                open.extend(children);
                continue;
            }
            let mesh = self.mesh(node);
            let first = all.positions.len() as u32;
            all.positions.extend(&mesh.positions);
            all.triangles
                .extend(mesh.triangles.iter().map(|t| t.map(|v| v + first)));
        }
        all
    }
}

type Corners = [[u32; 3]; 3];

/// All triangles by the bits of their corners, the least first.
fn corners(meshes: &[TriMesh]) -> Vec<Corners> {
    let of_mesh = |mesh: &TriMesh| -> Vec<Corners> {
        let corner = |v: u32| {
            mesh.positions[v as usize]
                .to_array()
                .map(|x| (x + 0.0).to_bits())
        };
        let turned = |t: &[u32; 3]| {
            let mut corners = t.map(corner);
            let least = (0..3).min_by_key(|&i| corners[i]).unwrap_or(0);
            corners.rotate_left(least);
            corners
        };
        mesh.triangles.iter().map(turned).collect()
    };
    let mut all: Vec<_> = meshes.iter().flat_map(of_mesh).collect();
    all.sort_unstable();
    all
}

fn area(mesh: &TriMesh) -> f64 {
    let triangles = 0..mesh.triangles.len();
    triangles.map(|t| geom::area(mesh.corners(t))).sum()
}

#[test]
fn every_triangle_of_the_input_is_in_one_leaf() {
    for mesh in [shapes::icosphere(5), shapes::landscape(120, 90, 3)] {
        let tiled = tiled(&mesh, 1000, false);
        let leaves: Vec<_> = tiled.leaves().into_iter().map(|n| tiled.mesh(n)).collect();
        assert!(leaves.len() > 8);
        assert!(corners(&leaves) == corners(&[mesh]));
        for leaf in &leaves {
            assert!(leaf.triangles.len() <= 1500, "{}", leaf.triangles.len());
        }
    }
}

#[test]
fn errors_grow_towards_the_root_and_cover_the_distance_to_the_input() {
    for (mesh, aligned) in [
        (shapes::icosphere(5), false),
        (shapes::landscape(120, 90, 3), false),
        (shapes::landscape(120, 90, 3), true),
    ] {
        let tiled = tiled(&mesh, 1000, aligned);
        let input = Surface::new(&mesh).expect("surface");
        for (n, node) in tiled.tree.nodes.iter().enumerate() {
            for child in tiled.children(n) {
                assert!(tiled.tree.nodes[child].error <= node.error);
            }
            let own = Surface::new(&tiled.mesh(n)).expect("surface");
            let options = SurfaceDistanceOptions {
                samples: Samples::Count(20_000),
                ..SurfaceDistanceOptions::default()
            };
            let found = surface_distance_between(&own, &input, &options).expect("distance");
            // Samples find a little less than there is.
            let most = 1.05 * node.error + 1e-5;
            assert!(found.a_to_b.max <= most, "{n}: {found:?} {}", node.error);
            if n == 0 {
                assert!(node.error > 0.0);
                assert!(found.max() <= most, "{found:?} {}", node.error);
            }
        }
    }
}

#[test]
fn tiles_of_any_levels_side_by_side_leave_no_crack() {
    let sphere = shapes::icosphere(5);
    let land = shapes::landscape(120, 90, 3);
    for aligned in [false, true] {
        let [round, flat] = [&sphere, &land].map(|mesh| tiled(mesh, 500, aligned));
        for seed in 1..20 {
            let report = diagnose(&round.front(seed)).expect("report");
            assert!(report.closed, "{aligned} {seed}: {report:?}");
            let report = diagnose(&flat.front(seed)).expect("report");
            assert_eq!(report.boundary_loops, 1, "{aligned} {seed}: {report:?}");
        }
    }
}

#[test]
fn the_coarsest_is_small_and_the_own_border_is_simplified() {
    let land = shapes::landscape(200, 200, 3);
    let tiled = tiled(&land, 1000, false);
    let root = tiled.mesh(0);
    println!(
        "{} triangles, {}",
        root.triangles.len(),
        tiled.tree.nodes.len()
    );
    assert!(root.triangles.len() <= 1000);
    let report = diagnose(&root).expect("report");
    assert!(report.boundary_edges < 400, "{}", report.boundary_edges);
}

#[test]
fn aligned_tiles_lie_within_their_cells_and_keep_the_area() {
    let mesh = shapes::landscape(120, 90, 3);
    let tiled = tiled(&mesh, 800, true);
    for (n, node) in tiled.tree.nodes.iter().enumerate() {
        let side = tiled.tree.side / f64::from(1u32 << node.depth);
        let place = Vec3::from(node.cell.map(|x| x as f32)).as_dvec3();
        let min = tiled.tree.min + place * side - 1e-4;
        let max = min + side + 2e-4;
        for p in tiled.mesh(n).positions {
            let p = p.as_dvec3();
            assert!(p.cmpge(min).all() && p.cmple(max).all(), "{n}: {p}");
        }
    }
    let leaves = tiled.leaves();
    let depth = tiled.tree.nodes[leaves[0]].depth;
    assert!(leaves.iter().all(|&n| tiled.tree.nodes[n].depth == depth));
    let found: f64 = leaves.iter().map(|&n| area(&tiled.mesh(n))).sum();
    assert!((found / area(&mesh) - 1.0).abs() < 1e-5, "{found}");
}

#[test]
fn any_number_of_workers_makes_the_same_store() {
    let mesh = shapes::landscape(100, 90, 3);
    for aligned in [false, true] {
        let one = tried(&mesh, options(700, aligned), 1).expect("tiled");
        for workers in [2, 8] {
            let other = tried(&mesh, options(700, aligned), workers).expect("tiled");
            let names = one.store.list().expect("names");
            assert_eq!(names, other.store.list().expect("names"));
            for name in names {
                let [a, b] = [&one, &other].map(|t| t.store.get(&name).expect("object"));
                assert!(a == b, "{name}");
            }
        }
    }
}

#[test]
fn normals_are_carried() {
    let mut mesh = shapes::icosphere(4);
    mesh.attributes.normals = Some(mesh.positions.clone());
    for aligned in [false, true] {
        let tiled = tiled(&mesh, 300, aligned);
        for n in 0..tiled.tree.nodes.len() {
            let mesh = tiled.mesh(n);
            let normals = mesh.attributes.normals.expect("normals");
            assert_eq!(normals.len(), mesh.positions.len());
            for (p, n) in mesh.positions.iter().zip(normals) {
                assert!(p.normalize().dot(n.normalize()) > 0.9);
            }
        }
    }
}

#[test]
fn what_cannot_be_cut_is_one_tile_or_an_error() {
    let one = TriMesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        triangles: vec![[0, 1, 2]; 3],
        ..TriMesh::default()
    };
    let same = TriMesh {
        triangles: vec![[0, 1, 2]; 40],
        ..one.clone()
    };
    for aligned in [false, true] {
        assert_eq!(tiled(&one, 16, aligned).tree.nodes.len(), 1);
        let leaves = tiled(&same, 16, aligned).leaves();
        assert!(!leaves.is_empty());
        let none = tried(&TriMesh::default(), options(16, aligned), 1);
        assert!(matches!(
            none,
            Err(Error::Block(karui::Error::Empty { .. }))
        ));
    }
    let slabs = PlanOptions {
        scheme: Scheme::Slabs,
        ..options(100, false)
    };
    for bad in [
        slabs,
        options(15, false),
        PlanOptions {
            block_triangles: 700,
            ..options(100, false)
        },
    ] {
        let found = tried(&one, bad, 1);
        assert!(matches!(
            found,
            Err(Error::Block(karui::Error::BadOption { .. }))
        ));
    }
}

fn soup() -> impl Strategy<Value = TriMesh> {
    let coordinate = prop_oneof![-1f32..1.0, -1e9f32..1e9, Just(0.0)];
    let positions = prop::collection::vec(prop::array::uniform3(coordinate), 3..60);
    (
        positions,
        prop::collection::vec(prop::array::uniform3(0usize..60), 1..150),
    )
        .prop_map(|(positions, triangles)| {
            let count = positions.len();
            TriMesh {
                positions: positions.into_iter().map(Vec3::from).collect(),
                triangles: triangles
                    .into_iter()
                    .map(|t| t.map(|v| (v % count) as u32))
                    .collect(),
                ..TriMesh::default()
            }
        })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn any_soup_of_triangles_becomes_tiles(mesh in soup()) {
        let tiled = tiled(&mesh, 16, false);
        let leaves: Vec<_> = tiled.leaves().into_iter().map(|n| tiled.mesh(n)).collect();
        prop_assert_eq!(corners(&leaves), corners(&[mesh]));
    }
}
