//! Texture coordinates as a surface of their own.
//!
//! The values of corners make a mesh with the faces of the cage, cut open at seams. It is
//! refined like any other; what OpenSubdiv calls linear interpolation options decides which
//! of its vertices are corners.

use super::cage::INFINITELY_SHARP;
use super::level::{Level, edges_of_faces};
use super::options::{Boundary, FaceVaryingRule, SubdivOptions};
use crate::error::{Error, Result};
use std::collections::HashMap;

/// The mesh of values at the level of the cage.
#[derive(Debug, Clone)]
pub(super) struct Charts {
    pub level: Level,
    /// The value that each vertex of `level` has.
    pub value: Vec<u32>,
    /// The vertex of the surface that each vertex of `level` lies on.
    pub vertex: Vec<u32>,
}

impl Charts {
    /// Cuts `surface` open where the values of corners, by index below `count`, differ.
    pub fn new(
        surface: &Level,
        indices: &[u32],
        count: usize,
        options: &SubdivOptions,
    ) -> Result<Self> {
        check(surface, indices, count)?;
        let mut charts = Self::cut(surface, indices);
        charts.copy_sharpness(surface);
        let seams = Seams::find(surface, &charts.level);
        charts.sharpen(surface, &seams, options);
        charts.level.find_rules();
        Ok(charts)
    }

    fn cut(surface: &Level, indices: &[u32]) -> Self {
        let mut known: HashMap<(u32, u32), u32> = HashMap::new();
        let (mut value, mut vertex) = (Vec::new(), Vec::new());
        let mut corners = Vec::with_capacity(indices.len());
        for (&v, &index) in surface.corners.iter().zip(indices) {
            let id = *known.entry((v, index)).or_insert_with(|| {
                value.push(index);
                vertex.push(v);
                value.len() as u32 - 1
            });
            corners.push(id);
        }
        let found = edges_of_faces(&surface.faces, &corners);
        let mut level = Level {
            vertices: value.len(),
            faces: surface.faces.clone(),
            corners,
            corner_edges: found.corner_edges,
            edge_sharpness: vec![INFINITELY_SHARP; found.edges.len()],
            vertex_sharpness: vec![0.0; value.len()],
            odd_vertices: vertex
                .iter()
                .map(|&v| surface.odd_vertices[v as usize])
                .collect(),
            edges: found.edges,
            odd_edges: found.odd,
            ..surface.clone()
        };
        level.build_rings();
        Self {
            level,
            value,
            vertex,
        }
    }

    /// Seams are sharp for ever, everything else as the surface is.
    fn copy_sharpness(&mut self, surface: &Level) {
        for c in 0..self.level.corners.len() {
            let [e, of_surface] = [&self.level, surface].map(|l| l.corner_edges[c]);
            if self.level.edge_corners(e).len() >= 2 {
                self.level.edge_sharpness[e as usize] = surface.edge_sharpness(of_surface);
            }
        }
        for (to, &v) in self.level.vertex_sharpness.iter_mut().zip(&self.vertex) {
            *to = surface.vertex_sharpness(v);
        }
    }

    fn sharpen(&mut self, surface: &Level, seams: &Seams, options: &SubdivOptions) {
        let rule = options.face_varying;
        self.level.linear_boundaries = rule == FaceVaryingRule::Boundaries;
        let mut of_vertex: Vec<Vec<u32>> = vec![Vec::new(); surface.vertices];
        for (value, &v) in self.vertex.iter().enumerate() {
            of_vertex[v as usize].push(value as u32);
        }
        for (v, values) in of_vertex.iter().enumerate() {
            let open = seams.open[v];
            let sharp = if rule == FaceVaryingRule::Boundaries {
                open || seams.at[v]
            } else if !seams.at[v] {
                let corner = surface.vertex_corners(v as u32).len() == 1;
                let smooth = options.boundary != Boundary::EdgeAndCorner;
                open && corner && smooth && rule != FaceVaryingRule::None
            } else {
                surface.odd_vertices[v] || self.all_sharp(values, open, rule)
            };
            if sharp {
                self.pin(values);
            } else if seams.at[v] {
                self.sharpen_each(values, rule);
            }
        }
        self.level.dependents.sort_unstable();
    }

    fn pin(&mut self, values: &[u32]) {
        for &value in values {
            self.level.vertex_sharpness[value as usize] = INFINITELY_SHARP;
        }
    }

    /// Whether all values at a vertex of a seam are corners because of each other.
    fn all_sharp(&self, values: &[u32], open: bool, rule: FaceVaryingRule) -> bool {
        let plus2 = rule == FaceVaryingRule::CornersPlus2;
        if !plus2 && rule != FaceVaryingRule::CornersPlus1 {
            return false;
        }
        let corner = |&v: &u32| self.level.vertex_corners(v).len() == 1;
        match values.len() {
            1 => plus2 && !open,
            2 => {
                let split = values.iter().any(|&v| self.is_disjoint(v));
                split || (plus2 && values.iter().any(corner))
            }
            _ => true,
        }
    }

    /// Whether a value's faces are several fans, or one that a sharp edge divides for ever.
    fn is_disjoint(&self, value: u32) -> bool {
        let for_ever = |&&s: &&f32| s >= INFINITELY_SHARP;
        self.level.odd_vertices[value as usize]
            || self.level.around(value).iter().filter(for_ever).count() > 2
    }

    fn sharpen_each(&mut self, values: &[u32], rule: FaceVaryingRule) {
        let corners = rule != FaceVaryingRule::None;
        let mut semi_sharp = [0, 0];
        for (i, &value) in values.iter().enumerate() {
            let single = self.level.vertex_corners(value).len() == 1;
            if self.is_disjoint(value) || (single && corners) {
                self.pin(&[value]);
            }
            let around = self.level.around(value);
            let between = around.iter().filter(|&&s| s > 0.0 && s < INFINITELY_SHARP);
            semi_sharp[i.min(1)] = between.count();
        }
        let dependent =
            rule == FaceVaryingRule::CornersPlus1 || rule == FaceVaryingRule::CornersPlus2;
        if let (&[a, b], true) = (values, dependent) {
            let pair = match semi_sharp.map(|count| count > 0) {
                [false, true] => [a, b],
                [true, false] => [b, a],
                _ => return,
            };
            if self.level.vertex_sharpness(pair[0]) < INFINITELY_SHARP {
                self.level.dependents.push(pair);
            }
        }
    }
}

/// Vertices of the surface where something ends.
struct Seams {
    /// An end of an edge at which values differ.
    at: Vec<bool>,
    /// On a boundary of the surface.
    open: Vec<bool>,
}

impl Seams {
    fn find(surface: &Level, charts: &Level) -> Self {
        let mut seams = Self {
            at: vec![false; surface.vertices],
            open: vec![false; surface.vertices],
        };
        for e in 0..surface.edges.len() as u32 {
            let corners = surface.edge_corners(e);
            let chart = |c: &u32| charts.corner_edges[*c as usize];
            let seam = corners.iter().any(|c| chart(c) != chart(&corners[0]));
            for v in surface.edge(e) {
                seams.at[v as usize] |= seam;
                seams.open[v as usize] |= corners.len() < 2;
            }
        }
        seams
    }
}

fn check(surface: &Level, indices: &[u32], count: usize) -> Result<()> {
    if indices.len() != surface.corners.len() {
        return Err(Error::LengthMismatch {
            what: "indices of face-varying values".into(),
            expected: surface.corners.len(),
            found: indices.len(),
        });
    }
    match indices.iter().position(|&i| i as usize >= count) {
        None => Ok(()),
        Some(c) => Err(Error::IndexOutOfRange {
            face: surface.faces.of_corner(c as u32) as usize,
            index: indices[c],
            vertices: count,
        }),
    }
}
