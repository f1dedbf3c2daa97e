//! Choosing what to split, depth by depth.

use super::eye::{Eye, corner_normals};
use super::options::AdaptiveOptions;
use super::piece::{Piece, Polygon};
use super::split::Cut;
use super::store::{NONE, Store};
use glam::DVec3;
use rayon::prelude::*;
use smallvec::SmallVec;

/// Pieces a thread looks at, at a time.
const BATCH: usize = 256;
/// For every looker, one bit if something faces it and one if something faces away.
const BOTH: u32 = 0b11;
/// The first of every looker's bits.
const FIRST: u32 = 0x5555_5555;

/// What is seen of a piece.
#[derive(Debug, Clone, Copy)]
struct Seen {
    /// As in [`Shape`].
    points: [u32; 4],
    flags: u32,
    /// Whether any of it faces the eye.
    front: bool,
    outside: bool,
    /// Distance to the limit surface and length of the longest side, pixels.
    error: f64,
    side: f64,
}

/// Splits the cage's faces until every piece is good enough. Says whether that was possible
/// with no more faces than may be.
pub(super) fn select(
    cut: &mut Cut<'_>,
    eye: &Eye,
    options: &AdaptiveOptions,
    pass: &mut u32,
) -> bool {
    for face in 0..cut.store.tiers[0].faces.len() as u32 {
        for c in cut.store.tiers[0].corners_of(face) {
            cut.store.wedge(0, c);
        }
        cut.offer(0, Piece::Face(face));
        cut.faces += usize::from(!cut.store.is_hole(0, face));
    }
    for depth in 0..cut.offers.len() {
        *pass += 1;
        let offers = std::mem::take(&mut cut.offers[depth]);
        let chosen = choose(cut.store, depth, &offers, (eye, options, *pass));
        for (&id, chosen) in offers.iter().zip(chosen) {
            if chosen && cut.faces >= options.max_faces {
                return false;
            }
            if chosen {
                cut.split(depth / 2, piece(depth, id));
            }
        }
        // Given back for its memory.
        cut.offers[depth] = offers;
    }
    true
}

fn piece(depth: usize, id: u32) -> Piece {
    if depth.is_multiple_of(2) {
        Piece::Face(id)
    } else {
        Piece::Diamond(id)
    }
}

/// Which pieces of a depth are to be split.
fn choose(
    store: &mut Store,
    depth: usize,
    offers: &[u32],
    (eye, options, pass): (&Eye, &AdaptiveOptions, u32),
) -> Vec<bool> {
    let t = depth / 2;
    let eyes = (eye, options.two_sided);
    let mut seen = Vec::new();
    let shared = &*store;
    let all = offers.par_iter().with_min_len(BATCH);
    all.map(|&id| look(shared, t, piece(depth, id), eyes))
        .collect_into_vec(&mut seen);
    for (&id, seen) in offers.iter().zip(&mut seen) {
        if seen.is_none() {
            store.measure(t, piece(depth, id));
            *seen = look(store, t, piece(depth, id), eyes);
        }
    }
    store.marks.resize(store.points.len(), [0; 2]);
    for (&id, seen) in offers.iter().zip(&seen) {
        if let Some(seen) = seen {
            store.mark(t, piece(depth, id), seen, pass);
        }
    }
    let store = &*store;
    let all = offers.par_iter().zip(&seen).with_min_len(BATCH);
    let chosen = all.map(|(&id, seen)| {
        let Some(seen) = seen else { return false };
        let marks = store.marked(t, piece(depth, id), seen);
        wanted(seen, marks, depth as u32, options)
    });
    chosen.collect()
}

/// What is seen of a piece, if that has been measured.
fn look(store: &Store, t: usize, piece: Piece, (eye, two_sided): (&Eye, bool)) -> Option<Seen> {
    let shape = store.shape(t, piece);
    if shape.error < 0.0 {
        return None;
    }
    let (center, radius) = (shape.center.as_dvec3(), f64::from(shape.radius));
    let pixels = eye.pixels(center, radius);
    let mut flags = 0;
    for i in 0..eye.lookers.len() {
        flags |= match eye.lookers[i].sees(shape) {
            Some(true) => 0b01 << (2 * i),
            Some(false) => 0b10 << (2 * i),
            None => facings(store, t, piece, eye) & BOTH << (2 * i),
        };
    }
    Some(Seen {
        points: shape.points,
        flags,
        front: flags & 1 != 0 || two_sided,
        outside: eye.outside(center, radius),
        error: f64::from(shape.error) * pixels,
        side: f64::from(shape.side) * pixels,
    })
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

fn wanted(seen: &Seen, marks: u32, depth: u32, options: &AdaptiveOptions) -> bool {
    if depth < options.depth_hidden {
        return true;
    }
    if seen.outside {
        return false;
    }
    let silhouette = marks & BOTH == BOTH;
    if seen.front && depth < options.depth_front && unfinished(seen, options.pixels, options) {
        return true;
    }
    if depth >= options.depth_silhouette {
        return false;
    }
    let limit = options.silhouette_pixels.or(options.pixels);
    if silhouette && unfinished(seen, limit, options) {
        return true;
    }
    let terminator = marks & !BOTH != 0;
    let close = options
        .terminator_pixels
        .is_some_and(|pixels| seen.error > pixels);
    close && terminator && (seen.front || silhouette)
}

/// Whether a piece is too far from the limit surface, or too large; if neither matters, no
/// piece is good enough.
fn unfinished(seen: &Seen, pixels: Option<f64>, options: &AdaptiveOptions) -> bool {
    match (pixels, options.side_pixels) {
        (None, None) => true,
        (pixels, side) => {
            pixels.is_some_and(|p| seen.error > p) || side.is_some_and(|s| seen.side > s)
        }
    }
}

impl Store {
    /// Leaves flags at all points of a piece.
    fn mark(&mut self, t: usize, piece: Piece, seen: &Seen, pass: u32) {
        let points = match seen.points[0] {
            NONE => self.corner_points(t, piece),
            _ => SmallVec::from_slice(&seen.points),
        };
        for point in points {
            let mark = &mut self.marks[point as usize];
            let old = if mark[0] == pass { mark[1] } else { 0 };
            *mark = [pass, old | seen.flags];
        }
    }

    /// Lookers that one of the piece's points has something towards and something away from:
    /// both bits of theirs.
    fn marked(&self, t: usize, piece: Piece, seen: &Seen) -> u32 {
        let both = |point: u32| {
            let flags = self.marks[point as usize][1];
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
