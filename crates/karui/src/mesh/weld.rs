//! Joins vertices that are the same, or nearly.

use super::attributes::{AttributeValues, Attributes};
use super::{PositionIds, TriMesh};
use crate::error::{Error, Result};
use glam::Vec3;
use rayon::prelude::*;
use smallvec::SmallVec;
use std::cmp::Ordering;
use std::collections::HashMap;

/// Which vertices [`weld`] joins.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct WeldOptions {
    /// Largest distance in model units at which two vertices are joined, at
    /// least 0. Default 0: equal positions only.
    pub tolerance: f32,
    /// Join vertices even if their attributes differ, which loses UV seams and
    /// sharp normals. Default `false`: all attributes must be equal.
    pub ignore_attributes: bool,
}

/// The result of [`weld`].
#[derive(Debug, Clone, PartialEq)]
pub struct Welded {
    /// The mesh with fewer vertices. Its triangles are as many as before; some
    /// may now be degenerate (see [`repair`](super::repair)).
    pub mesh: TriMesh,
    /// New index of every former vertex.
    pub new_vertex: Vec<u32>,
}

/// Joins vertices of `mesh`. Of vertices joined the first one stays, with its
/// position and attributes. A vertex joins the nearest vertex kept so far
/// within the tolerance, so chains of near vertices do not collapse into one
/// and welding twice is welding once.
///
/// # Errors
/// What [`TriMesh::validate`] finds wrong; [`Error::BadOption`] for a
/// tolerance that is negative or not finite.
pub fn weld(mesh: &TriMesh, options: &WeldOptions) -> Result<Welded> {
    mesh.validate()?;
    if !(0.0..f32::INFINITY).contains(&options.tolerance) {
        return Err(Error::BadOption {
            option: "tolerance",
            found: options.tolerance.to_string(),
            expected: "at least 0 and finite",
        });
    }
    let first = match options {
        WeldOptions { tolerance, .. } if *tolerance > 0.0 => first_near(mesh, options),
        _ => first_equal(mesh, options.ignore_attributes),
    };
    Ok(join(mesh, &first))
}

/// For every vertex the first one with equal position (and attributes).
fn first_equal(mesh: &TriMesh, ignore_attributes: bool) -> Vec<u32> {
    let (starts, mut vertices) = PositionIds::of_mesh(mesh).groups();
    let mut first: Vec<u32> = vec![0; vertices.len()];
    for range in starts.windows(2) {
        let group = &mut vertices[range[0] as usize..range[1] as usize];
        if ignore_attributes {
            group.iter().for_each(|&v| first[v as usize] = group[0]);
            continue;
        }
        group.sort_unstable_by(|&a, &b| mesh.attributes.compare(a, b).then(a.cmp(&b)));
        name_runs(group, &mesh.attributes, &mut first);
    }
    first
}

/// Names every vertex of `sorted` after the first of its run of equals.
fn name_runs(sorted: &[u32], attributes: &Attributes, first: &mut [u32]) {
    for run in sorted.chunk_by(|&a, &b| attributes.compare(a, b).is_eq()) {
        run.iter().for_each(|&v| first[v as usize] = run[0]);
    }
}

/// For every vertex the kept one that it joins, by a hashed grid whose cells
/// are as wide as the tolerance.
fn first_near(mesh: &TriMesh, options: &WeldOptions) -> Vec<u32> {
    let class = attribute_classes(mesh, options.ignore_attributes);
    let tolerance = f64::from(options.tolerance);
    let mut kept: HashMap<([i64; 3], u32), SmallVec<[u32; 4]>> = HashMap::new();
    let place = |v: u32| mesh.positions[v as usize].as_dvec3();
    let mut joined = Vec::with_capacity(class.len());
    for (v, &class) in (0u32..).zip(&class) {
        let p = place(v);
        let cell = (p / tolerance).floor().to_array().map(|x| x as i64);
        let candidates = around(cell).filter_map(|c| kept.get(&(c, class))).flatten();
        let nearest = candidates
            .map(|&k| (place(k).distance_squared(p), k))
            .filter(|&(squared, _)| squared <= tolerance * tolerance)
            .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        joined.push(nearest.map_or(v, |(_, k)| k));
        if nearest.is_none() {
            kept.entry((cell, class)).or_default().push(v);
        }
    }
    joined
}

fn around([x, y, z]: [i64; 3]) -> impl Iterator<Item = [i64; 3]> {
    let cells = (0..27).map(|i| [i / 9, i / 3 % 3, i % 3].map(|d| d - 1));
    cells.map(move |[i, j, k]| {
        [
            x.saturating_add(i),
            y.saturating_add(j),
            z.saturating_add(k),
        ]
    })
}

/// For every vertex the first one with equal attributes.
fn attribute_classes(mesh: &TriMesh, ignore_attributes: bool) -> Vec<u32> {
    let mut class = vec![0; mesh.positions.len()];
    if !ignore_attributes {
        let mut order: Vec<u32> = (0..class.len() as u32).collect();
        order.par_sort_unstable_by(|&a, &b| mesh.attributes.compare(a, b).then(a.cmp(&b)));
        name_runs(&order, &mesh.attributes, &mut class);
    }
    class
}

/// Keeps the vertices that are their own `first`.
fn join(mesh: &TriMesh, first: &[u32]) -> Welded {
    let mut kept = Vec::new();
    let mut new_vertex: Vec<u32> = Vec::with_capacity(first.len());
    for (v, &f) in first.iter().enumerate() {
        if f as usize == v {
            new_vertex.push(kept.len() as u32);
            kept.push(f);
        } else {
            // The first of a run comes before it, so it has its new index.
            new_vertex.push(new_vertex[f as usize]);
        }
    }
    let renamed = |t: &[u32; 3]| t.map(|v| new_vertex[v as usize]);
    let mesh = TriMesh {
        positions: kept.iter().map(|&v| mesh.positions[v as usize]).collect(),
        triangles: mesh.triangles.iter().map(renamed).collect(),
        attributes: mesh.attributes.gathered(&kept),
        face_attributes: mesh.face_attributes.clone(),
        ranges: mesh.ranges.clone(),
    };
    Welded { mesh, new_vertex }
}

impl Attributes {
    /// A total order of vertices by all their attributes; equal bits are
    /// equal, and so are 0 and -0.
    fn compare(&self, a: u32, b: u32) -> Ordering {
        let (a, b) = (a as usize, b as usize);
        let of_skins = |set: &Vec<super::SkinWeights>| {
            let by_weight = floats(&set[a].weights, &set[b].weights);
            set[a].joints.cmp(&set[b].joints).then(by_weight)
        };
        let vectors = |v: &Option<Vec<Vec3>>| match v {
            Some(v) => floats(&v[a].to_array(), &v[b].to_array()),
            None => Ordering::Equal,
        };
        let mut order = vectors(&self.normals);
        order = order.then_with(|| match &self.tangents {
            Some(t) => floats(&t[a].to_array(), &t[b].to_array()),
            None => Ordering::Equal,
        });
        for set in &self.uvs {
            order = order.then_with(|| floats(&set[a].to_array(), &set[b].to_array()));
        }
        for set in &self.colors {
            order = order.then_with(|| floats(&set[a].to_array(), &set[b].to_array()));
        }
        for set in &self.skins {
            order = order.then_with(|| of_skins(set));
        }
        for m in &self.morphs {
            for part in [&m.positions, &m.normals, &m.tangents] {
                order = order.then_with(|| vectors(part));
            }
        }
        for custom in &self.custom {
            order = order.then_with(|| custom.values.compare(custom.components, a, b));
        }
        order
    }
}

impl AttributeValues {
    fn compare(&self, components: usize, a: usize, b: usize) -> Ordering {
        let (a, b) = (a * components, b * components);
        let mut each = 0..components;
        macro_rules! first_difference {
            ($v:expr, $key:expr) => {
                each.map(|i| $key($v[a + i]).cmp(&$key($v[b + i])))
                    .find(|o| o.is_ne())
            };
        }
        let difference = match self {
            Self::F32(v) => each.find_map(|i| unequal(floats(&[v[a + i]], &[v[b + i]]))),
            Self::F64(v) => first_difference!(v, |x: f64| (x + 0.0).to_bits()),
            Self::I8(v) => first_difference!(v, |x: i8| x),
            Self::U8(v) => first_difference!(v, |x: u8| x),
            Self::I16(v) => first_difference!(v, |x: i16| x),
            Self::U16(v) => first_difference!(v, |x: u16| x),
            Self::I32(v) => first_difference!(v, |x: i32| x),
            Self::U32(v) => first_difference!(v, |x: u32| x),
        };
        difference.unwrap_or(Ordering::Equal)
    }
}

fn unequal(order: Ordering) -> Option<Ordering> {
    order.is_ne().then_some(order)
}

fn floats(a: &[f32], b: &[f32]) -> Ordering {
    let bits = |x: &f32| (x + 0.0).to_bits();
    a.iter().map(bits).cmp(b.iter().map(bits))
}
