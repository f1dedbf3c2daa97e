//! What each shape of the zoo is: its topology from theory, not from a run.

use karui::mesh::{
    Halfedge, PositionIds, RepairOptions, TopologyReport, TriMesh, diagnose, diagnose_with, repair,
    shapes,
};

/// The counts of one shape.
#[derive(Debug, PartialEq, Default)]
struct Expected {
    name: &'static str,
    positions: usize,
    euler: i64,
    boundary: [usize; 2],
    nonmanifold: [usize; 2],
    inconsistent: usize,
    components: usize,
    /// Degenerate, zero-area, duplicate.
    faulty: [usize; 3],
    uv_charts: Option<usize>,
}

fn row(name: &'static str, positions: usize, euler: i64) -> Expected {
    Expected {
        name,
        positions,
        euler,
        components: 1,
        ..Expected::default()
    }
}

impl Expected {
    fn edges_and_loops(self, edges: usize, loops: usize) -> Self {
        let boundary = [edges, loops];
        Self { boundary, ..self }
    }

    fn nonmanifold(self, edges: usize, vertices: usize) -> Self {
        let nonmanifold = [edges, vertices];
        Self {
            nonmanifold,
            ..self
        }
    }

    fn charts(self, charts: usize) -> Self {
        let uv_charts = Some(charts);
        Self { uv_charts, ..self }
    }

    fn of(name: &'static str, report: &TopologyReport) -> Self {
        Self {
            name,
            positions: report.positions,
            euler: report.euler_characteristic,
            boundary: [report.boundary_edges, report.boundary_loops],
            nonmanifold: [report.nonmanifold_edges, report.nonmanifold_vertices],
            inconsistent: report.inconsistent_edges,
            components: report.components,
            faulty: [report.degenerate, report.zero_area, report.duplicate_faces],
            uv_charts: report.uv_charts,
        }
    }
}

fn table() -> Vec<Expected> {
    vec![
        Expected {
            components: 0,
            ..row("empty", 0, 0)
        },
        row("triangle", 3, 1).edges_and_loops(3, 1),
        row("uv_sphere", 2 + 7 * 12, 2),
        row("icosphere", 10 * 16 + 2, 2),
        row("torus", 16 * 8, 0),
        row("cube", 8, 2).charts(6),
        row("cube_subdivided", 6 * 16 + 2, 2).charts(6),
        row("closed_cube", 6 * 4 + 2, 2),
        row("grid", 7 * 5, 1)
            .edges_and_loops(2 * (6 + 4), 1)
            .charts(1),
        row("terrain", 17 * 13, 1)
            .edges_and_loops(2 * (16 + 12), 1)
            .charts(1),
        Expected {
            inconsistent: 4,
            ..row("moebius", 24 * 5, 0).edges_and_loops(2 * 24, 1)
        },
        Expected {
            inconsistent: 12,
            ..row("klein_bottle", 24 * 12, 0)
        },
        // 5 positions, 7 edges, 3 triangles.
        row("book", 5, 1).edges_and_loops(6, 1).nonmanifold(1, 0),
        // 5 positions, 6 edges, 2 triangles.
        row("bow_tie", 5, 1).edges_and_loops(6, 1).nonmanifold(0, 1),
        // 5 positions, 8 edges, 3 triangles; the gap has no width.
        row("t_junction", 5, 0)
            .edges_and_loops(7, 1)
            .nonmanifold(0, 2),
        Expected {
            faulty: [1, 1, 0],
            ..row("slivers", 11, 1).edges_and_loops(11, 1)
        },
        // A sphere's 2 and two more triangles without new edges.
        Expected {
            faulty: [0, 0, 2],
            ..row("duplicate_faces", 42, 4).nonmanifold(3, 0)
        },
        Expected {
            inconsistent: 3,
            ..row("flipped_face", 2 + 5 * 8, 2)
        },
        Expected {
            components: 2,
            ..row("touching_parts", 16, 4)
        },
        // Two cubes (8 - 18 + 12 each) less two vertices and an edge.
        row("cubes_sharing_edge", 14, 3).nonmanifold(1, 0),
        row("textured_sphere", 2 + 7 * 12, 2).charts(1),
        row("loaded_sphere", 2 + 7 * 12, 2).charts(1),
    ]
}

#[test]
fn every_shape_is_what_it_claims() {
    let zoo = shapes::zoo();
    let table = table();
    assert_eq!(zoo.len(), table.len());
    for ((name, mesh), expected) in zoo.into_iter().zip(table) {
        let report = diagnose(&mesh).unwrap();
        assert_eq!(Expected::of(name, &report), expected);
        assert_eq!(report.closed, expected.boundary == [0, 0], "{name}");
        assert_eq!(report.manifold, expected.nonmanifold == [0, 0], "{name}");
        assert_eq!(report.oriented, expected.inconsistent == 0, "{name}");
        assert_eq!(report.unreferenced_vertices, 0, "{name}");
    }
}

fn connectivity(mesh: &TriMesh) -> karui::Result<Halfedge> {
    Halfedge::of_mesh(mesh, &PositionIds::of_mesh(mesh))
}

#[test]
fn halfedges_exist_exactly_for_manifold_oriented_shapes_and_agree() {
    for (name, mesh) in shapes::zoo() {
        let report = diagnose(&mesh).unwrap();
        let topology = connectivity(&mesh);
        let representable = report.manifold && report.oriented && report.degenerate == 0;
        assert_eq!(topology.is_ok(), representable, "{name}");
        let Ok(topology) = topology else { continue };
        topology.validate().unwrap();
        assert_eq!(topology.edge_count(), report.edges, "{name}");
        assert_eq!(
            topology.boundary_loops().len(),
            report.boundary_loops,
            "{name}"
        );
        let euler = topology.euler_characteristic();
        assert_eq!(euler, report.euler_characteristic, "{name}");
    }
}

#[test]
fn errors_name_the_element() {
    let message = |mesh: &TriMesh| connectivity(mesh).unwrap_err().to_string();
    let book = "3 faces meet in the edge between vertices 0 and 1, more than two";
    assert_eq!(message(&shapes::book(3)), book);
    let bow_tie = "the faces around vertex 0 form more than one fan";
    assert_eq!(message(&shapes::bow_tie()), bow_tie);
    let slivers = "face 9 is degenerate: it has fewer than three different corners";
    assert_eq!(message(&shapes::slivers(8)), slivers);
    let two_pages = "faces 0 and 1 have opposite orientation at the edge from vertex 0 to 1";
    assert_eq!(message(&shapes::book(2)), two_pages);
}

#[test]
fn repair_cuts_what_is_not_manifold() {
    // Name; edges cut, positions split, vertices added, components after.
    let cases = [
        ("cube", [0, 0, 0], 1),
        ("book", [1, 2, 4], 3),
        ("bow_tie", [0, 1, 1], 2),
        ("t_junction", [0, 2, 2], 2),
        // The strip is cut across: four edges, five positions.
        ("moebius", [4, 5, 5], 1),
        // The tube is cut around.
        ("klein_bottle", [12, 12, 12], 1),
        ("flipped_face", [3, 3, 3], 2),
        // The cubes never shared vertices, only positions.
        ("cubes_sharing_edge", [1, 2, 0], 2),
    ];
    for (name, [edges, positions, added], components) in cases {
        let zoo = shapes::zoo();
        let (_, mesh) = zoo.iter().find(|(n, _)| *n == name).unwrap();
        let repaired = repair(mesh, &RepairOptions::default()).unwrap();
        let counts = repaired.counts;
        let found = [
            counts.split_edges,
            counts.split_vertices,
            counts.added_vertices,
        ];
        assert_eq!(found, [edges, positions, added], "{name}");
        let report = diagnose_with(&repaired.mesh, &repaired.ids).unwrap();
        assert!(report.manifold && report.oriented, "{name}");
        assert_eq!(report.components, components, "{name}");
        assert_eq!(report.triangles, mesh.triangles.len(), "{name}");
    }
}

#[test]
fn repair_drops_what_is_superfluous() {
    let options = RepairOptions {
        drop_zero_area: true,
        ..RepairOptions::default()
    };
    let mut mesh = shapes::slivers(8);
    mesh.positions.push(karui::geom::Vec3::ONE);
    let counts = repair(&mesh, &options).unwrap().counts;
    assert_eq!([counts.degenerate, counts.zero_area], [1, 1]);
    // The lone one and the tip of the triangle without area.
    assert_eq!(counts.unreferenced, 2);
    let repaired = repair(&shapes::duplicate_faces(), &options).unwrap();
    assert_eq!(repaired.counts.duplicates, 1);
    assert_eq!(repaired.mesh.triangles.len(), 81);
}

#[test]
fn orienting_turns_the_minority() {
    let options = RepairOptions {
        orient: true,
        ..RepairOptions::default()
    };
    let flipped = repair(&shapes::flipped_face(), &options).unwrap();
    assert_eq!(flipped.counts.flipped, 1);
    assert_eq!(flipped.mesh, shapes::uv_sphere(6, 8));
    let mut mesh = shapes::icosphere(2);
    for t in mesh.triangles.iter_mut().step_by(3) {
        t.swap(0, 1);
    }
    let oriented = repair(&mesh, &options).unwrap();
    let report = diagnose_with(&oriented.mesh, &oriented.ids).unwrap();
    assert!(report.oriented && report.closed && report.volume.unwrap() > 3.5);
    // A one-sided surface cannot be oriented, so it must still be cut.
    let moebius = repair(&shapes::moebius(24, 4), &options).unwrap();
    assert_eq!(moebius.counts.split_edges, 4);
    assert!(moebius.counts.flipped < 24 * 4);
}

#[test]
fn area_and_volume_of_boxes() {
    let report = diagnose(&shapes::cube(3)).unwrap();
    assert!((report.area - 6.0).abs() < 1e-6);
    assert!((report.volume.unwrap() - 1.0).abs() < 1e-6);
    assert_eq!(diagnose(&shapes::grid(3, 3)).unwrap().volume, None);
    assert_eq!(diagnose(&shapes::flipped_face()).unwrap().volume, None);
}
