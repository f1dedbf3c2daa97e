//! The whole surface between two cuts into blocks.

use super::block::{Block, DEAD, Kind};
use super::paint::{Blend, Paint, Values};
use super::planes::Planes;
use super::record::{Collapse, Notes};
use glam::{Vec3, Vec4};
use std::borrow::Cow;

/// Points and triangles, and what the points stand for.
#[derive(Debug, Default)]
pub(crate) struct Level<'a> {
    /// Places of the points, to be scaled.
    pub position: Cow<'a, [Vec3]>,
    /// By which power of two.
    pub scale: f32,
    pub triangle: Cow<'a, [[u32; 3]]>,
    /// Whether the triangles at every point are known to be one fan, open or
    /// closed.
    pub fans: bool,
    /// Triangle of the input that every triangle has come from; empty if it is
    /// the one of the same number.
    pub source: Vec<u32>,
    /// Point of the input that every point has come from; empty at the input.
    pub origin: Vec<u32>,
    /// Sum of the input's area normals, and of areas, of every point; empty at
    /// the input.
    pub facing: Vec<Vec4>,
    /// The input's planes, of every point; empty at the input.
    pub memory: Vec<Planes>,
    /// Empty if all are 1.
    pub weight: Vec<f32>,
    /// Empty if none is.
    pub locked: Vec<bool>,
    /// Wedges of every triangle; their ids stay the same throughout. Empty if
    /// there are neither attributes nor materials.
    pub wedge: Vec<[u32; 3]>,
    /// Material range of every triangle, as `wedge`.
    pub range: Vec<u32>,
    /// Attributes of all wedges.
    pub values: Values,
    /// Wedges that have become mixtures, in this order.
    pub log: Vec<Blend>,
    /// Collapses since the input, if asked for; points are the input's.
    pub record: Vec<Collapse>,
    /// Triangles of the input.
    pub input: usize,
    /// Wedges there were at the start.
    pub wedges: usize,
    /// Wedges that those added since have been copied from.
    pub copies: Vec<u32>,
}

impl<'a> Level<'a> {
    /// Place of a point, in scaled units.
    #[inline(always)]
    pub fn place(&self, p: u32) -> Vec3 {
        self.position[p as usize] * self.scale
    }

    /// Triangle of the input that this one has come from.
    pub fn source_of(&self, t: u32) -> u32 {
        self.source.get(t as usize).copied().unwrap_or(t)
    }

    /// Whether nothing has been simplified yet.
    pub fn is_input(&self) -> bool {
        self.origin.is_empty()
    }

    /// Whether the point must stay.
    pub fn is_locked(&self, p: u32) -> bool {
        self.locked.get(p as usize).copied().unwrap_or(false)
    }

    /// Weights of these points; empty if all are 1.
    pub fn weights_of(&self, points: &[u32]) -> Vec<f32> {
        if self.weight.is_empty() {
            return Vec::new();
        }
        points.iter().map(|&p| self.weight[p as usize]).collect()
    }

    /// Wedges of these triangles; none if there are no wedges.
    pub(super) fn paint_of(&self, triangles: &[u32], points: usize) -> Option<Box<Paint>> {
        if self.wedge.is_empty() {
            return None;
        }
        let wedge = triangles.iter().map(|&t| self.wedge[t as usize]).collect();
        let range = triangles.iter().map(|&t| self.range[t as usize]).collect();
        Some(Box::new(Paint::new(&self.values, wedge, range, points)))
    }

    /// Puts the blocks back together: their points and triangles, in order.
    pub(super) fn join(mut self, blocks: &[Block]) -> Self {
        let mut joint = Joint::of(&self);
        joint.add(&mut self, blocks);
        joint.done(self)
    }

    fn take_wedges(&mut self, block: &Block, paint: &Paint) {
        for (t, wedges) in paint.wedge.iter().enumerate() {
            if block.triangle[t][0] != DEAD {
                self.wedge.push(wedges.map(|w| paint.global[w as usize]));
                self.range.push(paint.range[t]);
            }
        }
    }

    /// Changes the values of wedges that have become mixtures. Those that
    /// several blocks share have not changed in any.
    fn repaint(&mut self, paint: &Paint) {
        for blend in &paint.log {
            let local = paint.global.partition_point(|&w| w < blend.wedge);
            let at = blend.wedge as usize * paint.width;
            self.values.value[at..at + paint.width].copy_from_slice(paint.of(local as u32));
        }
        self.log.extend(&paint.log);
    }
}

/// A level while it is put together, block by block.
pub(super) struct Joint {
    next: Level<'static>,
    position: Vec<Vec3>,
    triangle: Vec<[u32; 3]>,
    /// New ids of the points that several blocks share.
    shared: Vec<u32>,
    notes: Notes,
}

impl Joint {
    pub fn of(from: &Level<'_>) -> Self {
        Self {
            next: Level::default(),
            position: Vec::new(),
            triangle: Vec::new(),
            shared: vec![DEAD; from.position.len()],
            notes: Notes::default(),
        }
    }

    /// Makes room for `times` as much as there is, so that lists of hundreds of
    /// megabytes are not moved while they grow.
    pub fn reserve(&mut self, times: f64) {
        let more = |len: usize| (len as f64 * times) as usize;
        self.triangle.reserve(more(self.triangle.len()));
        self.next.source.reserve(more(self.next.source.len()));
        self.position.reserve(more(self.position.len()));
        self.next.origin.reserve(more(self.next.origin.len()));
        self.next.facing.reserve(more(self.next.facing.len()));
        self.next.memory.reserve(more(self.next.memory.len()));
    }

    /// Adds what is left of these blocks, which come from that level.
    pub fn add(&mut self, from: &mut Level<'_>, blocks: &[Block]) {
        for block in blocks {
            self.notes.add(block, from);
            let local = self.take_points(from, block);
            self.take_triangles(block, &local);
            if let Some(paint) = &block.paint {
                self.next.take_wedges(block, paint);
                from.repaint(paint);
            }
        }
    }

    /// The new level, after all blocks have been added.
    pub fn done<'a>(self, from: Level<'_>) -> Level<'a> {
        Level {
            position: self.position.into(),
            scale: 1.0,
            triangle: self.triangle.into(),
            fans: from.fans,
            values: from.values,
            log: from.log,
            record: self.notes.after(from.record),
            input: from.input,
            wedges: from.wedges,
            copies: from.copies,
            ..self.next
        }
    }

    fn take_triangles(&mut self, block: &Block, local: &[u32]) {
        for (t, points) in block.triangle.iter().enumerate() {
            if points[0] != DEAD {
                self.triangle.push(points.map(|p| local[p as usize]));
                self.next.source.push(block.source[t]);
            }
        }
    }

    /// Adds the block's points and returns their new ids.
    fn take_points(&mut self, from: &Level<'_>, block: &Block) -> Vec<u32> {
        let mut local = vec![DEAD; block.global.len()];
        for (p, &global) in block.global.iter().enumerate() {
            if block.kind[p] == Kind::Gone || block.span[p].len == 0 {
                continue;
            }
            let is_shared = block.kind[p] == Kind::Shared;
            let known = self.shared[global as usize];
            if is_shared && known != DEAD {
                local[p] = known;
                self.next.facing[known as usize] += block.facing[p];
                let memory = &mut self.next.memory[known as usize];
                *memory = memory.plus(&block.memory[p]);
                continue;
            }
            local[p] = self.position.len() as u32;
            self.take_point(from, block, p);
            if is_shared {
                self.shared[global as usize] = local[p];
                self.recall(from, global);
            }
        }
        local
    }

    fn take_point(&mut self, from: &Level<'_>, block: &Block, p: usize) {
        let global = block.global[p];
        self.position.push(block.position[p]);
        self.next.facing.push(block.facing[p]);
        self.next.memory.push(block.memory[p]);
        self.next.weight.extend(block.weight.get(p));
        if !from.locked.is_empty() {
            self.next.locked.push(from.is_locked(global));
        }
        let origin = from.origin.get(global as usize);
        self.next.origin.push(origin.copied().unwrap_or(global));
    }

    /// Adds to the last point what it stood for before it was shared out.
    fn recall(&mut self, from: &Level<'_>, global: u32) {
        if from.is_input() {
            return;
        }
        if let (Some(facing), Some(memory)) =
            (self.next.facing.last_mut(), self.next.memory.last_mut())
        {
            *facing += from.facing[global as usize];
            *memory = memory.plus(&from.memory[global as usize]);
        }
    }
}
