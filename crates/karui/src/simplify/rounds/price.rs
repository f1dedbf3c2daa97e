//! What a collapse costs and where its vertex goes.
//!
//! P. Lindstrom, G. Turk: Fast and Memory Efficient Polygonal Simplification,
//! IEEE Visualization 1998: squared distances to the planes of the surface as
//! it is now, here weighted by area. All planes around a point pass through
//! it, so that its quadric, seen from it, is a matrix alone.

use super::block::Block;
use super::feature::Ends;
use glam::{Vec3, Vec4};

/// Pull towards the middle of the edge where the planes leave a direction
/// open, as a share of the trace.
pub(super) const PULL: f32 = 1e-4;
/// Weight of the squared height of the new vertex over the edge it replaces.
/// Planes go on where their triangles end: on a dome they meet far above it,
/// at no cost. (The height along the mean normal measures as well as the
/// distance to the triangles, at a tenth of the work.)
pub(super) const OFF_SURFACE: f32 = 1.0;
/// Weight of the squared way of the ends to the new vertex where the surface
/// turns back on itself: the planes on both sides of a blade do not tell how
/// far its rim retreats.
pub(super) const WAY: f32 = 2.0;
/// Where a surface counts as not turning back: squared length of the mean of
/// its unit normals.
pub(super) const CLOSED: f32 = 0.4;
/// How fast it comes to count as turning back below that.
pub(super) const STEEP: f32 = 4.0;
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
    pub(super) fn free(&self, a: u32, b: u32) -> Offer {
        let (pa, pb) = (self.position[a as usize], self.position[b as usize]);
        let (sa, sb) = (&self.star[a as usize], &self.star[b as usize]);
        let (qa, qb) = (sa.planes(), sb.planes());
        let half = (pb - pa) * 0.5;
        let sum = qa + qb;
        let area = sum.trace();
        let (ha, hb) = (qa.mul(half), qb.mul(half));
        let even = self.rules.even;
        let best = sum.solve((PULL + even) * area, hb - ha);
        let along = half.length_squared();
        let usable = best.length_squared() <= 16.0 * along;
        let mut place = if usable { best } else { Vec3::ZERO };
        // Two sums of squares: expanded, small costs would be lost to rounding.
        let mut least = qa.square(place + half) + qb.square(place - half);
        let at_ends = [(-half, 4.0 * half.dot(hb)), (half, 4.0 * half.dot(ha))];
        for (end, price) in at_ends {
            let gain = even * area * (place.length_squared() - along);
            if price < least + gain {
                (place, least) = (end, price);
            }
        }
        let normal = sa.normal() + sb.normal();
        let share = (place.dot(half) / along.max(f32::MIN_POSITIVE)).clamp(-1.0, 1.0);
        let height = (place - half * share).dot(normal);
        let height = height * height / normal.length_squared().max(f32::MIN_POSITIVE);
        let facing = self.facing[a as usize] + self.facing[b as usize];
        let retreat = WAY * openness(facing) * (place.length_squared() + along);
        Offer {
            kept: a,
            removed: b,
            place: pa + (place + half),
            cost: least.max(0.0)
                + area * (OFF_SURFACE * height + retreat + 4.0 * (SHORT + even) * along),
        }
    }

    #[inline(always)]
    fn fixed(&self, kept: u32, removed: u32) -> Offer {
        let place = self.position[kept as usize];
        let edge = self.position[removed as usize] - place;
        let planes = self.star[removed as usize].planes();
        let way = SHORT + self.rules.even + WAY * openness(self.facing[removed as usize]);
        Offer {
            kept,
            removed,
            place,
            cost: planes.square(edge) + way * planes.trace() * edge.length_squared(),
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

/// How little the input has a common side, 0 to 1, where its area normals and
/// its areas add up to `facing`.
#[inline(always)]
fn openness(facing: Vec4) -> f32 {
    let area = (facing.w * facing.w).max(f32::MIN_POSITIVE);
    let normal = facing.truncate().length_squared();
    ((CLOSED * facing.w * facing.w - normal) * STEEP / area).clamp(0.0, 1.0)
}
