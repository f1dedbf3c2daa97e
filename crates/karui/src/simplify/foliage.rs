//! Foliage: fewer leaves, each larger, so that crowns do not thin out.
//!
//! R. Cook, J. Halstead, M. Planck, D. Ryu: Stochastic Simplification of
//! Aggregate Detail, SIGGRAPH 2007.

use super::{SimplifyOptions, Stop, Stopped, in_range, simplify, target};
use crate::error::Result;
use crate::geom::{Aabb, area};
use crate::mesh::{Components, PositionIds, TriMesh};
use crate::spatial::{Bvh, morton};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Options of [`foliage`].
#[derive(Debug, Clone, Copy)]
pub struct FoliageOptions<'a> {
    /// How the larger parts are simplified, and the stop for the whole mesh.
    /// Bounds on the error hold for the larger parts alone; without a count or
    /// a ratio all cards stay.
    pub simplify: SimplifyOptions<'a>,
    /// Triangles up to which a connected part is a leaf card. Default: 16.
    pub card: usize,
    /// Chooses other cards. Default: 0.
    pub seed: u64,
}

impl Default for FoliageOptions<'_> {
    fn default() -> Self {
        Self {
            simplify: SimplifyOptions::default(),
            card: 16,
            seed: 0,
        }
    }
}

/// A mesh with fewer leaves, and how it came about.
#[derive(Debug, Clone)]
pub struct Foliage {
    /// The coarser mesh.
    pub mesh: TriMesh,
    /// Estimate of the error of the larger parts, model units; cards that were
    /// removed or enlarged do not count.
    pub error: f64,
    /// Why it went no further.
    pub stopped: Stopped,
    /// Cards in the input and in the result.
    pub cards: [usize; 2],
    /// Factor by which the sides of those left were enlarged.
    pub enlarged: f64,
    /// Area of the input and of the result, model units squared.
    pub area: [f64; 2],
    /// Edges of the larger parts that were collapsed.
    pub collapses: usize,
}

/// Simplifies a mesh of many small parts (leaf cards) and a few large ones (a
/// trunk) so that the area it covers stays.
///
/// Cards are removed in an order that is spread evenly in space at every
/// count: along the Morton curve, by bit-reversed index. Those that stay are
/// enlarged so that their total area is that of all before, about the vertex
/// that touches a larger part if one does, else about their centroid. Larger
/// parts go through [`simplify()`], with their share of the triangles; a part
/// with a locked vertex is none of the cards. One card always stays.
///
/// # Errors
/// As [`simplify()`]; [`Error::BadOption`](crate::Error::BadOption) for cards
/// of no triangle.
///
/// # Examples
/// ```
/// use karui::{mesh::shapes, simplify::{FoliageOptions, SimplifyOptions, Stop, foliage}};
///
/// let tree = shapes::tree(2000, 1);
/// let coarse = foliage(&tree, &FoliageOptions {
///     simplify: SimplifyOptions {
///         stop: Stop::ratio(0.1),
///         ..Default::default()
///     },
///     ..Default::default()
/// })?;
/// assert!(coarse.mesh.triangles.len() <= tree.triangles.len() / 10 + 1);
/// assert!((coarse.area[1] / coarse.area[0] - 1.0).abs() < 0.05);
/// # Ok::<(), karui::Error>(())
/// ```
pub fn foliage(mesh: &TriMesh, options: &FoliageOptions<'_>) -> Result<Foliage> {
    mesh.validate()?;
    super::check(mesh, &options.simplify)?;
    super::check_stop(&options.simplify.stop)?;
    let card = Some(options.card as f64);
    in_range("card", card, 1.0..=f64::MAX, "1 or more")?;
    let parts = Parts::of(mesh, options)?;
    let budget = budget(mesh, &options.simplify.stop);
    let rest = Rest::of(mesh, &parts, options, budget)?;
    let kept = parts.chosen(
        budget.saturating_sub(rest.mesh.triangles.len()),
        options.seed,
    );
    let (cards, enlarged) = parts.enlarged(mesh, &kept, &rest)?;
    let triangles = rest.mesh.triangles.len() + cards.triangles.len();
    let stopped = match rest.stopped {
        _ if triangles <= budget => Stopped::Target,
        Stopped::Target => Stopped::Exhausted,
        other => other,
    };
    let coarse = rest.mesh.with_ranges_of(cards);
    Ok(Foliage {
        area: [total_area(mesh), total_area(&coarse)],
        mesh: coarse,
        error: rest.error,
        stopped,
        cards: [parts.cards.len(), kept.len()],
        enlarged,
        collapses: rest.collapses,
    })
}

/// Triangles that may be left.
fn budget(mesh: &TriMesh, stop: &Stop) -> usize {
    if stop.triangles.is_none() && stop.ratio.is_none() && stop.bounds_error() {
        return usize::MAX;
    }
    target(mesh, stop).triangles
}

fn total_area(mesh: &TriMesh) -> f64 {
    (0..mesh.triangles.len())
        .map(|t| area(mesh.corners(t)))
        .sum()
}

/// The connected parts, sorted into cards and others.
struct Parts {
    of: Components,
    /// Numbers of the parts that are cards, in the order of their triangles.
    cards: Vec<u32>,
    /// Triangles of all cards.
    triangles: usize,
    /// For every part its place among the cards; `u32::MAX` for others.
    card_of: Vec<u32>,
    /// Of every card.
    sizes: Vec<u32>,
    areas: Vec<f64>,
    centroids: Vec<Vec3>,
    boxes: Vec<Aabb>,
}

impl Parts {
    fn of(mesh: &TriMesh, options: &FoliageOptions<'_>) -> Result<Self> {
        let of = Components::of(mesh, &PositionIds::of_mesh(mesh))?;
        let mut sizes = vec![0u32; of.count];
        let mut held = vec![false; of.count];
        let locks = options.simplify.locks;
        for (triangle, &part) in mesh.triangles.iter().zip(&of.of_triangle) {
            sizes[part as usize] += 1;
            held[part as usize] |= locks.is_some_and(|l| triangle.iter().any(|&v| l[v as usize]));
        }
        let is_card =
            |&part: &u32| sizes[part as usize] as usize <= options.card && !held[part as usize];
        let cards: Vec<u32> = (0..of.count as u32).filter(is_card).collect();
        let mut card_of = vec![u32::MAX; of.count];
        for (card, &part) in cards.iter().enumerate() {
            card_of[part as usize] = card as u32;
        }
        let sizes: Vec<u32> = cards.iter().map(|&part| sizes[part as usize]).collect();
        let mut parts = Self {
            triangles: sizes.iter().map(|&s| s as usize).sum(),
            areas: vec![0.0; cards.len()],
            centroids: Vec::new(),
            boxes: vec![Aabb::EMPTY; cards.len()],
            of,
            cards,
            card_of,
            sizes,
        };
        parts.measure(mesh);
        Ok(parts)
    }

    fn card(&self, t: usize) -> Option<usize> {
        let card = self.card_of[self.of.of_triangle[t] as usize];
        (card != u32::MAX).then_some(card as usize)
    }

    /// Area, centroid and box of every card.
    fn measure(&mut self, mesh: &TriMesh) {
        let mut moments = vec![DVec3::ZERO; self.cards.len()];
        for (t, triangle) in mesh.triangles.iter().enumerate() {
            let Some(card) = self.card(t) else { continue };
            let corners = mesh.corners(t);
            let area = area(corners);
            self.areas[card] += area;
            moments[card] += (corners[0] + corners[1] + corners[2]) / 3.0 * area;
            let places = triangle.map(|v| mesh.positions[v as usize]);
            self.boxes[card] = places.into_iter().fold(self.boxes[card], Aabb::with);
        }
        let centroid = |card: usize| {
            let centroid = (moments[card] / self.areas[card]).as_vec3();
            match centroid.is_finite() {
                true => centroid,
                false => self.boxes[card].center(),
            }
        };
        self.centroids = (0..moments.len()).map(centroid).collect();
    }

    /// Cards whose triangles fit the budget, one at least, spread evenly.
    fn chosen(&self, budget: usize, seed: u64) -> Vec<u32> {
        if self.triangles <= budget {
            return (0..self.cards.len() as u32).collect();
        }
        // Bit-reversed numbers take turns among the halves, quarters, ... of
        // the curve (van der Corput); the seed says which half comes first.
        let shift = (seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32) as u32;
        let along = morton::order(&self.centroids);
        let mut order: Vec<(u32, u32)> = (along.into_iter().zip(0u32..))
            .map(|(card, rank)| (rank.reverse_bits() ^ shift, card))
            .collect();
        order.par_sort_unstable();
        let mut left = budget;
        let mut kept: Vec<u32> = Vec::new();
        for (_, card) in order {
            let size = self.sizes[card as usize] as usize;
            if size > left && !kept.is_empty() {
                break;
            }
            left = left.saturating_sub(size);
            kept.push(card);
        }
        kept.sort_unstable();
        kept
    }

    /// The cards kept as a mesh, enlarged, and by what factor.
    fn enlarged(&self, mesh: &TriMesh, kept: &[u32], rest: &Rest) -> Result<(TriMesh, f64)> {
        let left: f64 = kept.iter().map(|&card| self.areas[card as usize]).sum();
        let factor = (self.areas.iter().sum::<f64>() / left).sqrt();
        let factor = if factor.is_finite() { factor } else { 1.0 };
        let mut stays = vec![false; self.cards.len()];
        kept.iter().for_each(|&card| stays[card as usize] = true);
        let mut cards = mesh.clone();
        cards.retain_triangles(|t| self.card(t).is_some_and(|card| stays[card]));
        let card_of: Vec<usize> = (0..mesh.triangles.len())
            .filter_map(|t| self.card(t).filter(|&card| stays[card]))
            .collect();
        cards.remove_unreferenced_vertices();
        if kept.len() < self.cards.len() {
            let anchors = self.anchors(&cards, &card_of, rest.surface()?.as_ref());
            enlarge(&mut cards, &card_of, &anchors, factor);
            return Ok((cards, factor));
        }
        Ok((cards, 1.0))
    }

    /// What every card is enlarged about: the vertex that touches a larger
    /// part, else its centroid.
    fn anchors(&self, cards: &TriMesh, card_of: &[usize], larger: Option<&Bvh>) -> Vec<Vec3> {
        let mut anchors = self.centroids.clone();
        let Some(larger) = larger else { return anchors };
        let nearest = |triangle: &[u32; 3]| {
            let places = triangle.map(|v| cards.positions[v as usize]);
            let off = places.map(|p| larger.closest(p.as_dvec3()).distance_squared);
            let k = (1..3).fold(0, |best, k| if off[k] < off[best] { k } else { best });
            (off[k].sqrt(), places[k])
        };
        let nearest: Vec<(f64, Vec3)> = cards.triangles.par_iter().map(nearest).collect();
        let touches = |card: usize| TOUCHES * self.boxes[card].diagonal();
        let mut best: Vec<f64> = (0..self.cards.len()).map(touches).collect();
        for (&card, &(off, place)) in card_of.iter().zip(&nearest) {
            if off < best[card] {
                (best[card], anchors[card]) = (off, place);
            }
        }
        anchors
    }
}

/// Distance, as a share of its size, within which a card touches a larger part.
const TOUCHES: f64 = 0.1;

fn enlarge(cards: &mut TriMesh, card_of: &[usize], anchors: &[Vec3], factor: f64) {
    let mut anchor_of = vec![None; cards.positions.len()];
    for (triangle, &card) in cards.triangles.iter().zip(card_of) {
        for &v in triangle {
            anchor_of[v as usize] = Some(anchors[card].as_dvec3());
        }
    }
    for (place, anchor) in cards.positions.iter_mut().zip(anchor_of) {
        if let Some(anchor) = anchor {
            let moved = (anchor + (place.as_dvec3() - anchor) * factor).as_vec3();
            // At the end of the range of numbers it stays what it was.
            if moved.is_finite() {
                *place = moved;
            }
        }
    }
}

/// The larger parts.
struct Rest {
    /// What they were.
    original: TriMesh,
    /// What is left of them.
    mesh: TriMesh,
    error: f64,
    stopped: Stopped,
    collapses: usize,
}

impl Rest {
    /// Simplified to their share of the budget.
    fn of(
        mesh: &TriMesh,
        parts: &Parts,
        options: &FoliageOptions<'_>,
        budget: usize,
    ) -> Result<Self> {
        let mut original = mesh.clone();
        original.retain_triangles(|t| parts.card(t).is_none());
        let vertices = original.remove_unreferenced_vertices();
        let all = mesh.triangles.len().max(1) as u128;
        let share = budget as u128 * original.triangles.len() as u128 / all;
        let count = usize::try_from(share).unwrap_or(usize::MAX);
        if original.triangles.is_empty()
            || (count >= original.triangles.len() && budget != usize::MAX)
        {
            return Ok(Self {
                mesh: original.clone(),
                original,
                error: 0.0,
                stopped: Stopped::Target,
                collapses: 0,
            });
        }
        let weights = options.simplify.weights.map(|w| gathered(w, &vertices));
        let locks = options.simplify.locks.map(|l| gathered(l, &vertices));
        let coarse = simplify(
            &original,
            &SimplifyOptions {
                stop: Stop {
                    triangles: (budget != usize::MAX).then_some(count),
                    ratio: None,
                    ..options.simplify.stop
                },
                weights: weights.as_deref(),
                locks: locks.as_deref(),
                ..options.simplify
            },
        )?;
        Ok(Self {
            original,
            mesh: coarse.mesh,
            error: coarse.error,
            stopped: coarse.stopped,
            collapses: coarse.collapses,
        })
    }

    /// What they were, to look up distances.
    fn surface(&self) -> Result<Option<Bvh>> {
        let any = !self.original.triangles.is_empty();
        any.then(|| Bvh::build(&self.original)).transpose()
    }
}

fn gathered<T: Copy>(values: &[T], sources: &[u32]) -> Vec<T> {
    sources.iter().map(|&s| values[s as usize]).collect()
}
