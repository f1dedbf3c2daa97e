//! Whether a collapse shows the input's back.

use super::block::Block;
use super::price::Offer;
use super::repair::Guard;
use crate::geom::closest_point;
use crate::spatial::Normals;
use glam::Vec3;

/// A triangle after a collapse, in model units.
struct After {
    corners: [Vec3; 3],
    center: Vec3,
    /// Unit normal.
    normal: Vec3,
    /// Place in the index of the triangle of the input that it has come from.
    slot: u32,
    /// How far the input is from its centre, at most.
    reach: f32,
}

impl Guard<'_> {
    /// Whether a triangle, in scaled units, that has come from one of the
    /// input's, opposes the input: [`opposes`](Self::opposes), sooner.
    pub fn finds_against(&self, corners: [Vec3; 3], source: u32) -> bool {
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a).normalize_or_zero();
        self.is_against(&self.seen(corners, normal, source))
    }

    /// A triangle in scaled units that has come from one of the input's.
    fn seen(&self, corners: [Vec3; 3], normal: Vec3, source: u32) -> After {
        let corners = corners.map(|p| p / self.scale);
        let center = (corners[0] + corners[1] + corners[2]) / 3.0;
        let slot = self.facings.slot_of(source);
        let [there, ..] = self.index.corners(slot);
        After {
            corners,
            center,
            normal,
            slot,
            reach: center.distance(there.as_vec3()),
        }
    }

    /// Whether a triangle faces away from the input's triangle nearest to its
    /// centre.
    fn is_against(&self, after: &After) -> bool {
        let own = Normals::NONE.with(after.normal);
        // Not from the rounded centre, which may be nearer to another sheet.
        !self.agrees(after.center, after.reach, own)
            && !self.agrees(after.center, self.closer_reach(after), own)
            && self.opposes_from(after.corners, after.slot)
    }

    /// How far the triangle that one has come from is from its centre. Of a
    /// sliver that is far less than the distance to a corner, and to find the
    /// nearest of very many that meet in a point takes long.
    fn closer_reach(&self, after: &After) -> f32 {
        let there = self.index.corners(after.slot);
        let center = after.center.as_dvec3();
        center.distance(closest_point(center, there)) as f32
    }

    fn agrees(&self, center: Vec3, radius: f32, normals: Normals) -> bool {
        let (index, facings) = (self.index, self.facings);
        facings.agree(index, center, radius, normals)
    }
}

impl Block {
    /// Whether one of the triangles that change comes to oppose the input, as
    /// far as the guard looks. Without one, what is unclear does, and a guard
    /// is asked for.
    pub fn turns_against(&mut self, offer: &Offer, guard: Option<Guard<'_>>) -> bool {
        let doubtful = &self.fan.doubtful;
        match guard {
            Some(guard) if guard.all => !self.fan.small && self.fan_against(offer, guard),
            Some(guard) => doubtful
                .iter()
                .any(|&i| self.comes_against(offer, i, guard)),
            None => {
                self.asks |= self.fan.unclear;
                self.fan.unclear
            }
        }
    }

    fn fan_against(&self, offer: &Offer, guard: Guard<'_>) -> bool {
        let place = offer.place / guard.scale;
        let (mut radius, mut normals) = (0.0f32, Normals::NONE);
        for i in 0..self.fan.sides.len() {
            let after = self.triangle_after(offer, i, guard);
            radius = radius.max(after.reach + after.center.distance(place));
            normals = normals.with(after.normal);
        }
        // What is nearest to any of the centres lies within this sphere.
        if guard.agrees(place, radius, normals) {
            return false;
        }
        (0..self.fan.sides.len()).any(|i| self.comes_against(offer, i, guard))
    }

    /// Whether a triangle opposes the input after a collapse, but not before.
    fn comes_against(&self, offer: &Offer, i: usize, guard: Guard<'_>) -> bool {
        guard.is_against(&self.triangle_after(offer, i, guard))
            && !guard.opposes(self.corners(self.fan.sides[i].t))
    }

    fn triangle_after(&self, offer: &Offer, i: usize, guard: Guard<'_>) -> After {
        let (side, root) = (self.fan.sides[i], self.fan.roots[i]);
        let normal = root.truncate() / root.w;
        guard.seen(
            self.after(offer, side),
            normal,
            self.source[side.t as usize],
        )
    }
}
