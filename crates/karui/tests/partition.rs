//! The partition against its plain definition: everything sorted, in one place.
#![allow(clippy::unwrap_used, reason = "it is a test")]

use glam::{DMat4, DVec3, DVec4, Vec3};
use karui::{
    TriMesh,
    geom::{Aabb, normal_times_two_areas},
    mesh::shapes,
    partition::{
        CostHistogram, Grid, Load, LoadHistogram, PlaneSum, Regions, VertexCost, vertex_costs,
    },
};
use proptest::prelude::*;
use std::{collections::BTreeSet, time::Instant};

fn all_costs(mesh: &TriMesh) -> Vec<VertexCost> {
    vertex_costs(&mesh.positions, &mesh.triangles, 0..mesh.positions.len()).unwrap()
}

/// Equations 1 to 5 of the paper as they are written, in f64.
fn plain_costs(mesh: &TriMesh) -> Vec<(f64, usize)> {
    let mut quadrics = vec![DMat4::ZERO; mesh.positions.len()];
    let mut neighbours = vec![BTreeSet::new(); mesh.positions.len()];
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        for (i, &v) in triangle.iter().enumerate() {
            for w in [triangle[(i + 1) % 3], triangle[(i + 2) % 3]] {
                if v != w {
                    neighbours[v as usize].insert(w);
                }
            }
        }
        let corners = mesh.corners(t);
        let Some(n) = normal_times_two_areas(corners).try_normalize() else {
            continue;
        };
        let plane = n.extend(-n.dot(corners[0]));
        let k = DMat4::from_cols(
            plane * plane.x,
            plane * plane.y,
            plane * plane.z,
            plane * plane.w,
        );
        for &v in triangle {
            quadrics[v as usize] += k;
        }
    }
    let cost = |(v, around): (usize, &BTreeSet<u32>)| {
        let edge = |&w: &u32| {
            let [p, q] = [v, w as usize].map(|i| mesh.positions[i].as_dvec3());
            let x: DVec4 = ((p + q) * 0.5).extend(1.0);
            x.dot((quadrics[v] + quadrics[w as usize]) * x)
        };
        let sum: f64 = around.iter().map(edge).sum();
        (sum / around.len().max(1) as f64, around.len())
    };
    neighbours.iter().enumerate().map(cost).collect()
}

fn meshes() -> Vec<TriMesh> {
    vec![
        shapes::landscape(30, 20, 3),
        shapes::icosphere(3),
        shapes::torus(2.0, 0.5, 24, 12),
        shapes::tree(30, 1),
        shapes::book(5),
        shapes::cube(3),
        shapes::grid(9, 7),
    ]
}

#[test]
fn costs_are_those_of_the_paper() {
    for mesh in meshes() {
        let size = Aabb::of(mesh.positions.iter().copied()).diagonal();
        for (found, (cost, edges)) in all_costs(&mesh).iter().zip(plain_costs(&mesh)) {
            assert_eq!(found.edges as usize, edges);
            let tolerance = 1e-9 * (cost + size * size);
            assert!((found.cost - cost).abs() <= tolerance, "{found:?} {cost}");
        }
    }
}

#[test]
fn slices_with_two_rings_know_what_the_whole_knows() {
    let mesh = shapes::landscape(40, 30, 5);
    let whole = all_costs(&mesh);
    for own in [0..100, 100..777, 777..mesh.positions.len()] {
        let touches = |ring: &BTreeSet<u32>, t: &&[u32; 3]| t.iter().any(|v| ring.contains(v));
        let own_ids: BTreeSet<u32> = own.clone().map(|v| v as u32).collect();
        let near = mesh.triangles.iter().filter(|t| touches(&own_ids, t));
        let ring: BTreeSet<u32> = near.flatten().copied().collect();
        let slice = mesh.triangles.iter().filter(|t| touches(&ring, t));
        let mut slice: Vec<_> = slice.copied().collect();
        // Nor does the order of triangles matter.
        slice.reverse();
        let found = vertex_costs(&mesh.positions, &slice, own.clone()).unwrap();
        assert_eq!(found, whole[own]);
    }
}

/// The base value by sorting all costs, as step 3 says; as bins round them.
fn plain_base(costs: &[VertexCost], share: f64) -> Option<f64> {
    let mut sorted: Vec<f64> = costs.iter().map(|c| c.cost).collect();
    sorted.sort_by(f64::total_cmp);
    let place = (sorted.len() as f64 * share).floor() as usize;
    Some(sorted[place.checked_sub(1)?])
}

#[test]
fn the_base_is_that_of_sorting_everything() {
    for mesh in meshes() {
        let costs = all_costs(&mesh);
        let histogram = CostHistogram::of(&costs);
        assert_eq!(histogram.vertices(), costs.len() as u64);
        for share in [0.0, 0.001, 0.1, 0.5, 0.9, 1.0] {
            let base = histogram.base(share);
            let Some(plain) = plain_base(&costs, share) else {
                assert!(costs.iter().all(|c| !base.is_likely(c.cost)));
                continue;
            };
            for c in &costs {
                // Beyond the base, ties within a bin of 0.4 % count as likely.
                let expected = c.cost <= plain;
                let tie = c.cost <= plain * 1.004 + 1e-38;
                assert!(
                    base.is_likely(c.cost) == expected || (tie && !expected),
                    "{c:?} {plain}"
                );
            }
        }
    }
}

fn bounds(mesh: &TriMesh) -> Aabb {
    Aabb::of(mesh.positions.iter().copied())
}

fn loads(mesh: &TriMesh, grid: Grid, share: f64) -> LoadHistogram {
    let costs = all_costs(mesh);
    let base = CostHistogram::of(&costs).base(share);
    LoadHistogram::of(grid, &mesh.positions, &costs, base)
}

/// Largest over least, of what the regions hold.
fn spread(regions: &Regions, of: impl Fn(&Load) -> u64) -> f64 {
    let most = regions.loads.iter().map(&of).max().unwrap();
    let least = regions.loads.iter().map(of).min().unwrap();
    most as f64 / least as f64
}

/// Hills on the left, a plain on the right.
fn half_flat() -> TriMesh {
    let mut mesh = shapes::landscape(512, 256, 1);
    for p in &mut mesh.positions {
        p.y *= ((256.0 - p.x) / 32.0).clamp(0.0, 1.0);
    }
    mesh
}

#[test]
fn load_is_balanced_where_vertices_are_not() {
    let mesh = half_flat();
    let started = Instant::now();
    let costs = all_costs(&mesh);
    println!(
        "costs of {} vertices: {:.0?}",
        costs.len(),
        started.elapsed()
    );
    for (share, apart) in [(0.3, 1.5), (0.5, 1.5), (0.7, 1.5), (0.9, 1.1)] {
        let loads = loads(&mesh, Grid::along_longest(bounds(&mesh)), share);
        let aware = Regions::load_aware(&loads, 8);
        let equal = Regions::equal_vertices(&loads, 8);
        assert_eq!((aware.len(), equal.len()), (8, 8));
        let spreads = [&aware, &equal].map(|r| spread(r, |l| l.edges));
        println!("share {share}: edges likely to be collapsed, most / least: {spreads:?}");
        assert!(spreads[0] <= 1.15, "{share}: {spreads:?}");
        assert!(spreads[1] >= apart, "{share}: {spreads:?}");
        assert!(spread(&equal, |l| l.vertices) <= 1.05);
    }
}

/// Where the regions end if all likely vertices are sorted along the axis.
#[test]
fn regions_are_those_of_sorting_everything() {
    for mesh in meshes() {
        let costs = all_costs(&mesh);
        let base = CostHistogram::of(&costs).base(0.5);
        let grid = Grid::along_longest(bounds(&mesh));
        let histogram = LoadHistogram::of(grid, &mesh.positions, &costs, base);
        let size = grid.bounds.size();
        let axis = (0..3)
            .rev()
            .max_by(|&a, &b| size[a].total_cmp(&size[b]))
            .unwrap();
        for wanted in [2, 3, 8] {
            let regions = Regions::load_aware(&histogram, wanted);
            let mut order: Vec<usize> = (0..costs.len()).collect();
            order.sort_by(|&a, &b| mesh.positions[a][axis].total_cmp(&mesh.positions[b][axis]));
            // Swept along the axis, numbers of regions ascend, and each has its share but
            // for one slab's.
            let regions_of: Vec<u32> = order
                .iter()
                .map(|&v| regions.region_of(mesh.positions[v]))
                .collect();
            assert!(regions_of.is_sorted());
            let mut sums = vec![Load::default(); regions.len()];
            for (&v, &r) in order.iter().zip(&regions_of) {
                let likely = base.is_likely(costs[v].cost);
                sums[r as usize].add(Load {
                    vertices: 1,
                    likely: likely.into(),
                    edges: if likely { costs[v].edges.into() } else { 0 },
                });
            }
            assert_eq!(sums, regions.loads);
            let slab = histogram.loads.values().map(|l| l.edges).max().unwrap();
            let total = histogram.total().edges;
            for load in &regions.loads {
                assert!(load.edges * wanted as u64 <= total + slab * wanted as u64 + 8);
            }
        }
    }
}

#[test]
fn a_vertex_of_a_million_edges_unbalances_nothing() {
    let rim = 1_000_000u32;
    let mut positions: Vec<Vec3> = (0..rim)
        .map(|i| {
            // A closed loop around a square, with bumps.
            let side = (i / 250_000) as usize;
            let along = (i % 250_000) as f32 / 250_000.0;
            let y = ((i.wrapping_mul(2_654_435_761) >> 8) & 0xff) as f32 / 2550.0;
            let (x, z) = [
                (along, 0.0),
                (1.0, along),
                (1.0 - along, 1.0),
                (0.0, 1.0 - along),
            ][side];
            Vec3::new(1.5 * x, y, z)
        })
        .collect();
    positions.push(Vec3::new(0.3, 1.0, 0.5));
    let triangles = (0..rim).map(|i| [rim, (i + 1) % rim, i]).collect();
    let mesh = TriMesh::new(positions, triangles);
    let costs = all_costs(&mesh);
    assert_eq!(costs[rim as usize].edges, rim);
    assert!(costs.iter().all(|c| c.cost.is_finite()));
    for share in [0.5, 1.0] {
        let loads = loads(&mesh, Grid::along_longest(bounds(&mesh)), share);
        let regions = Regions::load_aware(&loads, 8);
        // The two ends of the square each hold a quarter of a million in one slab.
        let most = regions.loads.iter().map(|l| l.edges).max().unwrap();
        let slab = loads.loads.values().map(|l| l.edges).max().unwrap();
        assert!(most <= loads.total().edges / 8 + slab);
        assert!(loads.total().edges <= 3 * u64::from(rim) + 64);
    }
}

#[test]
fn cells_hold_no_more_than_they_may() {
    let mesh = shapes::icosphere(5);
    let histogram = loads(&mesh, Grid::cells(bounds(&mesh)), 0.5);
    let regions = Regions::cells(&histogram, 500).unwrap();
    assert!(
        regions.len() > mesh.positions.len() / 500,
        "{}",
        regions.len()
    );
    assert!(
        regions
            .loads
            .iter()
            .all(|l| (1..=500).contains(&l.vertices))
    );
    let mut counts = vec![0; regions.len()];
    for &p in &mesh.positions {
        counts[regions.region_of(p) as usize] += 1;
    }
    assert!(
        counts
            .iter()
            .zip(&regions.loads)
            .all(|(&c, l)| c == l.vertices)
    );
    assert!(Regions::cells(&loads(&mesh, Grid::along_longest(bounds(&mesh)), 0.5), 9).is_err());
    // The model may have been cut along the curve just as well.
    let aware = Regions::load_aware(&histogram, 8);
    assert!(spread(&aware, |l| l.edges) <= 1.05);
    // All in one place cannot be split, however few are allowed.
    let point = TriMesh::new(vec![Vec3::ONE; 100], Vec::new());
    let regions = Regions::cells(&loads(&point, Grid::cells(bounds(&point)), 0.5), 1).unwrap();
    assert_eq!((regions.len(), regions.loads[0].vertices), (1, 100));
}

#[test]
fn awkward_models_have_regions_too() {
    let empty = TriMesh::default();
    let with = |p: Vec3| {
        let mut mesh = shapes::icosphere(2);
        mesh.positions[7] = p;
        mesh
    };
    let moved = |scale: f32, by: f32| {
        let mut mesh = shapes::icosphere(2);
        mesh.positions.iter_mut().for_each(|p| *p = *p * scale + by);
        mesh
    };
    let models = [
        empty,
        with(Vec3::NAN),
        with(Vec3::INFINITY),
        with(Vec3::new(0.0, f32::NEG_INFINITY, 1.0)),
        with(Vec3::splat(f32::MAX)),
        moved(0.0, 3.0),
        moved(-2.0, 1e9),
        moved(1e9, 0.0),
        moved(1e-30, 0.0),
        moved(1e30, 0.0),
        shapes::grid(5, 5),
        TriMesh::new(vec![Vec3::X; 5], vec![[0, 0, 0], [1, 2, 2], [3, 4, 3]]),
    ];
    for (i, mesh) in models.iter().enumerate() {
        let finite = mesh.positions.iter().copied().filter(|p| p.is_finite());
        let bounds = Aabb::of(finite);
        for grid in [Grid::along_longest(bounds), Grid::cells(bounds)] {
            for share in [0.0, 0.5, 1.0, f64::NAN, -1.0, 7.0] {
                let loads = loads(mesh, grid, share);
                assert_eq!(loads.total().vertices, mesh.positions.len() as u64);
                let mut all = vec![
                    Regions::load_aware(&loads, 8),
                    Regions::equal_vertices(&loads, 0),
                ];
                all.extend(Regions::cells(&loads, 10));
                for regions in all {
                    assert!(
                        !regions.is_empty() && regions.starts[0] == 0 && regions.starts.is_sorted()
                    );
                    let inside = |&p: &Vec3| (regions.region_of(p) as usize) < regions.len();
                    assert!(mesh.positions.iter().all(inside), "model {i}");
                    let total: u64 = regions.loads.iter().map(|l| l.vertices).sum();
                    assert_eq!(total, mesh.positions.len() as u64);
                    assert!(
                        regions
                            .loads
                            .iter()
                            .all(|l| (0.0..=1.0).contains(&l.ratio()))
                    );
                }
            }
        }
    }
    // Far from the origin nothing cancels: the plane through 1e9 is still a plane.
    let mut far = shapes::grid(8, 8);
    far.positions.iter_mut().for_each(|p| *p = *p * 1e6 + 1e9);
    assert!(all_costs(&far).iter().all(|c| c.cost == 0.0));
    assert!(vertex_costs(&[Vec3::ZERO], &[[0, 0, 1]], 0..1).is_err());
    assert!(vertex_costs(&[Vec3::ZERO], &[], 0..2).is_err());
}

#[test]
fn planes_are_added_in_any_order() {
    let mesh = shapes::torus(2.0, 0.5, 9, 7);
    let mut sums = [PlaneSum::default(); 2];
    for t in 0..mesh.triangles.len() {
        sums[0].add_triangle(mesh.corners(t).map(|c| c.as_vec3()));
        let other = mesh.triangles.len() - 1 - t;
        sums[1].add_triangle(mesh.corners(other).map(|c| c.as_vec3()));
    }
    assert_eq!(sums[0], sums[1]);
    // As many squared distances as planes, whichever they are.
    let trace = [0, 3, 5].map(|i| sums[0].entries[i]).iter().sum::<i64>();
    assert!((trace - ((mesh.triangles.len() as i64) << 38)).abs() < 1000);
    assert!(sums[0].cost(DVec3::ZERO) == 0.0);
}

proptest! {
    #[test]
    fn histograms_merge_in_any_order(
        columns in 2u32..20, rows in 2u32..20, seed in any::<u64>(),
        cuts in proptest::collection::vec(0usize..400, 0..5), turn in 0usize..6,
    ) {
        let mesh = shapes::landscape(columns, rows, seed);
        let count = mesh.positions.len();
        let costs = all_costs(&mesh);
        let grid = Grid::along_longest(bounds(&mesh));
        let whole = CostHistogram::of(&costs);
        let base = whole.base(0.6);
        let whole_loads = LoadHistogram::of(grid, &mesh.positions, &costs, base);
        let mut ends: Vec<usize> = cuts.iter().map(|c| c % (count + 1)).chain([0, count]).collect();
        ends.sort_unstable();
        let mut slices: Vec<_> = ends.windows(2).map(|w| w[0]..w[1]).collect();
        let turn = turn % slices.len();
        slices.rotate_left(turn);
        let (mut merged, mut loads) = (CostHistogram::default(), LoadHistogram::empty(grid));
        for slice in slices {
            merged.merge(&CostHistogram::of(&costs[slice.clone()]));
            let part = LoadHistogram::of(grid, &mesh.positions[slice.clone()], &costs[slice], base);
            loads.merge(&part).unwrap();
        }
        prop_assert!(merged == whole);
        prop_assert!(loads == whole_loads);
        let others = LoadHistogram::empty(Grid::cells(bounds(&mesh)));
        prop_assert!(loads.merge(&others).is_err());
    }
}
