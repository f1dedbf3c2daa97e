//! Choosing what to split, depth by depth.

use super::eye::Eye;
use super::look::{Look, Seen};
use super::options::AdaptiveOptions;
use super::piece::Piece;
use super::split::{Cut, Outcome, Yield};
use super::stamp::Mark;
use super::store::Store;
use rayon::prelude::*;

/// Pieces a thread looks at, at a time.
const BATCH: usize = 256;
/// Pieces a thread splits what it wants of, at a time.
const SPLIT_BATCH: usize = 1024;

/// How far pieces were split.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum End {
    /// Until every one was good enough.
    Complete,
    /// Until there were as many faces as may be.
    Full,
    /// There may have been as many on the way: to be done again, in order.
    Unclear,
}

/// What pieces are chosen by, and how they are split.
#[derive(Debug, Clone, Copy)]
pub(super) struct Choice<'a> {
    pub cut: Cut,
    pub eye: &'a Eye,
    pub options: &'a AdaptiveOptions,
    /// One after the other, so that what is split first, where not all can be, is always the
    /// same; else by all threads, which is as good where all can be.
    pub in_order: bool,
}

/// Pieces that may be split, by depth, faces at even ones and diamonds at odd ones; and the
/// number of faces drawn.
#[derive(Debug)]
struct Front<'a> {
    offers: &'a mut [Vec<u32>],
    faces: i64,
}

/// Splits the cage's faces until every piece is good enough, or there are enough. Of `offers`
/// there is one for every depth that may be split.
pub(super) fn select(
    store: &mut Store,
    choice: Choice<'_>,
    offers: &mut [Vec<u32>],
    pass: &mut u32,
) -> End {
    let mut front = Front { offers, faces: 0 };
    front.take(offer_cage(store, choice.cut));
    for depth in 0..front.offers.len() {
        *pass += 1;
        let offers = std::mem::take(&mut front.offers[depth]);
        let seen = look_at(store, depth, &offers, (choice, *pass));
        let split = match choice.in_order {
            true => split_in_order,
            false => split_together,
        };
        let end = split(store, depth, (&offers, &seen), (choice, &mut front));
        // Given back for its memory.
        front.offers[depth] = offers;
        if end != End::Complete {
            return end;
        }
    }
    End::Complete
}

fn offer_cage(store: &mut Store, cut: Cut) -> Yield {
    let mut first = Yield::default();
    for face in 0..store.tiers[0].faces.len() as u32 {
        for c in store.tiers[0].corners_of(face) {
            store.wedge(0, c);
        }
        cut.offer(store, 0, Piece::Face(face), &mut first);
        first.faces += i64::from(!store.is_hole(0, face));
    }
    first
}

impl Front<'_> {
    /// Adds what was split, and what that offers.
    fn take(&mut self, done: Yield) {
        self.faces += done.faces;
        for (depth, id) in done.offers {
            if let Some(offers) = self.offers.get_mut(depth as usize) {
                offers.push(id);
            }
        }
    }
}

fn piece(depth: usize, id: u32) -> Piece {
    if depth.is_multiple_of(2) {
        Piece::Face(id)
    } else {
        Piece::Diamond(id)
    }
}

/// What is seen of the pieces of a depth, measured if they were not; flags of what they face
/// are left at their points.
fn look_at(
    store: &mut Store,
    depth: usize,
    offers: &[u32],
    (choice, pass): (Choice<'_>, u32),
) -> Vec<Option<Seen>> {
    let t = depth / 2;
    let look = Look {
        eye: choice.eye,
        options: choice.options,
        depth: depth as u32,
    };
    store.resize_marks();
    let shared = &*store;
    let one = |&id: &u32| {
        let seen = look.at(shared, t, piece(depth, id));
        seen.inspect(|seen| shared.mark(t, piece(depth, id), seen, pass))
    };
    let mut seen = Vec::new();
    let all = offers.par_iter().with_min_len(BATCH);
    all.map(one).collect_into_vec(&mut seen);
    for (&id, seen) in offers.iter().zip(&mut seen) {
        if seen.is_none() {
            store.measure(t, piece(depth, id));
            store.resize_marks();
            *seen = look.at(store, t, piece(depth, id));
            seen.inspect(|seen| store.mark(t, piece(depth, id), seen, pass));
        }
    }
    seen
}

/// Splits what is wanted of a depth, by all threads; what has to be made for that, afterwards.
fn split_together(
    store: &mut Store,
    depth: usize,
    (offers, seen): (&[u32], &[Option<Seen>]),
    (choice, front): (Choice<'_>, &mut Front<'_>),
) -> End {
    let shared = &*store;
    let batch = |(offers, seen): (&[u32], &[Option<Seen>])| {
        let (mut to, mut missing, mut any) = (Yield::default(), Vec::new(), false);
        for piece in wanted(shared, depth, offers, seen) {
            any = true;
            if choice.cut.split(shared, depth / 2, piece, &mut to) == Outcome::Missing {
                missing.push(piece);
            }
        }
        (to, missing, any)
    };
    let seen = seen.par_chunks(SPLIT_BATCH);
    let batches = offers.par_chunks(SPLIT_BATCH).zip(seen).map(batch);
    let batches: Vec<_> = batches.collect();
    let (mut most, mut some) = (front.faces, false);
    for (mut to, missing, any) in batches {
        for piece in missing {
            grow_and_split(store, depth, piece, (choice.cut, &mut to));
        }
        some |= any;
        most += to.most;
        front.take(to);
    }
    match some && most >= choice.most_faces() {
        true => End::Unclear,
        false => End::Complete,
    }
}

/// Splits what is wanted of a depth, one after the other, as long as there may be more faces.
fn split_in_order(
    store: &mut Store,
    depth: usize,
    (offers, seen): (&[u32], &[Option<Seen>]),
    (choice, front): (Choice<'_>, &mut Front<'_>),
) -> End {
    let wanted: Vec<Piece> = wanted(store, depth, offers, seen).collect();
    for piece in wanted {
        if front.faces >= choice.most_faces() {
            return End::Full;
        }
        let mut to = Yield::default();
        if choice.cut.split(store, depth / 2, piece, &mut to) == Outcome::Missing {
            grow_and_split(store, depth, piece, (choice.cut, &mut to));
        }
        front.take(to);
    }
    End::Complete
}

/// Those of a depth's pieces that are to be split.
fn wanted<'a>(
    store: &'a Store,
    depth: usize,
    offers: &'a [u32],
    seen: &'a [Option<Seen>],
) -> impl Iterator<Item = Piece> + 'a {
    offers.iter().zip(seen).filter_map(move |(&id, seen)| {
        let wants = store.wants(depth / 2, piece(depth, id), seen.as_ref()?);
        wants.then(|| piece(depth, id))
    })
}

fn grow_and_split(store: &mut Store, depth: usize, piece: Piece, (cut, to): (Cut, &mut Yield)) {
    cut.grow(store, depth / 2, piece);
    let outcome = cut.split(store, depth / 2, piece, to);
    debug_assert_ne!(outcome, Outcome::Missing, "all has been made");
}

impl Choice<'_> {
    fn most_faces(&self) -> i64 {
        i64::try_from(self.options.max_faces).unwrap_or(i64::MAX)
    }
}

impl Store {
    fn resize_marks(&mut self) {
        self.marks.resize(self.points.len(), Mark::default());
    }
}
