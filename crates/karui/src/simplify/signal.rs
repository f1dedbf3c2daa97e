//! Attributes as one scaled vector a wedge, in model units, so that their
//! error adds to the geometric one.
//!
//! H. Hoppe: New Quadric Metric for Simplifying Meshes with Appearance
//! Attributes, IEEE Visualization 1999. Over every triangle an attribute is a
//! linear function of space; the error of a new vertex is the area-weighted
//! squared difference to these functions.

use super::blend::Mix;
use super::options::AttributeWeights;
use crate::mesh::{Attributes, SkinWeights, TriMesh};
use glam::{DVec2, DVec3};

/// Scaled attributes of all wedges, `width` numbers each, and skin weights.
#[derive(Debug, Clone, Default)]
pub(crate) struct Signal {
    /// Numbers a wedge.
    pub width: usize,
    pub values: Vec<f32>,
    /// Where in a wedge's numbers its UV sets are.
    pub uvs: Vec<usize>,
    skin_scale: f64,
}

/// A normal that is off by 1 (60 degrees) weighs as much as this share of the
/// diagonal.
const NORMAL: f64 = 0.01;
/// A colour or skin weight that is off by 1, as a share of the diagonal.
const COLOR: f64 = 0.02;
/// A texture that has slipped by some distance weighs this share of it.
const UV: f64 = 1.0;

impl Signal {
    /// Scales the attributes of `mesh`, seen at its vertices `source_vertex`;
    /// normals only if they are wanted.
    pub fn of(
        mesh: &TriMesh,
        source_vertex: &[u32],
        weights: &AttributeWeights,
        with_normals: bool,
    ) -> Self {
        let diagonal = mesh.bounds().diagonal();
        let mut columns: Vec<(f64, Column<'_>)> = Vec::new();
        let attributes = &mesh.attributes;
        if let Some(normals) = attributes.normals.as_deref().filter(|_| with_normals) {
            columns.push((
                weights.normal * NORMAL * diagonal,
                Column::three(move |v| normals[v].to_array()),
            ));
        }
        for set in &attributes.uvs {
            let scale = weights.uv * UV * uv_scale(mesh, set);
            columns.push((scale, Column::two(move |v| set[v].to_array())));
        }
        for set in &attributes.colors {
            let scale = weights.color * COLOR * diagonal;
            columns.push((scale, Column::four(move |v| set[v].to_array())));
        }
        columns.retain(|(scale, _)| *scale > 0.0 && scale.is_finite());
        let starts = columns.iter().scan(0, |at, (_, c)| {
            *at += c.width;
            Some((*at - c.width, c.width))
        });
        let uvs = starts.filter(|s| s.1 == 2).map(|s| s.0).collect();
        let skinned = if attributes.skins.is_empty() {
            0.0
        } else {
            1.0
        };
        Self {
            width: columns.iter().map(|(_, c)| c.width).sum(),
            values: pack(&columns, source_vertex),
            uvs,
            skin_scale: skinned * weights.skin * COLOR * diagonal,
        }
    }

    /// Adds the skin weights to the numbers of every wedge: four sums with
    /// signs that depend on the joint, whose squared differences are those of
    /// the weights in the mean (Johnson & Lindenstrauss 1984).
    pub fn add_skins(&mut self, attributes: &Attributes, source_vertex: &[u32]) {
        if self.skin_scale == 0.0 {
            return;
        }
        let width = self.width + 4;
        let mut values = Vec::with_capacity(source_vertex.len() * width);
        for (wedge, &v) in source_vertex.iter().enumerate() {
            let at = wedge * self.width;
            values.extend_from_slice(&self.values[at..at + self.width]);
            let mut sums = [0.0f32; 4];
            for skin in attributes.skins.iter().map(|set| set[v as usize]) {
                for (&joint, &weight) in skin.joints.iter().zip(&skin.weights) {
                    let signs = u32::from(joint).wrapping_add(1).wrapping_mul(0x9e37_79b9);
                    for (i, sum) in sums.iter_mut().enumerate() {
                        let sign = if signs >> (28 + i) & 1 == 0 {
                            0.5
                        } else {
                            -0.5
                        };
                        *sum += sign * weight * self.skin_scale as f32;
                    }
                }
            }
            values.extend(sums);
        }
        (self.width, self.values) = (width, values);
    }

    /// Whether there is nothing to compare.
    pub fn is_empty(&self) -> bool {
        self.width == 0 && self.skin_scale == 0.0
    }

    /// Sets `wedge` to the mixture.
    pub fn blend(&mut self, wedge: u32, mix: &Mix) {
        for i in 0..self.width {
            let value = |k: usize| self.at(mix.sources[k], i) * mix.shares[k];
            self.values[wedge as usize * self.width + i] = (value(0) + value(1) + value(2)) as f32;
        }
    }

    /// Squared difference, model units squared, between two mixtures.
    pub fn squared_difference(&self, attributes: &Attributes, one: &Mix, other: &Mix) -> f64 {
        let mut sum = 0.0;
        for i in 0..self.width {
            let value = |m: &Mix| {
                (0..3)
                    .map(|k| self.at(m.sources[k], i) * m.shares[k])
                    .sum::<f64>()
            };
            let difference = value(one) - value(other);
            sum += difference * difference;
        }
        if self.skin_scale > 0.0 {
            sum += self.skin_scale * self.skin_scale * skin_difference(attributes, one, other);
        }
        sum
    }

    fn at(&self, wedge: u32, i: usize) -> f64 {
        f64::from(self.values[wedge as usize * self.width + i])
    }
}

type Reader<'a> = Box<dyn Fn(usize, &mut Vec<f32>, f32) + 'a>;

struct Column<'a> {
    width: usize,
    read: Reader<'a>,
}

impl<'a> Column<'a> {
    fn of<const N: usize>(value: impl Fn(usize) -> [f32; N] + 'a) -> Self {
        Self {
            width: N,
            read: Box::new(move |v, out, scale| out.extend(value(v).map(|x| x * scale))),
        }
    }

    fn two(value: impl Fn(usize) -> [f32; 2] + 'a) -> Self {
        Self::of(value)
    }

    fn three(value: impl Fn(usize) -> [f32; 3] + 'a) -> Self {
        Self::of(value)
    }

    fn four(value: impl Fn(usize) -> [f32; 4] + 'a) -> Self {
        Self::of(value)
    }
}

fn pack(columns: &[(f64, Column<'_>)], source_vertex: &[u32]) -> Vec<f32> {
    let mut values = Vec::new();
    if columns.is_empty() {
        return values;
    }
    for &v in source_vertex {
        for (scale, column) in columns {
            (column.read)(v as usize, &mut values, *scale as f32);
        }
    }
    values
}

/// Model units a unit of texture space spans, by the ratio of the areas.
fn uv_scale(mesh: &TriMesh, uvs: &[glam::Vec2]) -> f64 {
    let (mut surface, mut texture) = (0.0, 0.0);
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let [a, b, c]: [DVec2; 3] = triangle.map(|v| uvs[v as usize].as_dvec2());
        surface += crate::geom::area(mesh.corners(t));
        texture += 0.5 * (b - a).perp_dot(c - a).abs();
    }
    if texture > 0.0 {
        (surface / texture).sqrt()
    } else {
        0.0
    }
}

fn skin_difference(attributes: &Attributes, one: &Mix, other: &Mix) -> f64 {
    let mut influences = smallvec::SmallVec::<[(u16, f64); 24]>::new();
    for set in &attributes.skins {
        for (mix, sign) in [(one, 1.0), (other, -1.0)] {
            for k in 0..3 {
                gather(
                    &mut influences,
                    &set[mix.sources[k] as usize],
                    sign * mix.shares[k],
                );
            }
        }
    }
    influences.iter().map(|(_, w)| w * w).sum()
}

fn gather(found: &mut smallvec::SmallVec<[(u16, f64); 24]>, skin: &SkinWeights, share: f64) {
    for (&joint, &weight) in skin.joints.iter().zip(&skin.weights) {
        let part = f64::from(weight) * share;
        if part == 0.0 {
            continue;
        }
        match found.iter_mut().find(|i| i.0 == joint) {
            Some(known) => known.1 += part,
            None => found.push((joint, part)),
        }
    }
}

/// Shares of a triangle's corners at the foot of `x` on its plane; outside the
/// triangle they go beyond `0..=1`, but no further than a few triangles, past
/// which a sliver's gradient says nothing.
pub(crate) fn extrapolated(x: DVec3, [a, b, c]: [DVec3; 3]) -> [f64; 3] {
    let (e1, e2, d) = (b - a, c - a, x - a);
    let n = e1.cross(e2);
    let nn = n.length_squared();
    if nn <= 1e-12 * e1.length_squared().max(e2.length_squared()).powi(2) {
        return [1.0 / 3.0; 3];
    }
    let limited = |v: f64| v.clamp(-3.0, 4.0);
    let u = limited(d.cross(e2).dot(n) / nn);
    let v = limited(e1.cross(d).dot(n) / nn);
    [1.0 - u - v, u, v]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;

    #[test]
    fn extrapolation_is_linear_in_the_plane() {
        let t = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let shares = extrapolated(DVec3::new(2.0, -1.0, 9.0), t);
        assert_eq!(shares, [0.0, 2.0, -1.0]);
        assert_eq!(
            extrapolated(DVec3::X, [DVec3::ZERO, DVec3::X, DVec3::X]),
            [1.0 / 3.0; 3]
        );
    }

    #[test]
    fn uv_scale_of_a_unit_grid_is_its_size() {
        let grid = shapes::grid(4, 4);
        let size = grid.bounds().size().max_element();
        let scale = uv_scale(&grid, &grid.attributes.uvs[0]);
        assert!(
            (scale / f64::from(size) - 1.0).abs() < 1e-6,
            "{scale} {size}"
        );
    }

    #[test]
    fn equal_mixtures_do_not_differ() {
        let mesh = shapes::loaded_sphere(6, 8);
        let all: Vec<u32> = (0..mesh.positions.len() as u32).collect();
        let signal = Signal::of(&mesh, &all, &AttributeWeights::default(), true);
        let one = Mix {
            sources: [0, 5, 9],
            shares: [0.2, 0.3, 0.5],
        };
        let other = Mix {
            sources: [1, 5, 9],
            shares: [0.2, 0.3, 0.5],
        };
        assert!(!signal.is_empty());
        assert!(signal.squared_difference(&mesh.attributes, &one, &one) < 1e-30);
        assert!(signal.squared_difference(&mesh.attributes, &one, &other) > 0.0);
    }
}
