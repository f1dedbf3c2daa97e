//! Choosing what to split, depth by depth.

use super::eye::{Eye, corner_normals};
use super::options::AdaptiveOptions;
use super::piece::Piece;
use super::split::Cut;
use super::store::Store;
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
#[derive(Debug, Clone, Copy, Default)]
struct Seen {
    flags: u32,
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
    for &id in offers {
        store.measure(t, piece(depth, id));
    }
    let mut seen = Vec::new();
    let all = offers.par_iter().with_min_len(BATCH);
    all.map(|&id| look(store, t, piece(depth, id), eye))
        .collect_into_vec(&mut seen);
    for (&id, seen) in offers.iter().zip(&seen) {
        store.mark(t, piece(depth, id), seen.flags, pass);
    }
    let store = &*store;
    let all = offers.par_iter().zip(&seen).with_min_len(BATCH);
    let chosen = all.map(|(&id, seen)| {
        let marks = store.marks(t, piece(depth, id));
        wanted(seen, marks, depth as u32, options)
    });
    chosen.collect()
}

fn look(store: &Store, t: usize, piece: Piece, eye: &Eye) -> Seen {
    let tier = Store::tier_of(t, piece);
    let mut seen = Seen::default();
    let mut all: SmallVec<[DVec3; 8]> = SmallVec::new();
    for polygon in store.polygons(t, piece) {
        let first = all.len();
        for &c in &polygon {
            let (limit, normal) = store.corner_limit(tier, c);
            seen.flags |= facing(eye, limit, normal);
            all.push(limit);
        }
        let corners = &all[first..];
        for (i, normal) in corner_normals(corners).enumerate() {
            seen.flags |= facing(eye, corners[i], normal) & BOTH;
            let side = corners[i].distance(corners[(i + 1) % corners.len()]);
            seen.side = seen.side.max(side);
        }
    }
    let error = f64::from(store.error(t, piece));
    let center = all.iter().sum::<DVec3>() / all.len() as f64;
    let reach = all
        .iter()
        .map(|p| p.distance_squared(center))
        .fold(0.0, f64::max);
    // The surface goes beyond its corners by about as much as it is away from the chords.
    let radius = reach.sqrt() + 2.0 * error;
    let pixels = eye.pixels(center, radius);
    seen.outside = eye.outside(center, radius);
    seen.error = error * pixels;
    seen.side *= pixels;
    seen
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
    let front = seen.flags & 1 != 0;
    if front && depth < options.depth_front && unfinished(seen, options.pixels, options) {
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
    close && terminator && (front || silhouette)
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
    fn error(&self, t: usize, piece: Piece) -> f32 {
        match piece {
            Piece::Face(f) => self.tiers[t].faces[f as usize].error,
            Piece::Diamond(e) => self.tiers[t].edges[e as usize].error,
        }
    }

    /// Leaves flags at all points of a piece.
    fn mark(&mut self, t: usize, piece: Piece, flags: u32, pass: u32) {
        let tier = Self::tier_of(t, piece);
        for c in self.polygons(t, piece).into_iter().flatten() {
            let wedge = self.tiers[tier].wedges[c as usize];
            let point = &mut self.points[self.wedges[wedge as usize].point as usize];
            let old = if point.pass == pass { point.flags } else { 0 };
            (point.pass, point.flags) = (pass, old | flags);
        }
    }

    /// Lookers that one of the piece's points has something towards and something away from:
    /// both bits of theirs.
    fn marks(&self, t: usize, piece: Piece) -> u32 {
        let tier = Self::tier_of(t, piece);
        let mut both = 0;
        for c in self.polygons(t, piece).into_iter().flatten() {
            let wedge = self.tiers[tier].wedges[c as usize];
            let flags = self.points[self.wedges[wedge as usize].point as usize].flags;
            let pairs = flags & flags >> 1 & FIRST;
            both |= pairs | pairs << 1;
        }
        both
    }
}
