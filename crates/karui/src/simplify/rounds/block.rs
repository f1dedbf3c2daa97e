//! A piece of the surface small enough for a core's cache, with everything
//! that its collapses read and change.

use super::fan::Fan;
use super::level::Level;
use super::paint::Paint;
use super::partition::Cut;
use super::planes::Planes;
use super::record::Note;
use super::star::Star;
use super::sym3::Sym3;
use crate::simplify::refused::Refused;
use glam::{Vec3, Vec4};
use std::hint::select_unpredictable;
use std::ops::Range;

/// First corner of a triangle that is gone.
pub(super) const DEAD: u32 = u32::MAX;
/// Weight of the lines that hold a border in place, relative to the planes.
const LINE_WEIGHT: f32 = 2.0;

/// How a point may move.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    /// Anywhere: it may vanish into any neighbour.
    Interior,
    /// Along the border, or along edges of more than two triangles.
    Line,
    /// Along a seam of attributes or materials.
    Seam,
    /// Nowhere, though neighbours may vanish into it: lines end or cross here.
    Fixed,
    /// Nowhere, by the caller's wish.
    Locked,
    /// Nowhere, for another block has triangles there.
    Shared,
    /// It has vanished.
    Gone,
}

/// Where a point's triangles are in the list.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Span {
    pub start: u32,
    pub len: u32,
}

/// What the blocks of one simplification have in common.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Rules {
    /// Least cosine between a triangle's normals before and after a collapse.
    pub least_turn: f32,
    /// Whether open borders hold their place.
    pub hold_borders: bool,
    /// Whether open borders may not be touched.
    pub lock_borders: bool,
    /// Whether new vertices lie on old ones.
    pub subset: bool,
    /// What a squared way along the surface counts beside one off it.
    pub even: f32,
    /// Largest error, scaled units.
    pub max_error: f32,
    /// Whether collapses are written down.
    pub log: bool,
    /// Whether parts may vanish, holes close and handles be cut.
    pub ease: bool,
}

/// A block. Points and triangles are numbered from 0 within it.
#[derive(Debug)]
pub(super) struct Block {
    pub rules: Rules,
    pub position: Vec<Vec3>,
    pub triangle: Vec<[u32; 3]>,
    /// Unit normal times the root of the area, and that root, of every triangle.
    pub root: Vec<Vec4>,
    pub star: Vec<Star>,
    pub span: Vec<Span>,
    pub list: Vec<u32>,
    pub kind: Vec<Kind>,
    /// Sum of the input's area normals that the point stands for, and of areas.
    pub facing: Vec<Vec4>,
    /// The input's planes that the point stands for.
    pub memory: Vec<Planes>,
    /// Empty if all are 1.
    pub weight: Vec<f32>,
    /// None if there are neither attributes nor materials.
    pub paint: Option<Box<Paint>>,
    /// Scratch set of points, by stamp.
    pub mark: Vec<u32>,
    pub stamp: u32,
    /// The round in which the point's star changed last.
    pub changed: Vec<u32>,
    /// The round in which the point took part in a collapse last.
    pub touched: Vec<u32>,
    pub round: u32,
    /// Price of every half-edge as of its last look.
    pub price: Vec<[f32; 3]>,
    /// Scratch of one look: half-edges to be priced, and their ends.
    pub plain: Vec<(u32, u32, u32)>,
    /// Scratch of one collapse.
    pub fan: Fan,
    pub alive: usize,
    /// Area of all triangles when the block was made.
    pub area: f32,
    /// Squared side up to which triangles are small: how they turn is not
    /// doubted.
    pub small: f32,
    pub collapses: usize,
    /// The collapses, if asked for.
    pub notes: Vec<Note>,
    pub error: f32,
    /// Whether a collapse was unclear and there was no guard to ask.
    pub asks: bool,
    /// What was refused in the last round.
    pub refused: Refused,
    /// Ids of the points in the level.
    pub global: Vec<u32>,
    /// Triangles of the input that the triangles have come from.
    pub source: Vec<u32>,
}

/// Unit normal times the root of the area, and that root, of a triangle whose
/// doubled area normal is `cross`, of length `length`; zero if it has none.
#[inline(always)]
pub(super) fn root_of(cross: Vec3, length: f32) -> Vec4 {
    if length > 0.0 {
        cross.extend(length) * (0.5 / length).sqrt()
    } else {
        Vec4::ZERO
    }
}

/// The two points of a triangle after and before `p`, one of its points.
#[inline(always)]
pub(super) fn others([a, b, c]: [u32; 3], p: u32) -> (u32, u32) {
    // Any of the three is as likely: a guess would often be wrong.
    let (first, second) = (a == p, b == p);
    let next = select_unpredictable(second, c, a);
    let last = select_unpredictable(second, a, b);
    (
        select_unpredictable(first, b, next),
        select_unpredictable(first, c, last),
    )
}

pub(super) fn range(span: Span) -> Range<usize> {
    span.start as usize..(span.start + span.len) as usize
}

impl Block {
    /// Takes a block out of the level; once only.
    pub fn new(level: &Level, cut: &Cut, origin: Vec<u32>, rules: Rules) -> Self {
        let (triangle, global) = cut.numbered(level, &origin);
        let points = global.len();
        let kind = |p: &u32| match (cut.is_shared(*p), level.is_locked(*p)) {
            (true, _) => Kind::Shared,
            (_, true) => Kind::Locked,
            _ => Kind::Interior,
        };
        let mut block = Self {
            position: global.iter().map(|&p| level.place(p)).collect(),
            kind: global.iter().map(kind).collect(),
            weight: level.weights_of(&global),
            paint: level.paint_of(&origin, points),
            root: Vec::with_capacity(triangle.len()),
            star: vec![Star::default(); points],
            span: vec![Span::default(); points],
            list: Vec::new(),
            facing: vec![Vec4::ZERO; points],
            memory: vec![Planes::default(); points],
            mark: vec![0; points],
            stamp: 0,
            changed: vec![0; points],
            touched: vec![0; points],
            round: 0,
            price: vec![[f32::INFINITY; 3]; triangle.len()],
            plain: Vec::new(),
            fan: Fan::default(),
            alive: triangle.len(),
            area: 0.0,
            small: 0.0,
            collapses: 0,
            notes: Vec::new(),
            error: 0.0,
            asks: false,
            refused: Default::default(),
            rules,
            triangle,
            global,
            source: origin.iter().map(|&t| level.source_of(t)).collect(),
        };
        let gaps = block.link();
        block.sum_stars();
        for (star, &place) in block.star.iter_mut().zip(&block.position) {
            star.set_place(place);
        }
        block.remember(level);
        let known = level.fans && block.paint.is_none();
        block.classify(level.is_input(), known.then_some(&gaps));
        block.paint_all();
        block
    }

    fn paint_all(&mut self) {
        let Some(mut paint) = self.paint.take() else {
            return;
        };
        for t in 0..self.triangle.len() {
            let wedges = paint.wedge[t];
            paint.add(wedges, self.corners(t as u32), [true; 3], 1.0);
        }
        self.paint = Some(paint);
        for p in 0..self.global.len() as u32 {
            self.vary(p);
        }
    }

    /// Lists the triangles of every point. Returns the differences between
    /// the ends of their fans: 0 for a closed one.
    fn link(&mut self) -> Vec<u32> {
        let mut gap = vec![0u32; self.span.len()];
        for &[a, b, c] in &self.triangle {
            for (p, next, last) in [(a, b, c), (b, c, a), (c, a, b)] {
                self.span[p as usize].len += 1;
                let sum = &mut gap[p as usize];
                *sum = sum.wrapping_add(next).wrapping_sub(last);
            }
        }
        let mut at = 0;
        for span in &mut self.span {
            span.start = at;
            at += std::mem::take(&mut span.len);
        }
        self.list = vec![0; at as usize];
        for (t, points) in self.triangle.iter().enumerate() {
            for &p in points {
                let span = &mut self.span[p as usize];
                self.list[(span.start + span.len) as usize] = t as u32;
                span.len += 1;
            }
        }
        gap
    }

    fn sum_stars(&mut self) {
        for points in &self.triangle {
            let [a, b, c] = points.map(|p| self.position[p as usize]);
            let cross = (b - a).cross(c - a);
            let root = root_of(cross, cross.length());
            self.root.push(root);
            self.area += root.w * root.w;
            let part = Star::of(root);
            for &p in points {
                self.star[p as usize] += part;
            }
        }
    }

    /// What the points stand for: of a level that has simplified already, its
    /// own points bring it along; those shared leave it with the level.
    fn remember(&mut self, level: &Level) {
        if level.is_input() {
            for (points, &root) in self.triangle.iter().zip(&self.root) {
                let planes = Planes::of(root, 1.0 / 3.0);
                for &p in points {
                    self.memory[p as usize] = self.memory[p as usize].plus(&planes);
                }
            }
            self.facing = self.star.iter().map(Star::facing).collect();
            return;
        }
        for p in 0..self.global.len() {
            if self.kind[p] != Kind::Shared {
                let from = self.global[p] as usize;
                self.facing[p] = level.facing[from];
                self.memory[p] = level.memory[from];
            }
        }
    }

    /// The line of the border from `p` to `n`.
    pub fn line(&self, p: u32, n: u32) -> Sym3 {
        let edge = self.position[n as usize] - self.position[p as usize];
        Sym3::across(edge, LINE_WEIGHT)
    }

    /// Triangles at `p`.
    #[inline(always)]
    pub fn triangles_at(&self, p: u32) -> &[u32] {
        let Span { start, len } = self.span[p as usize];
        &self.list[start as usize..(start + len) as usize]
    }
}
