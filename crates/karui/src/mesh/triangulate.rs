//! Polygons into triangles.

use super::{
    Attribute, MaterialRange, PolyMesh, TriMesh, attributes::gathered, ear_clip::ear_clip,
};
use glam::{DVec2, DVec3};

impl PolyMesh {
    /// Cuts every polygon into triangles, n - 2 for n corners; faces of fewer
    /// than three corners vanish. Vertices keep their indices. Face attributes
    /// are repeated for every triangle, and triangles are grouped by material
    /// in the order in which materials first appear.
    ///
    /// Quads are split from their first corner unless that turns a triangle
    /// over; larger polygons are cut in the plane of their Newell normal.
    #[must_use]
    pub fn triangulate(self) -> TriMesh {
        if self.face_materials.is_empty() && self.is_triangles() {
            return TriMesh {
                triangles: self.indices.as_chunks::<3>().0.to_vec(),
                positions: self.positions,
                attributes: self.attributes,
                face_attributes: self.face_attributes,
                ranges: Vec::new(),
            };
        }
        let (mut triangles, mut face_of) = self.cut_faces();
        let ranges = self.group_by_material(&mut triangles, &mut face_of);
        TriMesh {
            face_attributes: spread(&self.face_attributes, &face_of),
            positions: self.positions,
            triangles,
            attributes: self.attributes,
            ranges,
        }
    }

    fn is_triangles(&self) -> bool {
        let in_step = |(f, &offset): (usize, &u32)| offset as usize == 3 * f;
        self.indices.len() == 3 * self.face_count() && self.offsets.iter().enumerate().all(in_step)
    }

    /// All triangles in face order, and the face of each if a face attribute
    /// or material asks for it.
    fn cut_faces(&self) -> (Vec<[u32; 3]>, Vec<u32>) {
        let mut triangles = Vec::with_capacity(self.indices.len() / 3);
        let mut face_of = Vec::new();
        let wanted = !self.face_attributes.is_empty() || !self.face_materials.is_empty();
        for f in 0..self.face_count() {
            let corners = self.offsets[f] as usize..self.offsets[f + 1] as usize;
            self.cut_face(self.indices.get(corners).unwrap_or(&[]), &mut triangles);
            if wanted {
                face_of.resize(triangles.len(), f as u32);
            }
        }
        (triangles, face_of)
    }

    fn cut_face(&self, face: &[u32], triangles: &mut Vec<[u32; 3]>) {
        match *face {
            [] | [_] | [_, _] => {}
            [a, b, c] => triangles.push([a, b, c]),
            [a, b, c, d] => triangles.extend(self.cut_quad([a, b, c, d])),
            [first, ..] => match self.flatten(face) {
                Some(points) if !is_convex(&points) => {
                    ear_clip(&points, |t| triangles.push(t.map(|i| face[i])));
                }
                _ => triangles.extend(face[1..].windows(2).map(|w| [first, w[0], w[1]])),
            },
        }
    }

    fn cut_quad(&self, [a, b, c, d]: [u32; 4]) -> [[u32; 3]; 2] {
        let usual = [[a, b, c], [a, c, d]];
        let Some(points) = self.flatten(&[a, b, c, d]) else {
            return usual;
        };
        let sound = |triangles: [[usize; 3]; 2]| {
            triangles
                .iter()
                .all(|&[i, j, k]| (points[j] - points[i]).perp_dot(points[k] - points[j]) > 0.0)
        };
        if !sound([[0, 1, 2], [0, 2, 3]]) && sound([[1, 2, 3], [1, 3, 0]]) {
            return [[b, c, d], [b, d, a]];
        }
        usual
    }

    /// The corners seen along the axis nearest to the face's normal, counter-
    /// clockwise. `None` if the face has no normal or a corner does not exist.
    ///
    /// Leaving out one coordinate, unlike turning the face, rounds nothing.
    fn flatten(&self, face: &[u32]) -> Option<Vec<DVec2>> {
        let corners: Vec<DVec3> = face
            .iter()
            .map(|&v| self.positions.get(v as usize).map(|p| p.as_dvec3()))
            .collect::<Option<_>>()?;
        let normal = newell_normal(&corners);
        let size = normal.abs();
        let axis = size.max_position();
        if !(size[axis] > 0.0 && size[axis].is_finite()) {
            return None;
        }
        let [mut u, mut v] = [(axis + 1) % 3, (axis + 2) % 3];
        if normal[axis] < 0.0 {
            std::mem::swap(&mut u, &mut v);
        }
        Some(corners.iter().map(|p| DVec2::new(p[u], p[v])).collect())
    }

    /// Sorts triangles by material, stably, and returns the ranges.
    fn group_by_material(
        &self,
        triangles: &mut Vec<[u32; 3]>,
        face_of: &mut Vec<u32>,
    ) -> Vec<MaterialRange> {
        if self.face_materials.is_empty() {
            return Vec::new();
        }
        let material_of = |&f: &u32| self.face_materials.get(f as usize).copied().flatten();
        let mut ranges: Vec<MaterialRange> = Vec::new();
        let mut range_of_material = std::collections::HashMap::new();
        let mut range_of: Vec<u32> = Vec::with_capacity(face_of.len());
        for material in face_of.iter().map(material_of) {
            let r = *range_of_material.entry(material).or_insert_with(|| {
                ranges.push(MaterialRange {
                    material,
                    ..MaterialRange::default()
                });
                ranges.len() - 1
            });
            ranges[r].count += 1;
            range_of.push(r as u32);
        }
        let mut first = 0;
        for range in &mut ranges {
            range.first = first;
            first += range.count;
        }
        if ranges.len() > 1 {
            let order = stable_order(&range_of);
            *triangles = gathered(triangles, &order);
            *face_of = gathered(face_of, &order);
        }
        ranges
    }
}

fn stable_order(keys: &[u32]) -> Vec<u32> {
    let mut order: Vec<u32> = (0..keys.len() as u32).collect();
    order.sort_by_key(|&i| keys[i as usize]);
    order
}

fn spread(attributes: &[Attribute], face_of: &[u32]) -> Vec<Attribute> {
    attributes.iter().map(|a| a.gathered(face_of)).collect()
}

/// Normal of a polygon that need not be plane, as long as twice its area
/// (Newell; Sutherland, Sproull and Schumacker 1974).
fn newell_normal(corners: &[DVec3]) -> DVec3 {
    let Some(&origin) = corners.first() else {
        return DVec3::ZERO;
    };
    let fan = corners.windows(2);
    fan.map(|w| (w[0] - origin).cross(w[1] - origin)).sum()
}

/// Whether all corners turn left and the outline goes round once.
fn is_convex(points: &[DVec2]) -> bool {
    let n = points.len();
    let edge = |i: usize| points[(i + 1) % n] - points[i % n];
    let turns_left = (0..n).all(|i| edge(i).perp_dot(edge(i + 1)) > 0.0);
    let upwards = |i: usize| edge(i).y > 0.0;
    let reversals = (0..n).filter(|&i| upwards(i) != upwards(i + 1)).count();
    turns_left && reversals <= 2
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::AttributeValues;
    use glam::Vec3;
    use proptest::prelude::*;

    fn polygon(points: &[[f32; 3]]) -> PolyMesh {
        let mut mesh = PolyMesh {
            positions: points.iter().map(|&p| p.into()).collect(),
            ..PolyMesh::default()
        };
        mesh.push_face(&(0..points.len() as u32).collect::<Vec<_>>());
        mesh
    }

    fn normals(mesh: &TriMesh) -> Vec<DVec3> {
        (0..mesh.triangles.len())
            .map(|t| crate::geom::normal_times_two_areas(mesh.corners(t)))
            .collect()
    }

    #[test]
    fn arrow_quad_is_split_inside() {
        let arrow = polygon(&[[0., 0., 0.], [2., 2., 0.], [0., 1., 0.], [-2., 2., 0.]]);
        for turn in 0..4 {
            let mut turned = arrow.clone();
            turned.indices.rotate_left(turn);
            let mesh = turned.triangulate();
            assert!(normals(&mesh).iter().all(|n| n.z > 0.0), "turned by {turn}");
        }
        let square = polygon(&[[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]]);
        assert_eq!(square.triangulate().triangles, [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn concave_polygons_facing_any_way() {
        let l = [[0., 0.], [2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.]];
        for axis in 0..3 {
            let place = |[u, v]: [f32; 2]| {
                let mut p = [7.0; 3];
                (p[(axis + 1) % 3], p[(axis + 2) % 3]) = (u, v);
                p
            };
            let mut flat = polygon(&l.map(place));
            for sign in [1.0, -1.0] {
                let mesh = flat.clone().triangulate();
                let areas: Vec<f64> = normals(&mesh).iter().map(|n| sign * n[axis]).collect();
                assert!(areas.iter().all(|&a| a > 0.0), "{areas:?}");
                assert_eq!(areas.iter().sum::<f64>(), 6.0);
                flat.indices.reverse();
            }
        }
    }

    #[test]
    fn face_data_follow_their_triangles() {
        let mut mesh = polygon(&[[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]]);
        mesh.push_face(&[0, 1, 2]);
        mesh.push_face(&[0, 1]);
        mesh.push_face(&[3, 2, 1, 0]);
        mesh.face_materials = vec![Some(4), None, Some(9), Some(4)];
        mesh.face_attributes = vec![Attribute {
            name: "id".into(),
            components: 1,
            values: AttributeValues::U8(vec![10, 11, 12, 13]),
        }];
        let mesh = mesh.triangulate();
        let ids = AttributeValues::U8(vec![10, 10, 13, 13, 11]);
        assert_eq!(mesh.face_attributes[0].values, ids);
        assert_eq!(mesh.triangles[4], [0, 1, 2]);
        let ranges: Vec<_> = mesh
            .ranges
            .iter()
            .map(|r| (r.first, r.count, r.material))
            .collect();
        assert_eq!(ranges, [(0, 4, Some(4)), (4, 1, None)]);
    }

    #[test]
    fn damaged_input_is_survived() {
        let mut mesh = polygon(&[[f32::NAN; 3], [0.; 3], [1.; 3], [2.; 3], [f32::MAX; 3]]);
        mesh.push_face(&[0, 1, 2, 99]);
        mesh.push_face(&[0, 99, 2, 3, 98]);
        mesh.offsets.push(5);
        mesh.offsets.push(5000);
        assert_eq!(mesh.triangulate().triangles.len(), 3 + 2 + 3);
    }

    proptest! {
        /// Star-shaped outlines in a random plane: all triangles face the same
        /// way and their areas add up to the polygon's.
        #[test]
        fn covers_star_shaped_polygons(
            radii in prop::collection::vec(0.2f32..1.0, 5..40),
            normal in prop::array::uniform3(-1.0f32..1.0),
        ) {
            let normal = Vec3::from(normal);
            prop_assume!(normal.length() > 0.1);
            let (u, v) = normal.normalize().any_orthonormal_pair();
            let step = std::f32::consts::TAU / radii.len() as f32;
            let points: Vec<[f32; 3]> = radii
                .iter()
                .enumerate()
                .map(|(i, r)| {
                    let angle = i as f32 * step;
                    (*r * (angle.cos() * u + angle.sin() * v)).to_array()
                })
                .collect();
            let mesh = polygon(&points).triangulate();
            prop_assert_eq!(mesh.triangles.len(), points.len() - 2);
            let normal = normal.normalize().as_dvec3();
            let areas: Vec<f64> = normals(&mesh).iter().map(|n| n.dot(normal)).collect();
            let corners: Vec<DVec3> = mesh.positions.iter().map(|p| p.as_dvec3()).collect();
            let whole = newell_normal(&corners).dot(normal);
            prop_assert!(areas.iter().all(|&a| a > -1e-6));
            prop_assert!((areas.iter().sum::<f64>() - whole).abs() < 1e-5);
        }
    }
}
