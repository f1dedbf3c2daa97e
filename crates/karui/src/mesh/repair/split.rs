//! Takes a mesh apart where it is not manifold.

use super::Repaired;
use crate::mesh::PositionIds;
use crate::mesh::diagnose::fans_across;
use crate::mesh::edges::{Corners, EdgeTable, TriangleCorners};
use std::collections::HashMap;

const NONE: u32 = u32::MAX;

impl Repaired {
    /// Corners stay together if manifold edges join their triangles; every
    /// group so formed becomes a vertex. A group is a path or a ring of
    /// triangles around its vertex, so at most its two ends meet at a cut edge:
    /// no edge of the result has more than two triangles.
    pub(super) fn split(&mut self) {
        let triangles = self.ids.triangles(&self.mesh.triangles);
        let corners = TriangleCorners(&triangles);
        let table = EdgeTable::new(&corners, self.ids.count);
        let is_cut = |edge: &[u32]| match *edge {
            [_] => false,
            [c, d] => corners.vertex(c) == corners.vertex(d),
            _ => true,
        };
        self.counts.split_edges = table.iter().filter(|edge| is_cut(edge)).count();
        let mut fans = fans_across(&triangles, &table, |edge| edge.len() == 2 && !is_cut(edge));
        let fan_of_corner: Vec<u32> = (0..corners.len() as u32).map(|c| fans.find(c)).collect();
        self.counts.split_vertices = count_split(&triangles, &fan_of_corner, self.ids.count);
        self.separate(&fan_of_corner);
    }

    /// Gives every fan its own copy of each vertex it uses.
    fn separate(&mut self, fan_of_corner: &[u32]) {
        let before = self.mesh.positions.len() as u32;
        let mut fan_of_vertex = vec![NONE; before as usize];
        let mut sources: Vec<u32> = (0..before).collect();
        let mut copies: HashMap<(u32, u32), u32> = HashMap::new();
        let corners = self.mesh.triangles.as_flattened_mut().iter_mut();
        for (v, &fan) in corners.zip(fan_of_corner) {
            let owner = &mut fan_of_vertex[*v as usize];
            if *owner == NONE {
                *owner = fan;
            } else if *owner != fan {
                *v = *copies.entry((*v, fan)).or_insert_with(|| {
                    sources.push(*v);
                    fan_of_vertex.push(fan);
                    sources.len() as u32 - 1
                });
            }
        }
        self.counts.added_vertices = sources.len() - before as usize;
        if sources.len() > before as usize {
            self.mesh.gather_vertices(&sources);
        }
        self.link(&fan_of_vertex, fan_of_corner.len());
    }

    /// Links the vertices of each fan; unused ones stay by themselves.
    fn link(&mut self, fan_of_vertex: &[u32], corners: usize) {
        let labels = fan_of_vertex.iter().enumerate().map(|(v, &fan)| match fan {
            NONE => corners + v,
            fan => fan as usize,
        });
        self.ids = numbered(labels, corners + fan_of_vertex.len());
    }
}

/// Positions with more than one fan.
fn count_split(triangles: &[[u32; 3]], fan_of_corner: &[u32], positions: usize) -> usize {
    let mut fans_at = vec![0u32; positions];
    for (c, &p) in triangles.as_flattened().iter().enumerate() {
        fans_at[p as usize] += u32::from(fan_of_corner[c] as usize == c);
    }
    fans_at.iter().filter(|&&fans| fans > 1).count()
}

/// Ids numbered by first appearance from any labels below `limit`.
pub(super) fn numbered(labels: impl Iterator<Item = usize>, limit: usize) -> PositionIds {
    let mut id_of_label = vec![NONE; limit];
    let mut ids = PositionIds::default();
    for label in labels {
        let id = &mut id_of_label[label];
        if *id == NONE {
            *id = ids.count as u32;
            ids.count += 1;
        }
        ids.of_vertex.push(*id);
    }
    ids
}
