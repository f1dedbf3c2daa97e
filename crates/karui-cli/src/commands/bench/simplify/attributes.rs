//! How far normals and texture coordinates are off where two surfaces are
//! nearest.

use anyhow::Result;
use glam::{DVec2, DVec3};
use karui::TriMesh;
use karui::mesh::{Components, PositionIds};
use karui::spatial::{Bvh, Hit};
use rayon::prelude::*;
use serde::Serialize;
use std::collections::BTreeMap;

/// Mean deviations over both surfaces, of the worse direction; `None` if
/// either surface lacks the attribute.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct AttributeErrors {
    /// Between interpolated normals, degrees.
    pub normal: Option<f64>,
    /// Between texture coordinates, in their own unit, where both points lie
    /// in the same chart.
    pub uv: Option<f64>,
}

impl AttributeErrors {
    pub const NONE: Self = Self {
        normal: None,
        uv: None,
    };
}

/// Compares the attributes of a mesh and a simplified one at so many points
/// of either surface, spread over the area and each compared with the nearest
/// point of the other surface. A seam of the texture bounds a chart; a chart
/// of the simplified mesh belongs to the one of the original that most of its
/// area is nearest to.
pub fn attribute_errors(
    [(original, bvh), (simplified, simplified_bvh)]: [(&TriMesh, &Bvh); 2],
    samples: u64,
) -> Result<AttributeErrors> {
    if original.attributes.normals.is_none() && original.attributes.uvs.is_empty() {
        return Ok(AttributeErrors::NONE);
    }
    let charts = charts(original)?;
    let theirs = matched_charts(simplified, bvh, &charts)?;
    let a = Side {
        mesh: original,
        bvh,
        charts: &charts,
    };
    let b = Side {
        mesh: simplified,
        bvh: simplified_bvh,
        charts: &theirs,
    };
    let [there, back] = [a.compare(&b, samples), b.compare(&a, samples)];
    let worse = |pick: fn(&Sums) -> Option<f64>| Some(pick(&there)?.max(pick(&back)?));
    Ok(AttributeErrors {
        normal: worse(|s| s.normal.mean()).filter(|_| has_normals(original, simplified)),
        uv: worse(|s| s.uv.mean()),
    })
}

fn has_normals(a: &TriMesh, b: &TriMesh) -> bool {
    a.attributes.normals.is_some() && b.attributes.normals.is_some()
}

/// Chart of every triangle: what hangs together by common vertices.
fn charts(mesh: &TriMesh) -> Result<Vec<u32>> {
    let apart = PositionIds::distinct(mesh.positions.len());
    Ok(Components::of(mesh, &apart)?.of_triangle)
}

/// Chart of the original that every triangle of `simplified` belongs to.
fn matched_charts(simplified: &TriMesh, original: &Bvh, of_original: &[u32]) -> Result<Vec<u32>> {
    let own = charts(simplified)?;
    let nearest: Vec<u32> = (0..simplified.triangles.len())
        .into_par_iter()
        .map(|t| {
            let [a, b, c] = simplified.corners(t);
            of_original[original.closest((a + b + c) / 3.0).triangle as usize]
        })
        .collect();
    let mut votes: BTreeMap<(u32, u32), f64> = BTreeMap::new();
    for (t, (&chart, &vote)) in own.iter().zip(&nearest).enumerate() {
        *votes.entry((chart, vote)).or_default() += area(simplified, t);
    }
    let mut best: BTreeMap<u32, (u32, f64)> = BTreeMap::new();
    for (&(chart, vote), &weight) in &votes {
        let leader = best.entry(chart).or_insert((vote, weight));
        if weight > leader.1 {
            *leader = (vote, weight);
        }
    }
    Ok(own.iter().map(|chart| best[chart].0).collect())
}

fn area(mesh: &TriMesh, t: usize) -> f64 {
    let [a, b, c] = mesh.corners(t);
    (b - a).cross(c - a).length() / 2.0
}

#[derive(Clone, Copy)]
struct Side<'a> {
    mesh: &'a TriMesh,
    bvh: &'a Bvh,
    charts: &'a [u32],
}

/// A sum and what it is of.
#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    total: f64,
    count: u64,
}

impl Sum {
    fn add(&mut self, value: Option<f64>) {
        if let Some(value) = value {
            self.total += value;
            self.count += 1;
        }
    }

    fn mean(&self) -> Option<f64> {
        (self.count > 0).then(|| self.total / self.count as f64)
    }
}

#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    normal: Sum,
    uv: Sum,
}

impl Sums {
    fn merge(mut self, other: &Self) -> Self {
        for (to, from) in [(&mut self.normal, other.normal), (&mut self.uv, other.uv)] {
            to.total += from.total;
            to.count += from.count;
        }
        self
    }
}

/// Points a task takes, in a row so that one hit helps to find the next.
const CHUNK: u64 = 4096;

impl Side<'_> {
    /// Mean deviations at points of this side from the nearest of the other.
    fn compare(&self, other: &Side<'_>, samples: u64) -> Sums {
        let areas = self.running_areas();
        let chunks = (0..samples.div_ceil(CHUNK)).into_par_iter();
        let sums: Vec<Sums> = chunks
            .map(|c| {
                self.compare_chunk(
                    other,
                    &areas,
                    c * CHUNK..samples.min((c + 1) * CHUNK),
                    samples,
                )
            })
            .collect();
        sums.iter().fold(Sums::default(), Sums::merge)
    }

    /// Areas of all triangles in the hierarchy's order before each and of all.
    fn running_areas(&self) -> Vec<f64> {
        let mut sum = 0.0;
        let order = self.bvh.order().iter();
        let sums = order.map(|&t| {
            sum += area(self.mesh, t as usize);
            sum
        });
        std::iter::once(0.0).chain(sums).collect()
    }

    fn compare_chunk(
        &self,
        other: &Side<'_>,
        areas: &[f64],
        numbers: std::ops::Range<u64>,
        samples: u64,
    ) -> Sums {
        let mut sums = Sums::default();
        let mut near: Option<Hit> = None;
        let total = areas.last().copied().unwrap_or(0.0);
        for k in numbers {
            let place = (k as f64 + 0.5) / samples as f64 * total;
            let slot = areas
                .partition_point(|&a| a <= place)
                .clamp(1, areas.len() - 1)
                - 1;
            let at = Point {
                triangle: self.bvh.order()[slot] as usize,
                barycentric: barycentric(k),
            };
            let point = at.mixed(self.mesh.corners(at.triangle));
            let hit = match &near {
                Some(near) => other.bvh.closest_near(point, near),
                None => other.bvh.closest(point),
            };
            let there = Point {
                triangle: hit.triangle as usize,
                barycentric: hit.barycentric,
            };
            near = Some(hit);
            sums.normal
                .add(angle(at.normal(self.mesh), there.normal(other.mesh)));
            if self.charts[at.triangle] == other.charts[there.triangle] {
                let uvs = at.uv(self.mesh).zip(there.uv(other.mesh));
                sums.uv.add(uvs.map(|(a, b)| a.distance(b)));
            }
        }
        sums
    }
}

/// Point number `k` of the R2 sequence (Roberts 2018), folded onto the triangle.
fn barycentric(k: u64) -> [f64; 3] {
    let [mut x, mut y] =
        [0.754_877_666_246_693, 0.569_840_290_998_053].map(|step| (k as f64 * step).fract());
    if x + y > 1.0 {
        (x, y) = (1.0 - x, 1.0 - y);
    }
    [1.0 - x - y, x, y]
}

#[derive(Clone, Copy)]
struct Point {
    triangle: usize,
    barycentric: [f64; 3],
}

impl Point {
    fn mixed(&self, [a, b, c]: [DVec3; 3]) -> DVec3 {
        let [u, v, w] = self.barycentric;
        a * u + b * v + c * w
    }

    fn normal(&self, mesh: &TriMesh) -> Option<DVec3> {
        let normals = mesh.attributes.normals.as_ref()?;
        let corners = mesh.triangles[self.triangle].map(|v| normals[v as usize].as_dvec3());
        self.mixed(corners).try_normalize()
    }

    fn uv(&self, mesh: &TriMesh) -> Option<DVec2> {
        let uvs = mesh.attributes.uvs.first()?;
        let corners = mesh.triangles[self.triangle].map(|v| uvs[v as usize].as_dvec2().extend(0.0));
        Some(self.mixed(corners).truncate())
    }
}

/// Degrees between two unit vectors.
fn angle(a: Option<DVec3>, b: Option<DVec3>) -> Option<f64> {
    let (a, b) = (a?, b?);
    Some(a.cross(b).length().atan2(a.dot(b)).to_degrees())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Vec2, Vec3};
    use karui::mesh::shapes;

    fn compared(a: &TriMesh, b: &TriMesh) -> AttributeErrors {
        let bvhs = [a, b].map(|m| Bvh::build(m).unwrap());
        attribute_errors([(a, &bvhs[0]), (b, &bvhs[1])], 20_000).unwrap()
    }

    #[test]
    fn nothing_is_off_from_itself() {
        let sphere = shapes::textured_sphere(16, 24);
        let found = compared(&sphere, &sphere);
        assert!(found.normal.unwrap() < 1e-5, "{found:?}");
        assert!(found.uv.unwrap() < 1e-6, "{found:?}");
        assert_eq!(
            compared(&shapes::icosphere(1), &shapes::icosphere(1)).uv,
            None
        );
    }

    #[test]
    fn a_slipped_texture_and_leaning_normals_are_seen() {
        let mut flat = shapes::grid(5, 5);
        flat.attributes.normals = Some(vec![Vec3::Y; flat.positions.len()]);
        let mut off = flat.clone();
        let lean = Vec3::new(0.6, 0.8, 0.0);
        off.attributes.normals = Some(vec![lean; flat.positions.len()]);
        off.attributes.uvs[0]
            .iter_mut()
            .for_each(|uv| *uv += Vec2::new(0.03, 0.04));
        let found = compared(&flat, &off);
        assert!((found.uv.unwrap() - 0.05).abs() < 1e-6, "{found:?}");
        assert!((found.normal.unwrap() - 0.8f64.acos().to_degrees()).abs() < 1e-4);
    }

    /// Two halves of a square with textures far apart: points that fall on
    /// the other half are not compared.
    #[test]
    fn charts_are_compared_with_themselves() {
        let split = |middle: f32| {
            let p = |x, z| Vec3::new(x, 0.0, z);
            let (left, right) = ([p(0., 0.), p(middle, 0.), p(middle, 1.), p(0., 1.)], {
                [p(middle, 0.), p(1., 0.), p(1., 1.), p(middle, 1.)]
            });
            let quad = |n: u32| [[n, n + 2, n + 1], [n, n + 3, n + 2]];
            let mut mesh = TriMesh::new([left, right].concat(), [quad(0), quad(4)].concat());
            let uv = |(i, p): (usize, &Vec3)| Vec2::new(p.x + if i < 4 { 0.0 } else { 5.0 }, p.z);
            mesh.attributes.uvs = vec![mesh.positions.iter().enumerate().map(uv).collect()];
            mesh
        };
        let found = compared(&split(0.5), &split(0.6));
        assert!(found.uv.unwrap() < 1e-6, "{found:?}");
    }
}
