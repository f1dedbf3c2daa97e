//! Polygons cut at planes across the axes. Two triangles with a common edge cut it at the
//! same points to the bit: a point depends on the ends of what is cut, not on their order.

use super::super::block::{Part, place};
use crate::mesh::{Attribute, AttributeValues};

/// Cuts all triangles at planes across each axis, which ascend; columns are interpolated.
pub(super) fn cut(part: &mut Part, planes: &[Vec<f32>; 3]) {
    let triangles = std::mem::take(&mut part.triangles);
    for triangle in triangles {
        let mut polygons = vec![triangle.to_vec()];
        for (axis, planes) in planes.iter().enumerate() {
            let whole = std::mem::take(&mut polygons);
            for polygon in whole {
                sliced(part, polygon, axis, planes, &mut polygons);
            }
        }
        for polygon in &polygons {
            let fan = polygon[1..].windows(2);
            let fan = fan.map(|pair| [polygon[0], pair[0], pair[1]]);
            part.triangles.extend(fan);
        }
    }
}

/// Cuts one polygon at all planes across an axis that it crosses.
fn sliced(
    part: &mut Part,
    mut polygon: Vec<u32>,
    axis: usize,
    planes: &[f32],
    pieces: &mut Vec<Vec<u32>>,
) {
    let ends = |part: &Part, polygon: &[u32]| {
        let at = polygon.iter().map(|&v| part.positions[v as usize][axis]);
        at.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], x| {
            [low.min(x), high.max(x)]
        })
    };
    let [low, high] = ends(part, &polygon);
    let first = planes.partition_point(|&plane| plane <= low);
    for &plane in planes[first..].iter().take_while(|&&plane| plane < high) {
        let [below, above] = halves(part, &polygon, axis, plane);
        pieces.push(below);
        polygon = above;
    }
    pieces.push(polygon);
}

/// What of a polygon is below a plane that it crosses, and what is above.
fn halves(part: &mut Part, polygon: &[u32], axis: usize, plane: f32) -> [Vec<u32>; 2] {
    let mut halves = [Vec::new(), Vec::new()];
    for (i, &v) in polygon.iter().enumerate() {
        let next = polygon[(i + 1) % polygon.len()];
        let at = |v: u32| part.positions[v as usize][axis];
        let [here, there] = [at(v), at(next)];
        if here <= plane {
            halves[0].push(v);
        }
        if here >= plane {
            halves[1].push(v);
        }
        if here.min(there) < plane && plane < here.max(there) {
            let new = between(part, v, next, axis, plane);
            halves.iter_mut().for_each(|half| half.push(new));
        }
    }
    halves
}

/// Adds the point of an edge that lies on a plane.
fn between(part: &mut Part, a: u32, b: u32, axis: usize, plane: f32) -> u32 {
    let [mut a, mut b] = [a as usize, b as usize];
    if place(part.positions[a]) > place(part.positions[b]) {
        std::mem::swap(&mut a, &mut b);
    }
    let [from, to] = [a, b].map(|v| part.positions[v].as_dvec3());
    let share = (f64::from(plane) - from[axis]) / (to[axis] - from[axis]);
    let mut position = (from + (to - from) * share).as_vec3();
    position[axis] = plane;
    part.positions.push(position);
    part.rim.push(false);
    let columns = part.columns.iter_mut();
    columns.for_each(|column| interpolate(column, [a, b], share));
    part.positions.len() as u32 - 1
}

/// Adds what lies between two values; whole numbers are those of the nearer end. Normals
/// keep length 1.
fn interpolate(column: &mut Attribute, [a, b]: [usize; 2], share: f64) {
    let width = column.components;
    let nearer = if share < 0.5 { a } else { b } * width;
    macro_rules! values {
        ($values:expr, $($whole:ident),*) => {
            match $values {
                AttributeValues::F32(v) => for i in 0..width {
                    let [from, to] = [v[a * width + i], v[b * width + i]].map(f64::from);
                    v.push((from + (to - from) * share) as f32);
                },
                AttributeValues::F64(v) => for i in 0..width {
                    let [from, to] = [v[a * width + i], v[b * width + i]];
                    v.push(from + (to - from) * share);
                },
                $(AttributeValues::$whole(v) => v.extend_from_within(nearer..nearer + width),)*
            }
        };
    }
    values!(&mut column.values, I8, U8, I16, U16, I32, U32);
    if let ("normal", AttributeValues::F32(values)) = (column.name.as_str(), &mut column.values) {
        let new = values.len() - width;
        let squares = values[new..].iter().map(|x| x * x).sum::<f32>();
        let length = squares.sqrt();
        if length > 0.0 {
            values[new..].iter_mut().for_each(|x| *x /= length);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use proptest::prelude::*;

    fn area(part: &Part) -> f64 {
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| part.positions[v as usize].as_dvec3());
            (b - a).cross(c - a).length() / 2.0
        };
        part.triangles.iter().map(area).sum()
    }

    fn corners() -> impl Strategy<Value = Vec<Vec3>> {
        let coordinate = prop_oneof![0f32..8.0, (0u8..9).prop_map(f32::from)];
        prop::collection::vec(prop::array::uniform3(coordinate).prop_map(Vec3::from), 4)
    }

    proptest! {
        /// Two triangles on both sides of an edge.
        #[test]
        fn pieces_lie_between_planes_and_meet(positions in corners()) {
            let mut part = Part {
                rim: vec![false; 4],
                columns: vec![Attribute {
                    name: "x".into(),
                    components: 1,
                    values: AttributeValues::F32(positions.iter().map(|p| p.x).collect()),
                }],
                positions,
                triangles: vec![[0, 1, 2], [2, 1, 3]],
            };
            let before = area(&part);
            let planes: Vec<f32> = (1u8..8).map(f32::from).collect();
            cut(&mut part, &[planes.clone(), planes.clone(), planes]);
            prop_assert!((area(&part) - before).abs() < 1e-4 * (1.0 + before));
            for triangle in &part.triangles {
                let corners = triangle.map(|v| part.positions[v as usize]);
                for axis in 0..3 {
                    let low = corners.iter().map(|p| p[axis]).fold(9.0, f32::min);
                    prop_assert!(corners.iter().all(|p| p[axis] <= low.floor() + 1.0));
                }
            }
            let AttributeValues::F32(x) = &part.columns[0].values else { panic!() };
            for (p, x) in part.positions.iter().zip(x) {
                prop_assert!((p.x - x).abs() < 1e-4);
            }
            // On the common edge both have the same places: as many begin there as end.
            let fans = super::super::super::fans::Fans::of(
                &crate::mesh::PositionIds::of(&part.positions), &part.triangles, |_| true);
            let ids = crate::mesh::PositionIds::of(&part.positions);
            let [a, b] = [1, 2].map(|v: usize| part.positions[v].as_dvec3());
            for (v, p) in part.positions.iter().enumerate().skip(4) {
                let p = p.as_dvec3();
                let off = (p - a).cross(b - a).length() / (b - a).length().max(1e-9);
                let others = [0, 3].map(|v: usize| part.positions[v].as_dvec3());
                let is_clear = others.iter().all(|o| {
                    (*o - a).cross(b - a).length() / (b - a).length().max(1e-9) > 0.5
                });
                if off < 1e-7 && is_clear {
                    prop_assert!(!fans.is_open(ids.of_vertex[v]), "{:?}", p);
                }
            }
        }
    }
}
