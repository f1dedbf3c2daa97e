//! Speed of connectivity on two million triangles:
//! `cargo bench -p karui --bench mesh`.
#![allow(missing_docs, reason = "benches are named after what they time")]

use karui::mesh::{
    Components, Halfedge, NormalWeight, PositionIds, RepairOptions, TriMesh, WeldOptions, diagnose,
    repair, shapes, vertex_normals, weld,
};

fn main() {
    divan::main();
}

/// Terrain of 2,000,000 triangles and 1,002,001 vertices.
fn terrain() -> TriMesh {
    shapes::terrain(1000, 1000, 1)
}

/// Three vertices a triangle, as in an STL file: 6,000,000 vertices.
fn unindexed() -> TriMesh {
    let mesh = terrain();
    let corners = mesh.triangles.as_flattened();
    let positions = corners
        .iter()
        .map(|&v| mesh.positions[v as usize])
        .collect();
    let triangles = (0..mesh.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]);
    TriMesh::new(positions, triangles.collect())
}

/// The terrain with vertices and triangles in a scattered order.
fn scattered() -> TriMesh {
    let mut mesh = terrain();
    let n = mesh.positions.len() as u64;
    // 7,919 shares no factor with the 1001 x 1001 vertices or 2,000,000 triangles.
    let new = |v: u32| (u64::from(v) * 7919 * 7919 % n) as u32;
    let mut positions = mesh.positions.clone();
    for (v, &p) in (0u32..).zip(&mesh.positions) {
        positions[new(v) as usize] = p;
    }
    let m = mesh.triangles.len() as u64;
    let triangle = |t: u64| mesh.triangles[(t * 7919 * 7919 % m) as usize].map(new);
    let triangles = (0..m).map(triangle).collect();
    (mesh.positions, mesh.triangles) = (positions, triangles);
    mesh
}

fn connectivity(mesh: &TriMesh) -> karui::Result<Halfedge> {
    Halfedge::of_mesh(mesh, &PositionIds::of_mesh(mesh))
}

fn normals(mesh: &TriMesh) -> karui::Result<usize> {
    let ids = PositionIds::of_mesh(mesh);
    vertex_normals(mesh, &ids, NormalWeight::Angle).map(|n| n.len())
}

macro_rules! benches {
    ($($name:ident: $mesh:ident, $work:expr;)*) => {
        $(#[divan::bench(sample_count = 5, sample_size = 1)]
        fn $name(bencher: divan::Bencher<'_, '_>) {
            let mesh = $mesh();
            bencher.bench_local(|| $work(&mesh));
        })*
    };
}

benches! {
    position_ids_terrain: terrain, PositionIds::of_mesh;
    position_ids_unindexed: unindexed, PositionIds::of_mesh;
    position_ids_scattered: scattered, PositionIds::of_mesh;
    ids_and_halfedges_terrain: terrain, connectivity;
    ids_and_halfedges_unindexed: unindexed, connectivity;
    ids_and_halfedges_scattered: scattered, connectivity;
    diagnose_terrain: terrain, diagnose;
    repair_terrain: terrain, |m| repair(m, &RepairOptions::default());
    weld_unindexed: unindexed, |m| weld(m, &WeldOptions::default());
    components_terrain: terrain, |m| Components::of(m, &PositionIds::of_mesh(m));
    normals_terrain: terrain, normals;
}
