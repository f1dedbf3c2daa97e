//! What collapsing an edge would cost, and where the new vertex would lie.
//!
//! P. Lindstrom, G. Turk: Fast and Memory Efficient Polygonal Simplification,
//! IEEE Visualization 1998 (memoryless); M. Garland, P. Heckbert, SIGGRAPH
//! 1997 (accumulated). Unlike Lindstrom & Turk, squared distances are weighted
//! by area and not by its square: the sum then is the integral that the root
//! mean square error measures.

use super::blend::Mix;
use super::features::{EdgeInfo, Feature, PointClass, edge_info};
use super::options::{Cost, Placement};
use super::quadric::Quadric;
use super::signal::extrapolated;
use super::state::{LINE_WEIGHT, State, line};
use crate::geom::{closest_barycentric, closest_point, interpolate};
use glam::{DMat3, DVec3};
use smallvec::SmallVec;

/// Pull towards the middle of the edge where the planes leave a direction
/// open, as a share of the quadric's trace.
const PULL: f64 = 1e-4;
/// Weight of the squared distance between the new vertex and the surface as it
/// is. Planes go on where their triangles end: on a dome they meet far above
/// it, at no cost. (Bunny to 10 %: root mean square error 2.37e-4 of the
/// diagonal without, 2.30 / 2.24 / 2.21 / 2.26 / 2.37e-4 with 0.1, 0.3, 1, 2, 4.)
const OFF_SURFACE: f64 = 1.0;
/// Preference for short edges where nothing else decides.
const SHORT: f64 = 1e-6;

/// Why a collapse was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Refusal {
    Locked,
    Topology,
    Seams,
    Flips,
    Error,
}

/// A collapse that may be done.
#[derive(Debug, Clone)]
pub(crate) struct Candidate {
    /// Point that stays.
    pub kept: u32,
    /// Point that vanishes.
    pub removed: u32,
    /// Where `kept` will lie.
    pub place: DVec3,
    /// What it costs: area times squared distance.
    pub cost: f64,
    /// Wedges that become one.
    pub groups: SmallVec<[Group; 2]>,
    /// Triangles that vanish.
    pub triangles: usize,
}

/// A wedge of the new point: the ones at the old points that it replaces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Group {
    /// The wedge at the point that stays.
    pub kept: Option<u32>,
    /// The wedge at the point that vanishes.
    pub removed: Option<u32>,
}

/// Which end may vanish.
struct Roles {
    kept: u32,
    removed: u32,
    /// Whether the other end might vanish as well, so that the place is free.
    either: bool,
}

impl State<'_> {
    /// What a squared way along the surface counts beside one off it.
    fn even(&self) -> f64 {
        self.options.regularity * self.options.regularity
    }

    /// Looks at the collapse of `a` and `b`, an edge or (with no triangle in
    /// common) a vertex pair.
    pub fn candidate(&self, a: u32, b: u32) -> Result<Candidate, Refusal> {
        let info = edge_info(&self.surface, &self.range_of, a, b);
        let roles = self.roles(a, b, &info)?;
        let best = match (roles.either, self.options.placement) {
            (true, Placement::Optimal) => self.moved(&roles, &info),
            (true, Placement::HalfEdge) => {
                let one = self.fixed(roles.kept, roles.removed, &info, a);
                let other = self.fixed(roles.removed, roles.kept, &info, a);
                if other.cost < one.cost { other } else { one }
            }
            (false, _) => self.fixed(roles.kept, roles.removed, &info, a),
        };
        Ok(best)
    }

    fn roles(&self, a: u32, b: u32, info: &EdgeInfo) -> Result<Roles, Refusal> {
        let (a_goes, b_goes) = (self.may_vanish(a, 0, info), self.may_vanish(b, 1, info));
        let fixed = |p: u32| self.locked[p as usize];
        match (a_goes, b_goes) {
            (Ok(()), Ok(())) => Ok(Roles {
                kept: a,
                removed: b,
                either: true,
            }),
            // Only the place of a point that could not vanish is sure to be kept.
            (_, Ok(())) => Ok(Roles {
                kept: a,
                removed: b,
                either: false,
            }),
            (Ok(()), _) => Ok(Roles {
                kept: b,
                removed: a,
                either: false,
            }),
            _ if fixed(a) || fixed(b) => Err(Refusal::Locked),
            (Err(refusal), Err(_)) => Err(refusal),
        }
    }

    /// Whether the point at one end (0 or 1) of the edge may vanish.
    fn may_vanish(&self, p: u32, end: usize, info: &EdgeInfo) -> Result<(), Refusal> {
        if self.locked[p as usize] {
            return Err(Refusal::Locked);
        }
        if info.triangles == 0 {
            return Ok(());
        }
        let free = match self.class[p as usize] {
            PointClass::Interior => true,
            PointClass::Line(feature) => info.feature(end) == Some(feature),
            PointClass::Corner { .. } => false,
        };
        match (free, self.class[p as usize]) {
            (true, _) if self.wedges_match(p, end, info) => Ok(()),
            (true, _)
            | (_, PointClass::Line(Feature::Seam) | PointClass::Corner { seam: true }) => {
                Err(Refusal::Seams)
            }
            _ => Err(Refusal::Topology),
        }
    }

    /// Whether every wedge of `p` has exactly one partner across the edge.
    fn wedges_match(&self, p: u32, end: usize, info: &EdgeInfo) -> bool {
        let own = |pair: &(u32, u32)| if end == 0 { pair.0 } else { pair.1 };
        let other = |pair: &(u32, u32)| if end == 0 { pair.1 } else { pair.0 };
        let pairs = &info.pairs;
        let single = |x: &(u32, u32)| {
            pairs
                .iter()
                .filter(|y| own(y) == own(x) || other(y) == other(x))
                .count()
                == 1
        };
        pairs.iter().all(single)
            && self.surface.corners(p).all(|c| {
                let wedge = self.surface.wedges[c as usize / 3][c as usize % 3];
                pairs.iter().any(|pair| own(pair) == wedge)
            })
    }

    fn moved(&self, roles: &Roles, info: &EdgeInfo) -> Candidate {
        let (a, b) = (roles.kept, roles.removed);
        let [pa, pb] = [a, b].map(|p| self.surface.position[p as usize]);
        let middle = (pa + pb) * 0.5;
        let quadric = self.shape_quadric(a, b, middle, info);
        let place = best_place(&quadric, pa - middle, pb - middle, self.even());
        // What is checked must be what is stored, to the last bit.
        let place = (place + middle).as_vec3().as_dvec3();
        let groups = self.groups(a, b, info, a, true);
        let off = self.squared_distance_to_stars(a, b, place);
        let mut c = self.priced(a, b, place, &quadric, middle, groups, info);
        c.cost += OFF_SURFACE * quadric.weight * off * self.mean_weight(a, b);
        c
    }

    /// Squared distance from `place` to the triangles around both points.
    fn squared_distance_to_stars(&self, a: u32, b: u32, place: DVec3) -> f64 {
        let corners = self.surface.corners(a).chain(self.surface.corners(b));
        corners.fold(f64::INFINITY, |least, corner| {
            let corners = self.surface.places(corner as usize / 3);
            least.min(place.distance_squared(closest_point(place, corners)))
        })
    }

    fn fixed(&self, kept: u32, removed: u32, info: &EdgeInfo, first: u32) -> Candidate {
        let place = self.surface.position[kept as usize];
        let quadric = self.shape_quadric(kept, removed, place, info);
        let groups = self.groups(kept, removed, info, first, info.triangles == 0);
        self.priced(kept, removed, place, &quadric, place, groups, info)
    }

    #[allow(
        clippy::too_many_arguments,
        reason = "private; the parts of one candidate"
    )]
    fn priced(
        &self,
        kept: u32,
        removed: u32,
        place: DVec3,
        quadric: &Quadric,
        origin: DVec3,
        groups: SmallVec<[Group; 2]>,
        info: &EdgeInfo,
    ) -> Candidate {
        let [pk, pr] = [kept, removed].map(|p| self.surface.position[p as usize]);
        let mut cost = quadric.sum(place - origin);
        cost += (SHORT + self.even()) * quadric.weight * pk.distance_squared(pr);
        if !self.signal.is_empty() {
            cost += groups
                .iter()
                .map(|g| self.signal_cost(kept, removed, place, g))
                .sum::<f64>();
        }
        Candidate {
            kept,
            removed,
            place,
            cost: cost * self.mean_weight(kept, removed),
            groups,
            triangles: info.triangles,
        }
    }

    /// Squared distance to the planes and lines around both points, with
    /// `origin` as the origin of coordinates.
    fn shape_quadric(&self, a: u32, b: u32, origin: DVec3, info: &EdgeInfo) -> Quadric {
        let of = |p: u32| self.quadric[p as usize].relative_to(origin);
        match self.options.cost {
            Cost::Accumulated => return of(a) + of(b),
            Cost::Averaged => return (of(a) + of(b)) * 0.5,
            Cost::Memoryless => {}
        }
        let mut sum = self.star_around(a, origin);
        sum += self.star_around(b, origin);
        self.count_shared_once(a, b, origin, info, &mut sum);
        sum
    }

    fn star_around(&self, p: u32, origin: DVec3) -> Quadric {
        let from_point = origin - self.surface.position[p as usize];
        self.star[p as usize].relative_to(from_point)
    }

    /// Takes away what the stars of both ends have in common.
    fn count_shared_once(&self, a: u32, b: u32, origin: DVec3, info: &EdgeInfo, sum: &mut Quadric) {
        for corner in self.surface.corners(a) {
            let t = corner as usize / 3;
            if self.surface.points[t].contains(&b) {
                *sum += self.plane(t, a, origin, -1.0);
            }
        }
        let both = info.feature(0).is_some() && info.feature(1).is_some();
        if both && info.feature(0).is_some_and(|f| self.holds(f)) {
            let [pa, pb] = [a, b].map(|p| self.surface.position[p as usize]);
            *sum += line(pa - origin, pb - pa, -LINE_WEIGHT);
        }
    }

    /// Squared distance to the planes and lines around `p` as they are now,
    /// with `p` as the origin of coordinates.
    pub fn star_of(&self, p: u32) -> Quadric {
        let here = self.surface.position[p as usize];
        let mut sum = Quadric::default();
        for corner in self.surface.corners(p) {
            sum += self.plane(corner as usize / 3, p, here, 1.0);
        }
        for (n, feature) in self.feature_edges(p) {
            if self.holds(feature) {
                let edge = self.surface.position[n as usize] - here;
                sum += line(DVec3::ZERO, edge, LINE_WEIGHT);
            }
        }
        sum
    }

    fn plane(&self, t: usize, p: u32, origin: DVec3, sign: f64) -> Quadric {
        let facet = self.facets[t];
        let offset = facet.normal.dot(self.surface.position[p as usize] - origin);
        Quadric::plane(facet.normal, offset, sign * facet.area)
    }

    /// The wedges of the new point. Those of the kept point that have no
    /// partner matter only if it moves.
    fn groups(
        &self,
        kept: u32,
        removed: u32,
        info: &EdgeInfo,
        first: u32,
        with_single: bool,
    ) -> SmallVec<[Group; 2]> {
        let mut groups: SmallVec<[Group; 2]> = info
            .pairs
            .iter()
            .map(|&(wa, wb)| if kept == first { (wa, wb) } else { (wb, wa) })
            .map(|(k, r)| Group {
                kept: Some(k),
                removed: Some(r),
            })
            .collect();
        if with_single {
            for wedge in self.wedges_at(kept) {
                if !groups.iter().any(|g| g.kept == Some(wedge)) {
                    groups.push(Group {
                        kept: Some(wedge),
                        removed: None,
                    });
                }
            }
            for wedge in self.wedges_at(removed) {
                if !groups.iter().any(|g| g.removed == Some(wedge)) {
                    groups.push(Group {
                        kept: None,
                        removed: Some(wedge),
                    });
                }
            }
        }
        groups
    }

    fn wedges_at(&self, p: u32) -> impl Iterator<Item = u32> + '_ {
        self.surface
            .corners(p)
            .map(|c| self.surface.wedges[c as usize / 3][c as usize % 3])
    }

    /// Corners around both points whose wedge belongs to the group, every
    /// triangle once.
    pub fn group_corners<'s>(
        &'s self,
        kept: u32,
        removed: u32,
        group: &'s Group,
    ) -> impl Iterator<Item = u32> + 's {
        let wedge = |c: u32| Some(self.surface.wedges[c as usize / 3][c as usize % 3]);
        let at_kept = self
            .surface
            .corners(kept)
            .filter(move |&c| wedge(c) == group.kept);
        let at_removed = self.surface.corners(removed).filter(move |&c| {
            wedge(c) == group.removed
                && (group.kept.is_none() || !self.surface.points[c as usize / 3].contains(&kept))
        });
        at_kept.chain(at_removed)
    }

    /// The mixture that the surface shows, of the group's wedges, nearest to
    /// the new place. A wedge that stays in place stays as it is.
    pub fn mix(&self, kept: u32, removed: u32, place: DVec3, group: &Group) -> Option<Mix> {
        if let Some(wedge) = group
            .kept
            .filter(|_| self.surface.position[kept as usize] == place)
        {
            return Some(Mix {
                sources: [wedge; 3],
                shares: [1.0, 0.0, 0.0],
            });
        }
        let mut best: Option<(f64, Mix)> = None;
        for corner in self.group_corners(kept, removed, group) {
            let t = corner as usize / 3;
            let corners = self.surface.places(t);
            let shares = closest_barycentric(place, corners);
            let distance = place.distance_squared(interpolate(corners, shares));
            if best.as_ref().is_none_or(|(known, _)| distance < *known) {
                best = Some((
                    distance,
                    Mix {
                        sources: self.surface.wedges[t],
                        shares,
                    },
                ));
            }
        }
        best.map(|(_, mix)| mix)
    }

    fn signal_cost(&self, kept: u32, removed: u32, place: DVec3, group: &Group) -> f64 {
        let Some(new) = self.mix(kept, removed, place, group) else {
            return 0.0;
        };
        let mut sum = 0.0;
        for corner in self.group_corners(kept, removed, group) {
            let t = corner as usize / 3;
            let there = Mix {
                sources: self.surface.wedges[t],
                shares: extrapolated(place, self.surface.places(t)),
            };
            let difference = self
                .signal
                .squared_difference(&self.attributes, &new, &there);
            sum += self.facets[t].area * difference;
        }
        sum
    }
}

/// The place that minimises `quadric`, whose origin is the middle of the edge
/// from `a` to `b`; where that is ill-defined, or the pull has moved it off a
/// sharp corner, the best of ends and middle.
fn best_place(quadric: &Quadric, a: DVec3, b: DVec3, even: f64) -> DVec3 {
    let pull = (PULL + even) * quadric.trace();
    let matrix = quadric.matrix() + DMat3::from_diagonal(DVec3::splat(pull));
    let place = matrix.inverse() * quadric.linear();
    let length_squared = a.distance_squared(b);
    let usable = place.is_finite() && place.length_squared() <= 4.0 * length_squared;
    let start = if usable { place } else { DVec3::ZERO };
    let noise = 1e-14 * quadric.trace() * length_squared;
    [DVec3::ZERO, a, b].into_iter().fold(start, |best, choice| {
        let better = quadric.sum(choice) + noise < quadric.sum(best);
        if better { choice } else { best }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_planes_meet_in_the_best_place() {
        let mut q = Quadric::plane(DVec3::X, 0.1, 1.0);
        q += Quadric::plane(DVec3::Y, -0.2, 1.0);
        q += Quadric::plane(DVec3::Z, 0.3, 1.0);
        let place = best_place(&q, -DVec3::X, DVec3::X, 0.0);
        assert!((place - DVec3::new(0.1, -0.2, 0.3)).length() < 1e-3);
    }

    #[test]
    fn in_a_plane_the_middle_is_kept() {
        let q = Quadric::plane(DVec3::Z, 0.0, 1.0);
        assert_eq!(best_place(&q, -DVec3::X, DVec3::X, 0.0), DVec3::ZERO);
    }

    #[test]
    fn a_quadric_that_says_nothing_is_survived() {
        assert_eq!(
            best_place(&Quadric::default(), -DVec3::X, DVec3::X, 0.0),
            DVec3::ZERO
        );
    }
}
