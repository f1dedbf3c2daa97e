//! Subdivision beside its definitions.
#![allow(clippy::unwrap_used, reason = "it is a test")]

use karui::subdiv::sqrt2::Odd;
use karui::subdiv::{
    Boundary, Cage, ControlMesh, Corner, Crease, Faces, Level, Refinement, Scheme, SubdivOptions,
    SurfaceOptions, subdivide,
};
mod limits;
mod rational;

use karui::{Error, Silent};
use proptest::prelude::*;
use std::collections::BTreeMap;

type Point = [f32; 3];
type Mesh = (Vec<Point>, Vec<Vec<u32>>);

fn cage(faces: &[Vec<u32>], vertices: usize) -> Cage {
    let mut cage = Cage {
        vertices,
        offsets: vec![0],
        ..Cage::default()
    };
    for face in faces {
        cage.indices.extend(face);
        cage.offsets.push(cage.indices.len() as u32);
    }
    cage
}

fn cube() -> Mesh {
    let corner = |i: u32| [0, 1, 2].map(|axis| (i >> axis & 1) as f32);
    let faces = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    (
        (0..8).map(corner).collect(),
        faces.map(|f| f.to_vec()).to_vec(),
    )
}

/// A prism over a polygon, closed by two n-gons.
fn prism(n: u32) -> Mesh {
    let at = |i: u32, y: f32| {
        let angle = std::f32::consts::TAU * i as f32 / n as f32;
        [angle.cos(), y, angle.sin() * 1.3]
    };
    let positions = (0..n).map(|i| at(i, 0.0)).chain((0..n).map(|i| at(i, 0.7)));
    let side = |i: u32| vec![i, n + i, n + (i + 1) % n, (i + 1) % n];
    let mut faces: Vec<Vec<u32>> = (0..n).map(side).collect();
    faces.push((0..n).collect());
    faces.push((n..2 * n).rev().collect());
    (positions.collect(), faces)
}

/// A sheet with a bump, some of its quads cut in two, with holes of one face in it.
fn sheet(n: u32) -> Mesh {
    let at = |i: u32| {
        let (x, y) = ((i % (n + 1)) as f32, (i / (n + 1)) as f32);
        [x, y, (0.3 * x * y).sin()]
    };
    let mut faces = Vec::new();
    for y in 0..n {
        for x in 0..n {
            let a = y * (n + 1) + x;
            let [b, c, d] = [a + 1, a + n + 2, a + n + 1];
            match (x + 2 * y) % 5 {
                0 => faces.extend([vec![a, b, c], vec![a, c, d]]),
                3 if x > 0 && y > 0 && x + 1 < n && y + 1 < n => {}
                _ => faces.push(vec![a, b, c, d]),
            }
        }
    }
    ((0..(n + 1) * (n + 1)).map(at).collect(), faces)
}

fn options(scheme: Scheme, levels: u32) -> SubdivOptions {
    SubdivOptions {
        scheme,
        levels,
        ..SubdivOptions::default()
    }
}

fn refined(mesh: &Mesh, options: &SubdivOptions) -> Mesh {
    let refinement = Refinement::new(&cage(&mesh.1, mesh.0.len()), options).unwrap();
    let faces = refinement.faces();
    let list = |f| refinement.corners()[faces.corners(f)].to_vec();
    (
        refinement.evaluate(&mesh.0).unwrap(),
        (0..faces.count()).map(list).collect(),
    )
}

/// Catmull and Clark as they put it, faces and edges looked for anew for every vertex.
fn by_definition((positions, faces): &Mesh) -> Mesh {
    let at = |v: u32| positions[v as usize].map(f64::from);
    let mean = |points: &[[f64; 3]]| {
        [0, 1, 2].map(|i| points.iter().map(|p| p[i]).sum::<f64>() / points.len() as f64)
    };
    let face_points: Vec<_> = faces
        .iter()
        .map(|f| mean(&f.iter().map(|&v| at(v)).collect::<Vec<_>>()))
        .collect();
    let mut edges: Vec<([u32; 2], Vec<usize>)> = Vec::new();
    let mut known = BTreeMap::new();
    for (f, face) in faces.iter().enumerate() {
        for i in 0..face.len() {
            let ends = [face[i], face[(i + 1) % face.len()]];
            let key = (ends[0].min(ends[1]), ends[0].max(ends[1]));
            let e = *known.entry(key).or_insert_with(|| {
                edges.push((ends, Vec::new()));
                edges.len() - 1
            });
            edges[e].1.push(f);
        }
    }
    let middle = |e: &[u32; 2]| mean(&e.map(at));
    let mut result = Vec::new();
    for v in 0..positions.len() as u32 {
        let own: Vec<_> = edges.iter().filter(|e| e.0.contains(&v)).collect();
        let boundary: Vec<_> = own.iter().filter(|e| e.1.len() == 1).collect();
        let around: Vec<_> = (0..faces.len())
            .filter(|&f| faces[f].contains(&v))
            .collect();
        let n = around.len() as f64;
        let s = at(v);
        result.push(if around.len() == 1 || around.is_empty() {
            s
        } else if let [a, b] = boundary.as_slice() {
            let [a, b] = [a, b].map(|e| at(if e.0[0] == v { e.0[1] } else { e.0[0] }));
            [0, 1, 2].map(|i| (a[i] + 6.0 * s[i] + b[i]) / 8.0)
        } else if !boundary.is_empty() {
            s
        } else {
            let q = mean(&around.iter().map(|&f| face_points[f]).collect::<Vec<_>>());
            let r = mean(&own.iter().map(|e| middle(&e.0)).collect::<Vec<_>>());
            [0, 1, 2].map(|i| (q[i] + 2.0 * r[i] + s[i] * (n - 3.0)) / n)
        });
    }
    result.extend(&face_points);
    for (ends, around) in &edges {
        result.push(match around.as_slice() {
            [f, g] => mean(&[at(ends[0]), at(ends[1]), face_points[*f], face_points[*g]]),
            _ => middle(ends),
        });
    }
    let (v, f) = (positions.len() as u32, faces.len() as u32);
    let mut quads = Vec::new();
    for (face, corners) in faces.iter().enumerate() {
        let edge = |i: usize| {
            let [a, b] = [corners[i % corners.len()], corners[(i + 1) % corners.len()]];
            v + f + known[&(a.min(b), a.max(b))] as u32
        };
        for i in 0..corners.len() {
            quads.push(vec![
                corners[i],
                edge(i),
                v + face as u32,
                edge(i + corners.len() - 1),
            ]);
        }
    }
    (
        result.into_iter().map(|p| p.map(|c| c as f32)).collect(),
        quads,
    )
}

fn distance(a: Point, b: Point) -> f64 {
    (0..3)
        .map(|i| f64::from(a[i] - b[i]).powi(2))
        .sum::<f64>()
        .sqrt()
}

fn diagonal(points: &[Point]) -> f64 {
    let [low, high] = [f32::min, f32::max].map(|pick| {
        points
            .iter()
            .copied()
            .reduce(|a, b| [0, 1, 2].map(|i| pick(a[i], b[i])))
            .unwrap()
    });
    distance(low, high)
}

/// Whether two meshes are one, but for the numbers of vertices and faces.
fn same(a: &Mesh, b: &Mesh, tolerance: f64) {
    assert_eq!((a.0.len(), a.1.len()), (b.0.len(), b.1.len()));
    let bound = tolerance * diagonal(&b.0);
    let nearest = |p: &Point| {
        let found =
            b.0.iter()
                .enumerate()
                .min_by(|x, y| distance(*p, *x.1).total_cmp(&distance(*p, *y.1)));
        let (i, q) = found.unwrap();
        assert!(
            distance(*p, *q) <= bound,
            "{p:?} is {} away",
            distance(*p, *q)
        );
        i as u32
    };
    let of: Vec<u32> = a.0.iter().map(nearest).collect();
    let key = |face: Vec<u32>| {
        let first = (0..face.len()).min_by_key(|&i| face[i]).unwrap();
        let mut face = face;
        face.rotate_left(first);
        face
    };
    let mut mine: Vec<_> =
        a.1.iter()
            .map(|f| key(f.iter().map(|&v| of[v as usize]).collect()))
            .collect();
    let mut theirs: Vec<_> = b.1.iter().cloned().map(key).collect();
    mine.sort();
    theirs.sort();
    assert!(mine == theirs, "faces differ");
}

#[test]
fn catmull_clark_is_its_definition() {
    for mesh in [cube(), prism(5), prism(3), sheet(6)] {
        let mut by_hand = mesh.clone();
        for levels in 1..=3 {
            by_hand = by_definition(&by_hand);
            let ours = refined(&mesh, &options(Scheme::CatmullClark, levels));
            if levels == 1 {
                let off = ours.0.iter().zip(&by_hand.0).map(|(a, b)| distance(*a, *b));
                assert!(off.fold(0.0, f64::max) <= 1e-6 * diagonal(&mesh.0));
            }
            same(&ours, &by_hand, 1e-6);
        }
    }
}

/// Odd and even steps as the paper has them, one after the other.
fn in_two_steps(mesh: &Mesh, cage: &Cage) -> Mesh {
    let level = Level::of_cage(cage, &SubdivOptions::default()).unwrap();
    let odd = Odd::new(&level);
    let values = odd.evaluate(&level, &mesh.0);
    let positions = [values.vertices, values.carried].concat();
    (
        positions,
        odd.even().iter().map(|quad| quad.to_vec()).collect(),
    )
}

#[test]
fn two_sqrt2_steps_are_one_of_catmull_clark() {
    for mesh in [cube(), prism(7), sheet(5), sheet(6)] {
        let mut stepped = mesh.clone();
        for levels in 1..=3 {
            stepped = in_two_steps(&stepped, &cage(&stepped.1, stepped.0.len()));
            let once = refined(&mesh, &options(Scheme::CatmullClark, levels));
            same(&stepped, &once, 1e-6);
            let sqrt2 = refined(&mesh, &options(Scheme::Sqrt2, 2 * levels));
            assert_eq!(sqrt2, once);
        }
    }
}

#[test]
fn sqrt2_keeps_creases_and_corners() {
    let mesh = cube();
    for sharpness in [0.4, 1.0, 2.5, 10.0] {
        let mut cage = cage(&mesh.1, 8);
        let crease = |vertices| Crease {
            vertices,
            sharpness,
        };
        cage.creases = vec![
            crease([0, 1]),
            crease([1, 3]),
            crease([3, 2]),
            crease([2, 0]),
        ];
        cage.corners = vec![Corner {
            vertex: 7,
            sharpness,
        }];
        let stepped = in_two_steps(&mesh, &cage);
        let refinement = Refinement::new(&cage, &options(Scheme::CatmullClark, 1)).unwrap();
        let once = refinement.evaluate(&mesh.0).unwrap();
        for (a, b) in stepped.0.iter().zip(&once) {
            assert!(distance(*a, *b) < 1e-6);
        }
    }
}

#[test]
fn quads_across_creases_are_cut_along_them() {
    let (positions, faces) = cube();
    let mut control = ControlMesh {
        cage: cage(&faces, 8),
        positions: positions.into_iter().map(glam::Vec3::from).collect(),
        ..ControlMesh::default()
    };
    control.cage.creases = [[2, 3], [3, 7], [7, 6], [6, 2]]
        .map(|vertices| Crease {
            vertices,
            sharpness: 10.0,
        })
        .to_vec();
    let options = options(Scheme::Sqrt2, 3);
    let made = subdivide(&control, &options, SurfaceOptions::default(), &Silent).unwrap();
    let folded = made.mesh.face_count() - made.faces;
    assert_eq!((made.faces, folded), (48, 8), "both halves of four edges");
    // The top is whole: nothing is cut off at its rim, and nothing hangs over.
    let mesh = made.mesh.triangulate();
    let height = |v: u32| mesh.positions[v as usize].y;
    let flat = mesh
        .triangles
        .iter()
        .filter(|t| t.iter().all(|&v| height(v) >= 1.0 - 1e-6));
    assert_eq!((mesh.triangles.len(), flat.count()), (96, 16));
}

#[test]
fn an_odd_step_leaves_a_quad_an_edge() {
    let mesh = sheet(4);
    let level = Level::of_cage(&cage(&mesh.1, mesh.0.len()), &SubdivOptions::default()).unwrap();
    let odd = Odd::new(&level);
    assert_eq!(odd.faces.count(), level.edge_count());
    for f in 0..odd.faces.count() {
        let open = level.edge_corners(odd.carried[f]).len() == 1;
        assert_eq!(odd.faces.corners(f).len(), if open { 3 } else { 4 });
    }
    let (positions, faces) = refined(&mesh, &options(Scheme::Sqrt2, 1));
    assert_eq!(
        (positions.len(), faces.len()),
        (odd.vertices, odd.faces.count())
    );
    let mut sides = BTreeMap::new();
    for face in &faces {
        for i in 0..face.len() {
            let [a, b] = [face[i], face[(i + 1) % face.len()]];
            *sides.entry((a.min(b), a.max(b))).or_insert(0) += 1;
        }
    }
    assert!(
        sides.values().all(|&n| n == 1 || n == 2),
        "no T-vertex, no fin"
    );
}

#[test]
fn faces_grow_by_the_formulas() {
    let count = |mesh: &Mesh, scheme, levels| refined(mesh, &options(scheme, levels)).1.len();
    let quads = cube();
    let triangles: Mesh = (
        quads.0.clone(),
        quads
            .1
            .iter()
            .flat_map(|f| [vec![f[0], f[1], f[2]], vec![f[0], f[2], f[3]]])
            .collect(),
    );
    for levels in 0..=4u32 {
        assert_eq!(
            count(&quads, Scheme::CatmullClark, levels),
            6 * 4usize.pow(levels)
        );
        assert_eq!(count(&quads, Scheme::Sqrt2, levels), 6 * 2usize.pow(levels));
        assert_eq!(
            count(&triangles, Scheme::Sqrt3, levels),
            12 * 3usize.pow(levels)
        );
        assert_eq!(
            count(&triangles, Scheme::Loop, levels),
            12 * 4usize.pow(levels)
        );
    }
}

fn triangulated(mesh: Mesh) -> Mesh {
    let fan = |f: &Vec<u32>| {
        (1..f.len() - 1)
            .map(|i| vec![f[0], f[i], f[i + 1]])
            .collect::<Vec<_>>()
    };
    let faces = mesh.1.iter().flat_map(fan).collect();
    (mesh.0, faces)
}

/// Edges with one face, and V - E + F.
fn shape((positions, faces): &Mesh) -> (usize, i64) {
    let mut sides = BTreeMap::new();
    for face in faces {
        for i in 0..face.len() {
            let [a, b] = [face[i], face[(i + 1) % face.len()]];
            *sides.entry((a.min(b), a.max(b))).or_insert(0) += 1;
        }
    }
    assert!(sides.values().all(|&n| n <= 2));
    let open = sides.values().filter(|&&n| n == 1).count();
    (
        open,
        positions.len() as i64 - sides.len() as i64 + faces.len() as i64,
    )
}

#[test]
fn sqrt3_divides_boundaries_in_three_every_second_step() {
    let mesh = triangulated(sheet(4));
    let (open, euler) = shape(&mesh);
    for (levels, times) in [(1, 1), (2, 3), (3, 3), (4, 9)] {
        let fine = refined(&mesh, &options(Scheme::Sqrt3, levels));
        assert_eq!(shape(&fine), (times * open, euler), "{levels}");
        assert_eq!(fine.1.len(), mesh.1.len() * 3usize.pow(levels));
    }
    let flat: Mesh = (
        mesh.0.iter().map(|p| [p[0], p[1], 2.0]).collect(),
        mesh.1.clone(),
    );
    assert!(
        refined(&flat, &options(Scheme::Sqrt3, 4))
            .0
            .iter()
            .all(|p| (p[2] - 2.0).abs() < 1e-5)
    );
}

#[test]
fn a_sqrt3_step_is_kobbelts() {
    // An octahedron: every vertex has 4 neighbours, alpha is 4/9.
    let positions = vec![
        [1., 0., 0.],
        [-1., 0., 0.],
        [0., 1., 0.],
        [0., -1., 0.],
        [0., 0., 1.],
        [0., 0., -1.],
    ];
    let faces = [
        [0, 2, 4],
        [2, 1, 4],
        [1, 3, 4],
        [3, 0, 4],
        [2, 0, 5],
        [1, 2, 5],
        [3, 1, 5],
        [0, 3, 5],
    ];
    let mesh = (positions, faces.map(|f| f.to_vec()).to_vec());
    let fine = refined(&mesh, &options(Scheme::Sqrt3, 1));
    assert!(distance(fine.0[0], [5.0 / 9.0, 0.0, 0.0]) < 1e-6);
    assert!(distance(fine.0[6], [1.0 / 3.0; 3]) < 1e-6);
    assert_eq!(shape(&fine), (0, 2));
}

#[test]
fn homogeneous_coordinates_follow_the_same_masks() {
    let mesh = sheet(4);
    let refinement = Refinement::new(
        &cage(&mesh.1, mesh.0.len()),
        &options(Scheme::CatmullClark, 2),
    )
    .unwrap();
    let four: Vec<[f32; 4]> = mesh.0.iter().map(|p| [p[0], p[1], p[2], 1.0]).collect();
    let fine = refinement.evaluate(&four).unwrap();
    for (p, q) in refinement.evaluate(&mesh.0).unwrap().iter().zip(fine) {
        assert_eq!(*p, [q[0], q[1], q[2]]);
        assert!((q[3] - 1.0).abs() < 1e-6);
    }
}

#[test]
fn holes_shape_the_surface_but_are_left_out() {
    let mesh = cube();
    let mut cage = cage(&mesh.1, 8);
    let whole = Refinement::new(&cage, &options(Scheme::CatmullClark, 3)).unwrap();
    cage.holes = vec![2];
    let holed = Refinement::new(&cage, &options(Scheme::CatmullClark, 3)).unwrap();
    assert_eq!(
        whole.evaluate(&mesh.0).unwrap(),
        holed.evaluate(&mesh.0).unwrap()
    );
    let holes = (0..holed.faces().count())
        .filter(|&f| holed.is_hole(f))
        .count();
    assert_eq!(holes, 64);
    assert!(
        holed
            .parents()
            .iter()
            .enumerate()
            .all(|(f, &p)| holed.is_hole(f) == (p == 2))
    );
    let odd = Refinement::new(&cage, &options(Scheme::Sqrt2, 1)).unwrap();
    assert_eq!(
        (0..odd.faces().count()).filter(|&f| odd.is_hole(f)).count(),
        0
    );
}

#[test]
fn a_workspace_serves_many_frames() {
    let mesh = prism(6);
    let refinement = Refinement::new(
        &cage(&mesh.1, mesh.0.len()),
        &options(Scheme::CatmullClark, 4),
    )
    .unwrap();
    let (mut workspace, mut to) = (Default::default(), Vec::new());
    for frame in 0..3 {
        let moved: Vec<Point> = mesh
            .0
            .iter()
            .map(|p| [p[0], p[1] * (1.0 + frame as f32), p[2]])
            .collect();
        refinement
            .evaluate_into(&moved, &mut workspace, &mut to)
            .unwrap();
        assert_eq!(to, refinement.evaluate(&moved).unwrap());
    }
}

#[test]
fn bad_cages_are_refused() {
    let check = |cage: &Cage| Refinement::new(cage, &SubdivOptions::default()).map(drop);
    let (_, faces) = cube();
    assert!(matches!(check(&Cage::default()), Err(Error::Empty { .. })));
    assert!(matches!(
        check(&cage(&[vec![0, 1]], 8)),
        Err(Error::DegenerateFace { face: 0 })
    ));
    assert!(matches!(
        check(&cage(&[vec![0]], 8)),
        Err(Error::DegenerateFace { face: 0 })
    ));
    assert!(matches!(
        check(&cage(&faces, 7)),
        Err(Error::IndexOutOfRange { index: 7, .. })
    ));
    let mut bad = cage(&faces, 8);
    bad.offsets.push(99);
    assert!(matches!(check(&bad), Err(Error::LengthMismatch { .. })));
    let mut bad = cage(&faces, 8);
    bad.creases = vec![Crease {
        vertices: [0, 1],
        sharpness: f32::NAN,
    }];
    assert!(matches!(check(&bad), Err(Error::NotFinite { .. })));
    bad.creases = vec![Crease {
        vertices: [0, 99],
        sharpness: 1.0,
    }];
    assert!(matches!(check(&bad), Err(Error::IndexOutOfRange { .. })));
    bad.creases.clear();
    bad.holes = vec![6];
    assert!(matches!(
        check(&bad),
        Err(Error::BadReference { to: 6, .. })
    ));
}

#[test]
fn what_would_be_too_fine_is_refused_with_its_size() {
    let (positions, faces) = cube();
    let refused =
        |scheme, levels| Refinement::new(&cage(&faces, 8), &options(scheme, levels)).unwrap_err();
    let error = refused(Scheme::CatmullClark, 40);
    assert!(matches!(error, Error::TooFine { levels: 40, .. }));
    assert_eq!(
        error.to_string(),
        "40 levels make 7.25e24 faces, more than the 268435456 allowed"
    );
    for scheme in [Scheme::CatmullClark, Scheme::Sqrt2, Scheme::Bilinear] {
        assert_eq!(
            refused(scheme, u32::MAX).to_string(),
            "4294967295 levels make over 1e300 faces, more than the 268435456 allowed"
        );
    }
    let few = SubdivOptions {
        max_faces: 95,
        ..SubdivOptions::default()
    };
    let error = Refinement::new(&cage(&faces, 8), &few).unwrap_err();
    assert_eq!(
        error.to_string(),
        "2 levels make 96 faces, more than the 95 allowed"
    );
    let nan = Refinement::new(&cage(&faces, 8), &SubdivOptions::default()).unwrap();
    let mut bad = positions.clone();
    bad[3][1] = f32::NAN;
    assert!(matches!(
        nan.evaluate(&bad),
        Err(Error::NotFinite { index: 3, .. })
    ));
    assert!(matches!(
        nan.evaluate(&positions[1..]),
        Err(Error::LengthMismatch { found: 7, .. })
    ));
    let quads = Refinement::new(&cage(&faces, 8), &options(Scheme::Loop, 1));
    assert!(matches!(quads, Err(Error::BadOption { .. })));
}

#[test]
fn what_is_no_manifold_has_a_surface() {
    // Three sheets in one edge, a vertex of no face, a face that names a vertex twice.
    let positions = vec![
        [0., 0., 0.],
        [0., 0., 1.],
        [1., 0., 0.],
        [1., 0., 1.],
        [-1., 1., 0.],
        [-1., 1., 1.],
        [-1., -1., 0.],
        [-1., -1., 1.],
        [9., 9., 9.],
    ];
    let mut faces = vec![
        vec![0, 1, 3, 2],
        vec![1, 0, 4, 5],
        vec![0, 1, 7, 6],
        vec![2, 3, 3, 6],
    ];
    for levels in 0..=4 {
        let (fine, quads) = refined(
            &(positions.clone(), faces.clone()),
            &options(Scheme::CatmullClark, levels),
        );
        assert!(fine.iter().flatten().all(|c| c.is_finite()));
        assert_eq!(fine[8], [9.0; 3]);
        assert_eq!(quads.len(), 4 * 4usize.pow(levels));
    }
    faces.truncate(3);
    for scheme in [Scheme::Sqrt2, Scheme::Bilinear] {
        let (fine, _) = refined(&(positions.clone(), faces.clone()), &options(scheme, 3));
        assert!(fine.iter().flatten().all(|c| c.is_finite()));
    }
}

#[test]
fn ten_thousand_corners_and_ten_thousand_neighbours() {
    const N: u32 = 10_000;
    let rim = |i: u32| {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(N);
        [angle.cos() as f32, angle.sin() as f32, 0.0]
    };
    let mut positions: Vec<Point> = (0..N).map(rim).collect();
    let polygon = vec![(0..N).collect::<Vec<u32>>()];
    let (fine, quads) = refined(
        &(positions.clone(), polygon),
        &options(Scheme::CatmullClark, 2),
    );
    assert_eq!(quads.len(), 4 * N as usize);
    assert!(distance(fine[N as usize], [0.0; 3]) < 1e-5, "the middle");
    positions.push([0.0, 0.0, 1.0]);
    let fan: Vec<Vec<u32>> = (0..N).map(|i| vec![i, (i + 1) % N, N]).collect();
    for (scheme, levels) in [
        (Scheme::CatmullClark, 2),
        (Scheme::Loop, 2),
        (Scheme::Sqrt3, 2),
    ] {
        let (fine, _) = refined(&(positions.clone(), fan.clone()), &options(scheme, levels));
        let top = fine[N as usize];
        assert!(
            top[0].abs() < 1e-5 && top[1].abs() < 1e-5 && top[2] > 0.3,
            "{top:?}"
        );
    }
}

fn any_cage() -> impl Strategy<Value = (Mesh, Cage)> {
    let mesh = prop_oneof![
        Just(cube()),
        (3u32..8).prop_map(prism),
        (2u32..6).prop_map(sheet)
    ];
    let tags = prop::collection::vec((any::<prop::sample::Index>(), 0f32..4.0), 0..6);
    (mesh, tags).prop_map(|(mesh, tags)| {
        let mut cage = cage(&mesh.1, mesh.0.len());
        for (i, (at, sharpness)) in tags.into_iter().enumerate() {
            let face = at.get(&mesh.1);
            match i % 2 {
                0 => cage.creases.push(Crease {
                    vertices: [face[0], face[1]],
                    sharpness,
                }),
                _ => cage.corners.push(Corner {
                    vertex: face[2],
                    sharpness,
                }),
            }
        }
        (mesh, cage)
    })
}

fn any_options() -> impl Strategy<Value = SubdivOptions> {
    let scheme = prop_oneof![
        Just(Scheme::CatmullClark),
        Just(Scheme::Sqrt2),
        Just(Scheme::Bilinear)
    ];
    let boundary = prop_oneof![Just(Boundary::EdgeOnly), Just(Boundary::EdgeAndCorner)];
    (scheme, 0u32..5, boundary).prop_map(|(scheme, levels, boundary)| SubdivOptions {
        scheme,
        levels,
        boundary,
        ..SubdivOptions::default()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Moving the cage moves the surface: masks sum to one.
    #[test]
    fn surfaces_move_with_their_cage((mesh, cage) in any_cage(), options in any_options()) {
        let refinement = Refinement::new(&cage, &options).unwrap();
        let map = |p: &Point| [2.0 * p[0] - p[1] + 3.0, p[2] - 1.0, 0.5 * p[0] + p[1] + p[2]];
        let fine = refinement.evaluate(&mesh.0).unwrap();
        let moved: Vec<Point> = mesh.0.iter().map(map).collect();
        for (a, b) in fine.iter().map(map).zip(refinement.evaluate(&moved).unwrap()) {
            prop_assert!(distance(a, b) < 1e-5 * diagonal(&moved));
        }
    }

    /// One thread, two and eight make the same bytes.
    #[test]
    fn threads_do_not_matter((mesh, cage) in any_cage(), options in any_options()) {
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let refinement = Refinement::new(&cage, &options).unwrap();
                let fine = refinement.evaluate(&mesh.0).unwrap();
                (refinement.corners().to_vec(), fine.concat().into_iter().map(f32::to_bits).collect::<Vec<_>>())
            })
        };
        let one = run(1);
        prop_assert!(one == run(2) && one == run(8));
    }

    /// A closed surface stays closed, an open one keeps its boundaries.
    #[test]
    fn there_are_no_cracks((mesh, cage) in any_cage(), options in any_options()) {
        let refinement = Refinement::new(&cage, &options).unwrap();
        let faces: &Faces = refinement.faces();
        let list = (0..faces.count()).map(|f| refinement.corners()[faces.corners(f)].to_vec());
        let fine = (refinement.evaluate(&mesh.0).unwrap(), list.collect());
        let (open, _) = shape(&mesh);
        let halvings = if options.scheme == Scheme::Sqrt2 { options.levels / 2 } else { options.levels };
        prop_assert_eq!(shape(&fine).0, open << halvings);
    }
}
