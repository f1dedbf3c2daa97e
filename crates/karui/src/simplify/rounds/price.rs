//! What a collapse costs and where its vertex goes.
//!
//! P. Lindstrom, G. Turk: Fast and Memory Efficient Polygonal Simplification,
//! IEEE Visualization 1998: squared distances to the planes of the surface as
//! it is now, here weighted by area. All planes around a point pass through
//! it, so that its quadric, seen from it, is a matrix alone.

use super::block::Block;
use super::feature::Ends;
use glam::Vec3;

/// Pull towards the middle of the edge where the planes leave a direction
/// open, as a share of the trace.
pub(super) const PULL: f32 = 1e-4;
/// Weight of the squared height of the new vertex over the edge it replaces.
/// Planes go on where their triangles end: on a dome they meet far above it,
/// at no cost. (The height along the mean normal measures as well as the
/// distance to the triangles, at a tenth of the work.)
pub(super) const OFF_SURFACE: f32 = 1.0;
/// Preference for short edges where nothing else decides.
pub(super) const SHORT: f32 = 1e-6;

/// A collapse and its price.
#[derive(Debug, Clone, Copy)]
pub(super) struct Offer {
    pub kept: u32,
    pub removed: u32,
    pub place: Vec3,
    /// Area times squared distance.
    pub cost: f32,
}

impl Block {
    /// The price of joining `a` and `b`; none if neither may vanish.
    #[inline]
    pub fn offer(&self, a: u32, b: u32) -> Option<Offer> {
        let offer = match self.ends(a, b) {
            Ends::Either if self.rules.subset => {
                let (one, other) = (self.fixed(a, b), self.fixed(b, a));
                if other.cost < one.cost { other } else { one }
            }
            Ends::Either => self.free(a, b),
            Ends::Second => self.fixed(a, b),
            Ends::First => self.fixed(b, a),
            Ends::None => return None,
        };
        Some(self.weighted(offer))
    }

    /// Both may move: the place that minimises the sum of both quadrics, the
    /// best of ends and middle where that is ill-defined.
    #[inline(always)]
    fn free(&self, a: u32, b: u32) -> Offer {
        let (pa, pb) = (self.position[a as usize], self.position[b as usize]);
        let (sa, sb) = (&self.star[a as usize], &self.star[b as usize]);
        let (qa, qb) = (sa.planes(), sb.planes());
        let half = (pb - pa) * 0.5;
        let sum = qa + qb;
        let area = sum.trace();
        let linear = qb.mul(half) - qa.mul(half);
        // Two sums of squares: expanded, small costs would be lost to rounding.
        let cost = |y: Vec3| qa.square(y + half) + qb.square(y - half);
        let length_squared = 4.0 * half.length_squared();
        let best = sum.solve(PULL * area, linear);
        let usable = best.length_squared() <= 4.0 * length_squared;
        let mut place = if usable { best } else { Vec3::ZERO };
        let mut least = cost(place);
        for end in [-half, half] {
            let price = cost(end);
            if price < least {
                (place, least) = (end, price);
            }
        }
        let normal = sa.normal() + sb.normal();
        let height = height_over(place, half, normal);
        Offer {
            kept: a,
            removed: b,
            place: pa + (place + half),
            cost: least.max(0.0) + area * (OFF_SURFACE * height + SHORT * length_squared),
        }
    }

    #[inline(always)]
    fn fixed(&self, kept: u32, removed: u32) -> Offer {
        let place = self.position[kept as usize];
        let edge = self.position[removed as usize] - place;
        let planes = self.star[removed as usize].planes();
        Offer {
            kept,
            removed,
            place,
            cost: planes.square(edge) + SHORT * planes.trace() * edge.length_squared(),
        }
    }

    #[inline(always)]
    fn weighted(&self, mut offer: Offer) -> Offer {
        if !self.weight.is_empty() {
            let sum = self.weight[offer.kept as usize] + self.weight[offer.removed as usize];
            offer.cost *= 0.5 * sum;
        }
        offer
    }
}

/// Squared height of `y` over the edge from `-half` to `half`, along `normal`.
#[inline(always)]
fn height_over(y: Vec3, half: Vec3, normal: Vec3) -> f32 {
    let along = half.length_squared();
    let share = (y.dot(half) / along.max(f32::MIN_POSITIVE)).clamp(-1.0, 1.0);
    let height = (y - half * share).dot(normal);
    height * height / normal.length_squared().max(f32::MIN_POSITIVE)
}
