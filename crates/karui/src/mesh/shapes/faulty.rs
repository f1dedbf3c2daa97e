//! Shapes with one known fault each.

use super::{super::TriMesh, closed_cube, icosphere, uv_sphere};
use glam::Vec3;

/// `pages` triangles (at least 1) around one edge, all entering it in the same
/// direction: with three or more the edge is non-manifold.
#[must_use]
pub fn book(pages: u32) -> TriMesh {
    let pages = pages.max(1);
    let mut positions = vec![Vec3::ZERO, Vec3::Y];
    for page in 0..pages {
        let (sin, cos) = super::turn(page, pages);
        positions.push(Vec3::new(cos as f32, 0.5, sin as f32));
    }
    let triangles = (0..pages).map(|page| [0, 1, 2 + page]).collect();
    TriMesh::new(positions, triangles)
}

/// Two triangles that meet in one vertex only: a non-manifold vertex.
#[must_use]
pub fn bow_tie() -> TriMesh {
    let positions = [(0, 0), (1, -1), (1, 1), (-1, 1), (-1, -1)];
    let positions = positions.map(|(x, y)| Vec3::new(x as f32, y as f32, 0.0));
    TriMesh::new(positions.to_vec(), vec![[0, 1, 2], [0, 3, 4]])
}

/// One large triangle above two small ones; the vertex between the two lies
/// inside the large one's edge without being joined to it.
#[must_use]
pub fn t_junction() -> TriMesh {
    let positions = [(0, 0), (2, 0), (1, 2), (1, 0), (1, -2)];
    let positions = positions.map(|(x, y)| Vec3::new(x as f32, y as f32, 0.0));
    TriMesh::new(positions.to_vec(), vec![[0, 1, 2], [0, 4, 3], [3, 4, 1]])
}

/// A flat strip of `count` triangles (at least 2), each about a million times
/// longer than wide, that ends in one triangle of exactly no area and one with
/// a repeated vertex.
#[must_use]
pub fn slivers(count: u32) -> TriMesh {
    let count = count.max(2);
    // A power of two, so that the last three positions are exactly in line.
    let width = 2f32.powi(-20);
    let row = |i: u32| Vec3::new((i % 2) as f32, width * i as f32, 0.0);
    let mut positions: Vec<Vec3> = (0..count + 2).map(row).collect();
    let mut triangles: Vec<[u32; 3]> = (0..count).map(|i| strip_triangle(i, i + 2)).collect();
    positions.push(row(count + 1) * 2.0 - row(count));
    triangles.push(strip_triangle(count, count + 2));
    triangles.push([count, count + 1, count + 1]);
    TriMesh::new(positions, triangles)
}

fn strip_triangle(i: u32, tip: u32) -> [u32; 3] {
    if i.is_multiple_of(2) {
        [i, i + 1, tip]
    } else {
        [i + 1, i, tip]
    }
}

/// A unit sphere with its first triangle repeated, once as it is and once
/// turned over.
#[must_use]
pub fn duplicate_faces() -> TriMesh {
    let mut mesh = icosphere(1);
    let [a, b, c] = mesh.triangles[0];
    mesh.triangles.extend([[b, c, a], [c, b, a]]);
    mesh
}

/// A closed unit sphere with its first triangle turned over: three
/// inconsistent edges.
#[must_use]
pub fn flipped_face() -> TriMesh {
    let mut mesh = uv_sphere(6, 8);
    mesh.triangles[0].swap(1, 2);
    mesh
}

/// A unit cube with a cube of half its size standing on top; they touch
/// without sharing a position: two components.
#[must_use]
pub fn touching_parts() -> TriMesh {
    let mut upper = closed_cube(1);
    for p in &mut upper.positions {
        *p = *p * 0.5 + Vec3::Y * 0.75;
    }
    joined(closed_cube(1), &upper)
}

/// Two unit cubes that share one edge, which four faces meet in.
#[must_use]
pub fn cubes_sharing_edge() -> TriMesh {
    let mut second = closed_cube(1);
    for p in &mut second.positions {
        *p += Vec3::new(1.0, 1.0, 0.0);
    }
    joined(closed_cube(1), &second)
}

fn joined(mut mesh: TriMesh, other: &TriMesh) -> TriMesh {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(&other.positions);
    let shifted = other.triangles.iter().map(|t| t.map(|v| v + first));
    mesh.triangles.extend(shifted);
    mesh
}
