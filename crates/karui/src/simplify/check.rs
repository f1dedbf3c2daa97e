//! Whether a collapse keeps the surface what it is: topology, orientation of
//! triangles and of their UVs.

use super::blend::Mix;
use super::candidate::{Candidate, Refusal};
use super::state::State;
use glam::{DVec2, DVec3, Vec2};
use smallvec::SmallVec;

/// Least cosine between a triangle's normal and the mean of the input's
/// normals around its corners.
const FACING: f64 = 0.2;
/// A triangle thinner than this must not get much thinner; 1 would be a right
/// angle with equal sides.
const THIN: f64 = 0.02;

/// A triangle as the collapse would leave it.
struct Turned {
    points: [u32; 3],
    before: [DVec3; 3],
    after: [DVec3; 3],
}

/// Attributes of every group at the new place.
pub(crate) type Mixes = SmallVec<[Mix; 2]>;

impl State<'_> {
    /// Mixtures for all groups of the candidate.
    pub fn mixes(&self, c: &Candidate) -> Mixes {
        let mix = |g| self.mix(c.kept, c.removed, c.place, g);
        c.groups.iter().filter_map(mix).collect()
    }

    /// Checks everything that does not need the input's surface.
    pub fn check(&mut self, c: &Candidate, mixes: &Mixes) -> Result<(), Refusal> {
        if c.triangles > 0 {
            self.check_link(c)?;
        }
        for t in self.changed(c) {
            if !self.keeps_its_side(&t) {
                return Err(Refusal::Flips);
            }
        }
        if self.turns_uvs(c, mixes) {
            Err(Refusal::Flips)
        } else {
            Ok(())
        }
    }

    /// Triangles that change their shape: places before and after the collapse.
    pub fn places_changed(&self, c: &Candidate) -> SmallVec<[([DVec3; 3], [DVec3; 3]); 16]> {
        self.changed(c).map(|t| (t.before, t.after)).collect()
    }

    fn changed<'s>(&'s self, c: &'s Candidate) -> impl Iterator<Item = Turned> + 's {
        let ends = [(c.kept, c.removed), (c.removed, c.kept)];
        ends.into_iter().flat_map(move |(p, other)| {
            self.surface
                .corners(p)
                .map(|corner| self.surface.turned(corner))
                .filter(move |points| points[1] != other && points[2] != other)
                .map(move |points| self.turned(points, c.place))
        })
    }

    fn turned(&self, points: [u32; 3], place: DVec3) -> Turned {
        let before = points.map(|p| self.surface.position[p as usize]);
        Turned {
            points,
            before,
            after: [place, before[1], before[2]],
        }
    }

    /// The link condition (Dey et al. 1999): the ends have no neighbours in
    /// common but the third corners of the edge's triangles, and no triangle
    /// would lie on another.
    fn check_link(&mut self, c: &Candidate) -> Result<(), Refusal> {
        let thirds = self.third_points(c);
        self.marks.clear();
        let mut rest = 0;
        for corner in self.surface.corners(c.kept) {
            let [_, q, r] = self.surface.turned(corner);
            self.marks.set(q);
            self.marks.set(r);
            rest += usize::from(q != c.removed && r != c.removed);
        }
        for corner in self.surface.corners(c.removed) {
            let [_, q, r] = self.surface.turned(corner);
            if q == c.kept || r == c.kept {
                continue;
            }
            rest += 1;
            let shared = |p: u32| self.marks.has(p) && !thirds.contains(&p);
            if shared(q) || shared(r) || self.covers(c.kept, q, r, &thirds) {
                return Err(Refusal::Topology);
            }
        }
        if rest == 0 {
            Err(Refusal::Topology)
        } else {
            Ok(())
        }
    }

    fn third_points(&self, c: &Candidate) -> SmallVec<[u32; 4]> {
        self.surface
            .corners(c.kept)
            .map(|corner| self.surface.turned(corner))
            .filter_map(|[_, q, r]| match (q == c.removed, r == c.removed) {
                (true, _) => Some(r),
                (_, true) => Some(q),
                _ => None,
            })
            .collect()
    }

    /// Whether `kept` already has a triangle with `q` and `r`.
    fn covers(&self, kept: u32, q: u32, r: u32, thirds: &[u32]) -> bool {
        thirds.contains(&q)
            && thirds.contains(&r)
            && self.surface.corners(kept).any(|corner| {
                let [_, x, y] = self.surface.turned(corner);
                (x == q && y == r) || (x == r && y == q)
            })
    }

    fn keeps_its_side(&self, t: &Turned) -> bool {
        let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
        let (before, after) = (normal(t.before), normal(t.after));
        let (size_before, size_after) = (before.length(), after.length());
        let least = self.options.max_normal_turn.cos();
        if after.dot(before) < least * size_before * size_after {
            return false;
        }
        let thin = THIN.min(0.5 * size_before / longest_squared(t.before));
        if size_after <= thin * longest_squared(t.after) {
            return false;
        }
        self.faces_outward(t, before, after, size_before, size_after)
    }

    /// A triangle may oppose the input's normals only if it already did, and
    /// must not grow then.
    fn faces_outward(&self, t: &Turned, before: DVec3, after: DVec3, was: f64, is: f64) -> bool {
        let unit = |p: u32| self.facing[p as usize].normalize_or_zero();
        let input: DVec3 = t.points.map(unit).into_iter().sum();
        let limit = FACING * input.length();
        after.dot(input) >= limit * is
            || (is <= was && after.dot(input) * was >= before.dot(input) * is)
    }

    /// Whether a triangle's UVs would turn over in any set.
    fn turns_uvs(&self, c: &Candidate, mixes: &Mixes) -> bool {
        if self.options.attributes.uv == 0.0 {
            return false;
        }
        self.attributes.uvs.iter().any(|set| {
            c.groups.iter().zip(mixes).any(|(group, mix)| {
                let new = mixed_uv(set, mix);
                self.group_corners(c.kept, c.removed, group)
                    .any(|corner| self.turns_uv(c, corner, set, new))
            })
        })
    }

    fn turns_uv(&self, c: &Candidate, corner: u32, set: &[Vec2], new: DVec2) -> bool {
        let points = self.surface.points[corner as usize / 3];
        if points.contains(&c.kept) && points.contains(&c.removed) {
            return false;
        }
        let [old, a, b] = self
            .surface
            .turned_wedges(corner)
            .map(|w| set[w as usize].as_dvec2());
        let before = (a - old).perp_dot(b - old);
        let after = (a - new).perp_dot(b - new);
        // A chart may have triangles without area; they may stay so.
        before != 0.0 && before.signum() * after <= 0.0
    }
}

fn mixed_uv(set: &[Vec2], mix: &Mix) -> DVec2 {
    let part = |k: usize| set[mix.sources[k] as usize].as_dvec2() * mix.shares[k];
    part(0) + part(1) + part(2)
}

fn longest_squared([a, b, c]: [DVec3; 3]) -> f64 {
    a.distance_squared(b)
        .max(b.distance_squared(c))
        .max(c.distance_squared(a))
}
