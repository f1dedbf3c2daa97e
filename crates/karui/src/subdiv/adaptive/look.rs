//! What is seen of a piece, and whether it is to be split for that.

use super::eye::{Eye, corner_normals};
use super::options::AdaptiveOptions;
use super::piece::{Piece, Polygon};
use super::store::{NONE, Store};
use glam::DVec3;
use smallvec::SmallVec;

/// For every looker, one bit if something faces it and one if something faces away.
const BOTH: u32 = 0b11;
/// The first of every looker's bits.
const FIRST: u32 = 0x5555_5555;

/// When a piece is to be split.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Wish {
    Never,
    Always,
    /// If it is on a silhouette, or if it is on a terminator and can be seen.
    Where {
        silhouette: bool,
        terminator: bool,
        front: bool,
    },
}

/// What is seen of a piece.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen {
    /// As in [`Shape`](super::store::Shape).
    points: [u32; 4],
    flags: u32,
    wish: Wish,
}

/// What decides on pieces of one depth.
#[derive(Debug, Clone, Copy)]
pub(super) struct Look<'a> {
    pub eye: &'a Eye,
    pub options: &'a AdaptiveOptions,
    pub depth: u32,
}

impl Look<'_> {
    /// What is seen of a piece, if that has been measured.
    pub fn at(&self, store: &Store, t: usize, piece: Piece) -> Option<Seen> {
        let shape = store.shape(t, piece);
        if shape.error < 0.0 {
            return None;
        }
        let mut flags = 0;
        for (i, looker) in self.eye.lookers.iter().enumerate() {
            flags |= match looker.sees(shape) {
                Some(true) => 0b01 << (2 * i),
                Some(false) => 0b10 << (2 * i),
                None => facings(store, t, piece, self.eye) & BOTH << (2 * i),
            };
        }
        let (center, radius) = (shape.center.as_dvec3(), f64::from(shape.radius));
        let wish = || {
            let pixels = self.eye.pixels(center, radius);
            let lengths = [shape.error, shape.side].map(|length| f64::from(length) * pixels);
            self.wish(flags & 1 != 0, lengths)
        };
        Some(Seen {
            points: shape.points,
            flags,
            wish: if self.depth < self.options.depth_hidden {
                Wish::Always
            } else if self.eye.outside(center, radius) {
                Wish::Never
            } else {
                wish()
            },
        })
    }

    /// Of a piece that is in the picture, by its distance to the limit surface and its longest
    /// side, pixels.
    fn wish(&self, front: bool, [error, side]: [f64; 2]) -> Wish {
        let (options, front) = (self.options, front || self.options.two_sided);
        let unfinished = |pixels| unfinished([error, side], pixels, options);
        if front && self.depth < options.depth_front && unfinished(options.pixels) {
            return Wish::Always;
        }
        if self.depth >= options.depth_silhouette {
            return Wish::Never;
        }
        let silhouette = unfinished(options.silhouette_pixels.or(options.pixels));
        let terminator = options.terminator_pixels.is_some_and(|p| error > p);
        match silhouette || terminator {
            true => Wish::Where {
                silhouette,
                terminator,
                front,
            },
            false => Wish::Never,
        }
    }
}

/// Whether a piece is too far from the limit surface, or too large, in pixels; if neither
/// matters, no piece is good enough.
fn unfinished([error, side]: [f64; 2], pixels: Option<f64>, options: &AdaptiveOptions) -> bool {
    match (pixels, options.side_pixels) {
        (None, None) => true,
        (pixels, most) => pixels.is_some_and(|p| error > p) || most.is_some_and(|s| side > s),
    }
}

/// Bits of what faces whom in a piece, corner by corner: the eye by normals of the polygon,
/// as published, and by those of the surface; lights by these alone.
fn facings(store: &Store, t: usize, piece: Piece, eye: &Eye) -> u32 {
    let quad = store.shape(t, piece).wedges;
    if quad[0] != NONE {
        return polygon_facings(&quad.map(|w| store.limit(w)), eye);
    }
    let tier = Store::tier_of(t, piece);
    let corners = |c: &u32| store.corner_limit(tier, *c);
    let of = |polygon: Polygon| {
        let corners: SmallVec<[_; 8]> = polygon.iter().map(corners).collect();
        polygon_facings(&corners, eye)
    };
    store
        .polygons(t, piece)
        .into_iter()
        .map(of)
        .fold(0, |a, b| a | b)
}

/// As [`facings`], of corners with their normals.
fn polygon_facings(corners: &[(DVec3, DVec3)], eye: &Eye) -> u32 {
    let of_surface = corners
        .iter()
        .map(|&(limit, normal)| facing(eye, limit, normal));
    let flags = of_surface.fold(0, |a, b| a | b);
    // Nothing is left to learn of the eye.
    if flags & BOTH == BOTH {
        return flags;
    }
    let limits: SmallVec<[DVec3; 8]> = corners.iter().map(|c| c.0).collect();
    let of_polygon = limits
        .iter()
        .zip(corner_normals(&limits))
        .map(|(&limit, normal)| facing(eye, limit, normal) & BOTH);
    of_polygon.fold(flags, |a, b| a | b)
}

/// Bits of what faces whom.
fn facing(eye: &Eye, place: DVec3, normal: DVec3) -> u32 {
    let mut flags = 0;
    for (i, looker) in eye.lookers.iter().enumerate() {
        let along = looker.from(place).dot(normal);
        flags |= (u32::from(along > 0.0) | u32::from(along < 0.0) << 1) << (2 * i);
    }
    flags
}

impl Store {
    /// Leaves flags at all points of a piece.
    pub fn mark(&self, t: usize, piece: Piece, seen: &Seen, pass: u32) {
        if seen.points[0] != NONE {
            return seen
                .points
                .into_iter()
                .for_each(|point| self.marks[point as usize].add(pass, seen.flags));
        }
        for point in self.corner_points(t, piece) {
            self.marks[point as usize].add(pass, seen.flags);
        }
    }

    /// Whether a piece is to be split, once all of its depth have left their flags.
    pub fn wants(&self, t: usize, piece: Piece, seen: &Seen) -> bool {
        let Wish::Where {
            silhouette,
            terminator,
            front,
        } = seen.wish
        else {
            return seen.wish == Wish::Always;
        };
        let marks = self.marked(t, piece, seen);
        let (on_silhouette, on_terminator) = (marks & BOTH == BOTH, marks & !BOTH != 0);
        silhouette && on_silhouette || terminator && on_terminator && (front || on_silhouette)
    }

    /// Lookers that one of the piece's points has something towards and something away from:
    /// both bits of theirs.
    fn marked(&self, t: usize, piece: Piece, seen: &Seen) -> u32 {
        let both = |point: u32| {
            let flags = self.marks[point as usize].flags();
            let pairs = flags & flags >> 1 & FIRST;
            pairs | pairs << 1
        };
        if seen.points[0] != NONE {
            return seen.points.map(both).into_iter().fold(0, |a, b| a | b);
        }
        let points = self.corner_points(t, piece).into_iter();
        points.map(both).fold(0, |a, b| a | b)
    }

    /// Points of a piece of many corners.
    fn corner_points(&self, t: usize, piece: Piece) -> SmallVec<[u32; 8]> {
        let tier = Self::tier_of(t, piece);
        let wedge = |c: u32| self.wedges[self.tiers[tier].wedges[c as usize] as usize].point;
        self.polygons(t, piece)
            .into_iter()
            .flatten()
            .map(wedge)
            .collect()
    }
}
