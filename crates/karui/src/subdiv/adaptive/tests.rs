//! Against uniform refinement, vertex for vertex.

use super::store::{Origin, Store};
use super::*;
use crate::geom::{Aabb, Camera};
use crate::subdiv::masks;
use crate::subdiv::split::Kind;
use crate::subdiv::{Boundary, Corner, Crease, CreaseMethod, Level, TriangleRule};
use proptest::prelude::*;
use std::collections::HashMap;

/// Cages of all kinds: closed, open, of polygons, with a vertex of two fans.
fn zoo() -> Vec<(Cage, Vec<Vec3>)> {
    let cube = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32 * 1.3);
    let cube_points: Vec<Vec3> = (0..8).map(corner).collect();
    let faces = |faces: &[&[u32]]| {
        let mut cage = Cage {
            offsets: vec![0],
            ..Cage::default()
        };
        for face in faces {
            cage.indices.extend_from_slice(face);
            cage.offsets.push(cage.indices.len() as u32);
        }
        cage.vertices = cage.indices.iter().max().map_or(0, |m| *m as usize + 1);
        cage
    };
    let all: Vec<&[u32]> = cube.iter().map(|f| f.as_slice()).collect();
    let closed = faces(&all);
    let open = faces(&all[1..]);
    let prism = faces(&[
        &[4, 3, 2, 1, 0],
        &[5, 6, 7, 8, 9],
        &[0, 1, 6, 5],
        &[1, 2, 7],
        &[1, 7, 6],
        &[2, 3, 8, 7],
        &[3, 4, 9, 8],
        &[4, 0, 5, 9],
    ]);
    let ring = |i: u32| {
        let (s, c) = crate::geom::sin_cos(f64::from(i % 5) * 1.256);
        glam::DVec3::new(c, f64::from(i / 5) + 0.2 * s, s).as_vec3()
    };
    let bow_tie = faces(&[&[0, 1, 2], &[0, 3, 4, 5], &[2, 1, 6]]);
    let spread = |i: u32| {
        Vec3::new(
            (i * 7 % 5) as f32,
            (i * 3 % 4) as f32,
            (i * 5 % 7) as f32 * 0.3,
        )
    };
    vec![
        (closed, cube_points.clone()),
        (open, cube_points),
        (prism, (0..10).map(ring).collect()),
        (bow_tie, (0..7).map(spread).collect()),
    ]
}

fn view(points: &[Vec3], direction: Vec3) -> View {
    let bounds = Aabb::of(points.iter().copied());
    View {
        camera: Camera::looking_at(bounds, direction, 0.6),
        size: [640, 480],
        lights: Vec::new(),
    }
}

/// Finds the elements of uniform levels that those of tiers are.
struct Uniform {
    levels: Vec<Level>,
    positions: Vec<Vec<[f32; 3]>>,
    faces: Vec<HashMap<Vec<u32>, u32>>,
    edges: Vec<HashMap<[u32; 2], u32>>,
}

impl Uniform {
    fn new(cage: &Cage, points: &[Vec3], options: &SubdivOptions) -> Self {
        let kind = Kind::CATMULL_CLARK;
        let mut levels = vec![Level::of_cage(cage, options).unwrap()];
        let mut positions: Vec<Vec<[f32; 3]>> = vec![points.iter().map(|p| p.to_array()).collect()];
        for t in 0..options.levels as usize {
            levels.push(levels[t].refined(kind, true));
            let mut to = vec![[0.0; 3]; levels[t + 1].vertex_count()];
            masks::step(&levels[t], kind, &positions[t], &mut to);
            positions.push(to);
        }
        let sorted = |mut v: Vec<u32>| {
            v.sort_unstable();
            v
        };
        let faces = levels.iter().map(|l| {
            let face = |f: usize| (sorted(l.corners()[l.faces().corners(f)].to_vec()), f as u32);
            (0..l.faces().count()).map(face).collect()
        });
        let edges = levels.iter().map(|l| {
            let edge = |e: u32| {
                let [a, b] = l.edge(e);
                ([a.min(b), a.max(b)], e)
            };
            (0..l.edge_count() as u32).map(edge).collect()
        });
        Self {
            positions,
            faces: faces.collect(),
            edges: edges.collect(),
            levels,
        }
    }

    fn vertex(&self, store: &Store, t: usize, v: u32) -> u32 {
        let above = t.checked_sub(1).map(|t| &self.levels[t]);
        let first = |faces: bool| {
            let level = above.unwrap();
            (level.vertex_count() + if faces { 0 } else { level.faces().count() }) as u32
        };
        match store.tiers[t].vertices[v as usize].origin {
            Origin::Cage => v,
            Origin::Vertex(v) => self.vertex(store, t - 1, v),
            Origin::Face(f) => {
                let corners = store.tiers[t - 1].corners_of(f);
                let vertices = corners.map(|c| store.tiers[t - 1].corners[c as usize]);
                let mut found: Vec<u32> = vertices.map(|v| self.vertex(store, t - 1, v)).collect();
                found.sort_unstable();
                first(true) + self.faces[t - 1][&found]
            }
            Origin::Edge(e) => {
                let mut ends = store.tiers[t - 1].edges[e as usize].ends;
                ends = ends.map(|v| self.vertex(store, t - 1, v));
                ends.sort_unstable();
                first(false) + self.edges[t - 1][&ends]
            }
        }
    }

    /// Compares all vertices that are drawn.
    fn check(&self, adaptive: &mut Adaptive, mesh: &AdaptiveMesh) {
        for v in 0..mesh.points.len() {
            let [t, local] = adaptive.store.points[point_of(adaptive, v)].place;
            let same = self.vertex(&adaptive.store, t as usize, local);
            let expected = Vec3::from_array(self.positions[t as usize][same as usize]);
            let found = mesh.mesh.positions[v];
            assert!(
                found.distance(expected) < 1e-6,
                "vertex {v} of tier {t}: {found} {expected}"
            );
        }
    }
}

/// The store's number of the point of a vertex of the last frame.
fn point_of(adaptive: &Adaptive, v: usize) -> usize {
    let wedge = adaptive.drawing.wedges[v] as usize;
    adaptive.store.wedges[wedge].point as usize
}

fn tagged(cage: &Cage, tags: &[(usize, f32)]) -> Cage {
    let mut cage = cage.clone();
    for &(i, sharpness) in tags {
        let corner = i % cage.indices.len();
        let face = cage.offsets.partition_point(|&o| o as usize <= corner) - 1;
        let end = cage.offsets[face + 1] as usize;
        let next = if corner + 1 == end {
            cage.offsets[face] as usize
        } else {
            corner + 1
        };
        let vertices = [cage.indices[corner], cage.indices[next]];
        if i % 5 == 0 {
            cage.corners.push(Corner {
                vertex: vertices[0],
                sharpness,
            });
        } else {
            cage.creases.push(Crease {
                vertices,
                sharpness,
            });
        }
    }
    cage
}

/// Every edge has two faces, or one on the boundary of the cage; edges of the boundary are
/// those of the cage, cut in halves.
fn check_edges(cage: &Cage, mesh: &AdaptiveMesh) {
    let mut count: HashMap<[u32; 2], i32> = HashMap::new();
    for face in mesh.mesh.faces() {
        assert!(face.len() >= 3);
        for i in 0..face.len() {
            let [a, b] = [face[i], face[(i + 1) % face.len()]].map(|v| mesh.points[v as usize]);
            assert_ne!(a, b);
            *count.entry([a, b]).or_default() += 1;
        }
    }
    let mut open_cage: HashMap<[u32; 2], i32> = HashMap::new();
    for w in cage.offsets.windows(2) {
        let face = &cage.indices[w[0] as usize..w[1] as usize];
        for i in 0..face.len() {
            open_cage.insert([face[i], face[(i + 1) % face.len()]], 0);
        }
    }
    let ends = open_cage
        .keys()
        .filter(|[a, b]| !open_cage.contains_key(&[*b, *a]));
    let mut boundary: Vec<[u32; 2]> = ends.copied().collect();
    assert!(
        count.values().all(|&n| n == 1),
        "an edge twice in one sense"
    );
    let mut next: HashMap<u32, Vec<u32>> = HashMap::new();
    let mut open = 0;
    for [a, b] in count.keys().filter(|[a, b]| !count.contains_key(&[*b, *a])) {
        next.entry(*a).or_default().push(*b);
        open += 1;
    }
    // From vertex to vertex of the cage, over new ones only, and nothing is left over.
    boundary.sort_unstable();
    for [a, b] in boundary {
        let walk = |mut at: u32| {
            let mut steps = 1;
            while at as usize >= cage.vertices {
                let on = &next[&at];
                assert_eq!(on.len(), 1);
                (at, steps) = (on[0], steps + 1);
            }
            (at, steps)
        };
        let walks = next[&a].iter().map(|&n| walk(n));
        let found = walks.into_iter().find(|w| w.0 == b).unwrap();
        open -= found.1;
    }
    assert_eq!(open, 0, "a boundary that the cage does not have");
}

fn subdiv(chaikin: bool, smooth: bool, edge_only: bool, levels: u32) -> SubdivOptions {
    SubdivOptions {
        creases: if chaikin {
            CreaseMethod::Chaikin
        } else {
            CreaseMethod::Uniform
        },
        triangles: if smooth {
            TriangleRule::Smooth
        } else {
            TriangleRule::CatmullClark
        },
        boundary: if edge_only {
            Boundary::EdgeOnly
        } else {
            Boundary::EdgeAndCorner
        },
        levels,
        ..SubdivOptions::default()
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn vertices_are_those_of_uniform_refinement(
        which in 0usize..4,
        tags in proptest::collection::vec((0usize..40, 0.2f32..11.0), 0..5),
        rules in any::<[bool; 4]>(),
        toward in [-1f32..1.0, -1f32..1.0, -1f32..1.0],
        depths in [0u32..5, 3u32..9],
    ) {
        let (cage, points) = zoo().swap_remove(which);
        let cage = tagged(&cage, &tags);
        let chaikin = rules[0] && which < 3;
        let options = subdiv(chaikin, rules[1], rules[2], 5);
        let uniform = Uniform::new(&cage, &points, &options);
        let mut adaptive = Adaptive::new(&cage, &points, &options).unwrap();
        let view = view(&points, Vec3::from_array(toward) + 0.01);
        let mut how = AdaptiveOptions {
            depth_front: depths[0],
            depth_silhouette: depths[1],
            limit: false,
            spread: rules[3],
            ..AdaptiveOptions::default()
        };
        let mesh = adaptive.refine(&view, &how).unwrap();
        uniform.check(&mut adaptive, &mesh);
        check_edges(&cage, &mesh);
        how.limit = true;
        let limits = adaptive.refine(&view, &how).unwrap();
        prop_assert_eq!(&limits.mesh.indices, &mesh.mesh.indices);
        check_limits(&mut adaptive, &limits);
    }
}

/// Follows vertices down as many tiers as it takes.
fn check_limits(adaptive: &mut Adaptive, mesh: &AdaptiveMesh) {
    const DEEP: usize = 16;
    for v in (0..mesh.points.len()).step_by(17) {
        let point = point_of(adaptive, v);
        let store = &mut adaptive.store;
        let [t, local] = store.points[point].place;
        let (mut t, mut at) = (t as usize, local);
        let mut corner = store.tiers[t].vertices[at as usize].corner;
        while t < DEEP {
            store.children(t, store.tiers[t].face_of(corner));
            corner = 4 * store.tiers[t].child(corner);
            t += 1;
            at = store.tiers[t].corners[corner as usize];
        }
        let expected = store.position(t, at);
        let found = mesh.mesh.positions[v].as_dvec3();
        assert!(
            found.distance(expected) < 2e-6,
            "limit of {v}: {found} {expected}"
        );
    }
}

#[test]
fn normals_are_those_of_fine_meshes() {
    for (cage, points) in zoo() {
        let cage = tagged(&cage, &[(1, 10.0), (7, 2.0), (9, 10.0)]);
        let mut adaptive = Adaptive::new(&cage, &points, &SubdivOptions::default()).unwrap();
        let view = view(&points, Vec3::ONE);
        let mesh = adaptive
            .refine(&view, &AdaptiveOptions::uniform(4))
            .unwrap();
        let store = &mut adaptive.store;
        let mut compared = 0;
        for corner in 0..store.tiers[2].corners.len() as u32 {
            let wedge = store.wedge(2, corner);
            let normal = store.wedges[wedge as usize].normal.as_dvec3();
            let (mut t, mut c) = (2, corner);
            while t < 8 {
                store.children(t, store.tiers[t].face_of(c));
                c = 4 * store.tiers[t].child(c);
                if t == 2 {
                    // The child at the corner's own vertex.
                    assert_eq!(store.wedge(3, c), wedge);
                }
                t += 1;
            }
            let [a, b, d] = [0, 1, 3].map(|i| store.corner_position(t, c & !3 | (c + i) & 3));
            let fine = (b - a).cross(d - a).normalize();
            let cosine = fine.dot(normal);
            compared += 1;
            assert!(cosine > 0.97, "corner {corner}: {normal} {fine}");
        }
        assert!(compared > 30 && mesh.mesh.attributes.normals.is_some());
    }
}

#[test]
fn all_chosen_is_uniform_refinement() {
    for (cage, points) in zoo() {
        let options = subdiv(false, false, false, 3);
        let uniform = Uniform::new(&cage, &points, &options);
        let mut adaptive = Adaptive::new(&cage, &points, &options).unwrap();
        let how = AdaptiveOptions {
            limit: false,
            ..AdaptiveOptions::uniform(6)
        };
        let mesh = adaptive.refine(&view(&points, Vec3::ONE), &how).unwrap();
        uniform.check(&mut adaptive, &mesh);
        let mut found: Vec<Vec<u32>> = Vec::new();
        for face in mesh.mesh.faces() {
            let place = |&v: &u32| {
                let [t, v] = adaptive.store.points[point_of(&adaptive, v as usize)].place;
                uniform.vertex(&adaptive.store, t as usize, v)
            };
            let mut face: Vec<u32> = face.iter().map(place).collect();
            face.sort_unstable();
            found.push(face);
        }
        found.sort_unstable();
        let mut expected: Vec<Vec<u32>> = uniform.faces[3].keys().cloned().collect();
        expected.sort_unstable();
        assert_eq!(found, expected);
    }
}

#[test]
fn faces_double() {
    let (cage, points) = zoo().swap_remove(0);
    let mut adaptive = Adaptive::new(&cage, &points, &SubdivOptions::default()).unwrap();
    for depth in 0..9 {
        let mesh = adaptive.refine(&view(&points, Vec3::ONE), &AdaptiveOptions::uniform(depth));
        assert_eq!(mesh.unwrap().mesh.face_count(), 6 << depth);
    }
}

#[test]
fn a_frame_does_not_depend_on_those_before() {
    let (cage, points) = zoo().swap_remove(2);
    let cage = tagged(&cage, &[(3, 2.5), (11, 10.0)]);
    let how = AdaptiveOptions::within(0.5);
    let mut walked = Adaptive::new(&cage, &points, &SubdivOptions::default()).unwrap();
    for (i, direction) in crate::geom::fibonacci_directions(12)
        .into_iter()
        .enumerate()
    {
        let view = view(&points, direction);
        let mut fresh = Adaptive::new(&cage, &points, &SubdivOptions::default()).unwrap();
        if i == 5 {
            walked.pass = u32::MAX - 7;
        }
        if i == 8 {
            walked.move_cage(&points).unwrap();
        }
        let [a, b] = [&mut walked, &mut fresh].map(|a| a.refine(&view, &how).unwrap());
        assert!(a == b, "{i}");
    }
}

#[test]
fn bad_input_is_refused() {
    let (cage, points) = zoo().swap_remove(0);
    let new = |cage: &Cage, points: &[Vec3], scheme| {
        let options = SubdivOptions {
            scheme,
            ..SubdivOptions::default()
        };
        Adaptive::new(cage, points, &options)
    };
    let clark = Scheme::CatmullClark;
    assert!(matches!(
        new(&cage, &points, Scheme::Loop),
        Err(Error::BadOption { .. })
    ));
    assert!(matches!(
        new(&cage, &points[1..], clark),
        Err(Error::LengthMismatch { .. })
    ));
    let mut nan = points.clone();
    nan[3].y = f32::NAN;
    assert!(matches!(
        new(&cage, &nan, clark),
        Err(Error::NotFinite { index: 3, .. })
    ));
    let mut three = cage.clone();
    three.indices.extend([0, 1, 7]);
    three.offsets.push(27);
    assert!(new(&three, &points, clark).is_err());
    assert!(matches!(
        new(&Cage::default(), &[], clark),
        Err(Error::Empty { .. })
    ));
    let negative = tagged(&cage, &[(1, -0.5)]);
    assert!(matches!(
        new(&negative, &points, clark),
        Err(Error::BadOption { .. })
    ));

    let mut adaptive = new(&cage, &points, clark).unwrap();
    let good = view(&points, Vec3::ONE);
    let bad = [
        AdaptiveOptions::uniform(40),
        AdaptiveOptions::within(0.0),
        AdaptiveOptions::within(f64::NAN),
    ];
    for options in bad {
        assert!(matches!(
            adaptive.refine(&good, &options),
            Err(Error::BadOption { .. })
        ));
    }
    let mut lit = good.clone();
    lit.lights = vec![crate::geom::Light::headlight(&good.camera).unwrap(); 16];
    let mut flat = good.clone();
    flat.size = [0, 9];
    let mut nowhere = good.clone();
    nowhere.camera.eye = nowhere.camera.target;
    for view in [lit, flat, nowhere] {
        assert!(adaptive.refine(&view, &AdaptiveOptions::default()).is_err());
    }
    assert!(adaptive.move_cage(&nan).is_err());
    assert_eq!(
        adaptive
            .refine(&good, &AdaptiveOptions::uniform(0))
            .unwrap()
            .mesh
            .face_count(),
        6
    );
}

#[test]
fn sizes_are_kept_to() {
    let (cage, points) = zoo().swap_remove(1);
    let mut adaptive = Adaptive::new(&cage, &points, &SubdivOptions::default()).unwrap();
    let view = view(&points, Vec3::ONE);
    let few = AdaptiveOptions {
        max_faces: 100,
        max_kept: 10,
        ..AdaptiveOptions::uniform(30)
    };
    let first = adaptive.refine(&view, &few).unwrap();
    check_edges(&cage, &first);
    assert!(first.truncated && (100..200).contains(&first.mesh.face_count()));
    // Forgotten in between, and the same again.
    assert!(adaptive.kept() > 10 && adaptive.refine(&view, &few).unwrap() == first);
    let side = AdaptiveOptions {
        side_pixels: Some(20.0),
        ..AdaptiveOptions::within(1e6)
    };
    let small = adaptive.refine(&view, &side).unwrap();
    assert!(!small.truncated && small.mesh.face_count() > 100);
}

#[test]
fn coordinates_may_be_huge_or_all_the_same() {
    let (cage, points) = zoo().swap_remove(2);
    let same = vec![Vec3::ONE; points.len()];
    let huge: Vec<Vec3> = points.iter().map(|p| *p * 1e9 + Vec3::splat(1e9)).collect();
    for points in [same, huge] {
        let mut adaptive = Adaptive::new(&cage, &points, &SubdivOptions::default()).unwrap();
        let view = view(&points, Vec3::ONE);
        for options in [AdaptiveOptions::default(), AdaptiveOptions::within(0.5)] {
            let mesh = adaptive.refine(&view, &options).unwrap();
            check_edges(&cage, &mesh);
            assert!(mesh.mesh.positions.iter().all(|p| p.is_finite()));
        }
    }
}
