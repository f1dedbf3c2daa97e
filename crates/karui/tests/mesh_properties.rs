//! Properties of the mesh operations on any input, good or bad.

use glam::{Vec2, Vec3};
use karui::mesh::{
    Components, FaceId, Halfedge, NormalWeight, PositionIds, RepairOptions, TriMesh, VertexId,
    WeldOptions, diagnose, diagnose_with, repair, shapes, vertex_normals, weld,
};
use proptest::prelude::*;

/// Any triangles over positions of a coarse lattice, so that positions,
/// edges and whole triangles repeat; UVs from few values, so that welding has
/// something to join and something not to.
fn soup() -> impl Strategy<Value = TriMesh> {
    let vertex = ([0i8..3, 0i8..3, 0i8..2], 0u8..2);
    (3usize..14).prop_flat_map(move |n| {
        let triangle = [0..n as u32, 0..n as u32, 0..n as u32];
        let vertices = prop::collection::vec(vertex.clone(), n);
        let triangles = prop::collection::vec(triangle, 0..30);
        (vertices, triangles).prop_map(|(vertices, triangles)| {
            let position = |([x, y, z], _): &([i8; 3], u8)| {
                Vec3::new(f32::from(*x), f32::from(*y), f32::from(*z))
            };
            let uv = |(_, u): &([i8; 3], u8)| Vec2::new(f32::from(*u), 0.0);
            let mut mesh = TriMesh::new(vertices.iter().map(position).collect(), triangles);
            mesh.attributes.uvs = vec![vertices.iter().map(uv).collect()];
            mesh
        })
    })
}

fn zoo_mesh() -> impl Strategy<Value = TriMesh> {
    let zoo: Vec<TriMesh> = shapes::zoo().into_iter().map(|(_, mesh)| mesh).collect();
    prop::sample::select(zoo)
}

fn any_mesh() -> impl Strategy<Value = TriMesh> {
    prop_oneof![4 => soup(), 1 => zoo_mesh()]
}

fn all_options() -> impl Strategy<Value = RepairOptions> {
    any::<[bool; 6]>().prop_map(|[a, b, c, d, e, f]| RepairOptions {
        drop_degenerate: a,
        drop_zero_area: b,
        drop_duplicates: c,
        orient: d,
        split_non_manifold: e,
        drop_unreferenced: f,
    })
}

/// The definition of "half-edges exist", counted the slow way.
fn is_manifold_by_definition(triangles: &[[u32; 3]], vertices: usize) -> bool {
    let directed: Vec<[u32; 2]> = triangles
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .collect();
    let proper = directed.iter().all(|[a, b]| a != b);
    let once = directed
        .iter()
        .all(|e| directed.iter().filter(|f| *f == e).count() == 1);
    proper && once && (0..vertices as u32).all(|v| has_one_fan(triangles, v))
}

fn has_one_fan(triangles: &[[u32; 3]], v: u32) -> bool {
    let mut around: Vec<&[u32; 3]> = triangles.iter().filter(|t| t.contains(&v)).collect();
    let Some(first) = around.pop() else {
        return true;
    };
    let mut rim: Vec<u32> = first.to_vec();
    while let Some(i) = around
        .iter()
        .position(|t| t.iter().any(|&w| w != v && rim.contains(&w)))
    {
        rim.extend(around.swap_remove(i));
    }
    around.is_empty()
}

proptest! {
    #[test]
    fn repaired_meshes_are_valid_and_manifold(mesh in any_mesh(), options in all_options()) {
        let repaired = repair(&mesh, &options).unwrap();
        repaired.mesh.validate().unwrap();
        repaired.ids.validate_for(&repaired.mesh).unwrap();
        if options.split_non_manifold && options.drop_degenerate {
            let topology = Halfedge::of_mesh(&repaired.mesh, &repaired.ids).unwrap();
            topology.validate().unwrap();
            let report = diagnose_with(&repaired.mesh, &repaired.ids).unwrap();
            prop_assert!(report.manifold && report.oriented && report.degenerate == 0);
            if options.drop_duplicates && !options.orient {
                let again = repair(&repaired.mesh, &options).unwrap();
                prop_assert_eq!(again.counts.duplicates, 0);
            }
        }
    }

    #[test]
    fn repair_with_everything_off_changes_nothing(mesh in any_mesh()) {
        let none = RepairOptions {
            drop_degenerate: false, drop_zero_area: false, drop_duplicates: false,
            orient: false, split_non_manifold: false, drop_unreferenced: false,
        };
        let repaired = repair(&mesh, &none).unwrap();
        prop_assert_eq!(&repaired.mesh, &mesh);
        prop_assert_eq!(repaired.ids, PositionIds::of_mesh(&mesh));
    }

    #[test]
    fn repair_keeps_the_positions_of_the_triangles_it_keeps(mesh in any_mesh()) {
        let repaired = repair(&mesh, &RepairOptions::default()).unwrap();
        let counts = repaired.counts;
        let dropped = counts.degenerate + counts.zero_area + counts.duplicates;
        prop_assert_eq!(repaired.mesh.triangles.len() + dropped, mesh.triangles.len());
        let mut former = (0..mesh.triangles.len()).map(|t| mesh.corners(t));
        for t in 0..repaired.mesh.triangles.len() {
            let corners = repaired.mesh.corners(t);
            prop_assert!(former.any(|f| f == corners), "triangle {}", t);
        }
    }

    #[test]
    fn halfedges_exist_exactly_for_manifolds(mesh in soup()) {
        let ids = PositionIds::of_mesh(&mesh);
        let triangles = ids.triangles(&mesh.triangles);
        let exists = Halfedge::of_mesh(&mesh, &ids).is_ok();
        prop_assert_eq!(exists, is_manifold_by_definition(&triangles, ids.count));
    }

    #[test]
    fn halfedges_give_back_the_triangles(mesh in any_mesh()) {
        let repaired = repair(&mesh, &RepairOptions::default()).unwrap();
        let triangles = repaired.ids.triangles(&repaired.mesh.triangles);
        let topology = Halfedge::new(&triangles, repaired.ids.count).unwrap();
        for (f, triangle) in triangles.iter().enumerate() {
            let corners: Vec<u32> = topology.face_vertices(FaceId(f as u32)).map(|v| v.0).collect();
            prop_assert_eq!(&corners, triangle);
        }
        for v in (0..topology.vertex_count() as u32).map(VertexId) {
            let faces = topology.ring(v).filter(|&h| !topology.is_boundary(h)).count();
            let expected = triangles.iter().flatten().filter(|&&w| w == v.0).count();
            prop_assert_eq!(faces, expected);
            for h in topology.ring(v) {
                prop_assert_eq!(topology.find(v, topology.target(h)), Some(h));
            }
        }
    }

    #[test]
    fn welding_twice_is_welding_once(mesh in any_mesh(), tolerance in prop::sample::select(vec![0.0, 0.4, 1.1]), ignore_attributes: bool) {
        let options = WeldOptions { tolerance, ignore_attributes };
        let once = weld(&mesh, &options).unwrap();
        once.mesh.validate().unwrap();
        let twice = weld(&once.mesh, &options).unwrap();
        prop_assert_eq!(&twice.mesh, &once.mesh);
        for (v, &new) in once.new_vertex.iter().enumerate() {
            let moved = mesh.positions[v].distance(once.mesh.positions[new as usize]);
            prop_assert!(moved <= tolerance);
        }
    }

    #[test]
    fn exact_welds_by_the_definition(mesh in soup()) {
        let found = weld(&mesh, &WeldOptions::default()).unwrap().new_vertex;
        let uvs = &mesh.attributes.uvs[0];
        let same = |a: usize, b: usize| mesh.positions[a] == mesh.positions[b] && uvs[a] == uvs[b];
        for a in 0..found.len() {
            for b in 0..a {
                prop_assert_eq!(found[a] == found[b], same(a, b));
            }
        }
    }

    #[test]
    fn attributes_follow_their_vertices(keep in prop::collection::vec(any::<bool>(), 168), joins: bool) {
        let mut mesh = shapes::loaded_sphere(8, 12);
        let numbers = mesh.triangles.clone();
        prop_assert_eq!(numbers.len(), keep.len());
        mesh.retain_triangles(|t| keep[t]);
        let repaired = repair(&mesh, &RepairOptions::default()).unwrap().mesh;
        let options = WeldOptions { ignore_attributes: joins, ..WeldOptions::default() };
        let mut all = vec![repaired.clone(), weld(&repaired, &options).unwrap().mesh];
        let components = Components::of(&repaired, &PositionIds::of_mesh(&repaired)).unwrap();
        let parts = components.extract(&repaired).unwrap();
        prop_assert_eq!(parts.iter().map(|p| p.triangles.len()).sum::<usize>(), repaired.triangles.len());
        all.extend(parts);
        for mesh in all {
            mesh.validate().unwrap();
            for (v, &p) in mesh.positions.iter().enumerate() {
                prop_assert_eq!(mesh.attributes.uvs[1][v], Vec2::new(p.x, p.z));
                prop_assert_eq!(mesh.attributes.colors[0][v], (p * 0.5 + 0.5).extend(1.0));
            }
            let original = shapes::loaded_sphere(8, 12);
            let karui::mesh::AttributeValues::U32(numbers) = &mesh.face_attributes[0].values else {
                panic!("numbers are u32");
            };
            for (t, &number) in numbers.iter().enumerate() {
                prop_assert_eq!(mesh.corners(t), original.corners(number as usize));
                let range = mesh.range_of_triangles()[t];
                prop_assert_eq!(range, original.range_of_triangles()[number as usize]);
            }
        }
    }

    #[test]
    fn nothing_panics_on_broken_indices(mut mesh in soup(), bad in any::<u32>(), which in any::<prop::sample::Index>()) {
        if !mesh.triangles.is_empty() {
            let t = which.index(mesh.triangles.len());
            mesh.triangles[t][t % 3] = bad;
        }
        let ok = mesh.validate().is_ok();
        let ids = PositionIds::of_mesh(&mesh);
        prop_assert_eq!(diagnose(&mesh).is_ok(), ok);
        prop_assert_eq!(repair(&mesh, &RepairOptions::default()).is_ok(), ok);
        prop_assert_eq!(weld(&mesh, &WeldOptions::default()).is_ok(), ok);
        prop_assert_eq!(Components::of(&mesh, &ids).is_ok(), ok);
        prop_assert_eq!(vertex_normals(&mesh, &ids, NormalWeight::Angle).is_ok(), ok);
        prop_assert!(ok || Halfedge::of_mesh(&mesh, &ids).is_err());
        let foreign = PositionIds::distinct(mesh.positions.len() + 1);
        prop_assert!(diagnose_with(&mesh, &foreign).is_err());
        prop_assert!(Components::of(&mesh, &foreign).is_err());
    }
}
