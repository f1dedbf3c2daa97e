//! Positions of vertices in their tier: the masks of Catmull and Clark, creases included.

use super::ring::Ring;
use super::store::{Origin, Store};
use crate::subdiv::crease::{Rule, blend, decayed_around};
use crate::subdiv::options::{CreaseMethod, TriangleRule};
use glam::DVec3;

/// Weight of a triangle's face point under [`TriangleRule::Smooth`].
const SMOOTH_TRIANGLE: f64 = 0.470;

impl Store {
    /// Where a vertex is in a tier; found from the tier above, once.
    pub fn position(&mut self, t: usize, v: u32) -> DVec3 {
        let vertex = self.tiers[t].vertices[v as usize];
        if vertex.known {
            return vertex.position.as_dvec3();
        }
        let found = match vertex.origin {
            // The cage's are known.
            Origin::Cage => vertex.position.as_dvec3(),
            Origin::Face(f) => self.middle(t - 1, f),
            Origin::Edge(e) => self.edge_point(t - 1, e),
            Origin::Vertex(v) => self.vertex_point(t - 1, v),
        };
        let to = &mut self.tiers[t].vertices[v as usize];
        to.position = found.as_vec3();
        to.known = true;
        to.position.as_dvec3()
    }

    /// Position of a corner's vertex.
    pub fn corner_position(&mut self, t: usize, corner: u32) -> DVec3 {
        let v = self.tiers[t].corners[corner as usize];
        self.position(t, v)
    }

    /// The mean of a face's vertices.
    fn middle(&mut self, t: usize, face: u32) -> DVec3 {
        let corners = self.tiers[t].corners_of(face);
        let count = corners.len() as f64;
        let sum: DVec3 = corners.map(|c| self.corner_position(t, c)).sum();
        sum / count
    }

    fn edge_point(&mut self, t: usize, e: u32) -> DVec3 {
        let edge = self.tiers[t].edges[e as usize];
        let ends: DVec3 = edge.ends.map(|v| self.position(t, v)).into_iter().sum();
        if self.linear || edge.open || edge.sharpness >= 1.0 {
            return 0.5 * ends;
        }
        let sides = self.sides(t, e);
        let (mut faces, mut weight) = (DVec3::ZERO, 0.0);
        for &c in &sides {
            let face = self.tiers[t].face_of(c);
            faces += 0.5 * self.middle(t, face);
            weight += self.face_weight(t, face);
        }
        let smooth = faces * weight + ends * (0.5 - 0.5 * weight);
        if edge.sharpness <= 0.0 {
            return smooth;
        }
        let share = self.edge_share(t, e);
        0.5 * ends * share + smooth * (1.0 - share)
    }

    fn face_weight(&self, t: usize, face: u32) -> f64 {
        let heavy = self.triangles == TriangleRule::Smooth;
        match self.tiers[t].corners_of(face).len() {
            3 if heavy => SMOOTH_TRIANGLE,
            _ => 0.25,
        }
    }

    /// Share of the sharp rule in the point of an edge that is sharp for a part of a level.
    fn edge_share(&mut self, t: usize, e: u32) -> f64 {
        let edge = self.tiers[t].edges[e as usize];
        let goes_on = self.creases == CreaseMethod::Chaikin
            && edge
                .ends
                .into_iter()
                .all(|v| self.later_sharpness(t, e, v) > 0.0);
        if goes_on {
            1.0
        } else {
            f64::from(edge.sharpness.min(1.0))
        }
    }

    fn vertex_point(&mut self, t: usize, v: u32) -> DVec3 {
        let vertex = self.tiers[t].vertices[v as usize];
        if self.linear || vertex.odd {
            return self.position(t, v);
        }
        let ring = self.ring(t, vertex.corner);
        let around = self.around(t, &ring);
        let blend = blend(vertex.sharpness, &around, self.creases);
        let before = self.by_rule(t, v, &ring, (blend.before, &around));
        if blend.before == blend.after {
            return before;
        }
        let later = decayed_around(&around, self.creases);
        let after = self.by_rule(t, v, &ring, (blend.after, &later));
        let share = f64::from(blend.share);
        before * share + after * (1.0 - share)
    }

    fn by_rule(&mut self, t: usize, v: u32, ring: &Ring, (rule, sharp): (Rule, &[f32])) -> DVec3 {
        match rule {
            Rule::Smooth => self.smooth(t, v, ring),
            Rule::Crease => self.on_crease(t, v, ring, sharp),
            Rule::Corner => self.position(t, v),
        }
    }

    /// Q/n + 2R/n + S (n - 3)/n with the mean Q of the face points, R of the edges' middles.
    fn smooth(&mut self, t: usize, v: u32, ring: &Ring) -> DVec3 {
        let n = ring.corners.len() as f64;
        let mut around = DVec3::ZERO;
        for &c in &ring.corners {
            let tier = &self.tiers[t];
            let (face, next) = (tier.face_of(c), tier.next(c));
            around += self.middle(t, face) + self.corner_position(t, next);
        }
        around / (n * n) + self.position(t, v) * ((n - 2.0) / n)
    }

    fn on_crease(&mut self, t: usize, v: u32, ring: &Ring, sharp: &[f32]) -> DVec3 {
        let first = sharp.iter().position(|&s| s > 0.0).unwrap_or(0);
        let last = sharp.iter().rposition(|&s| s > 0.0).unwrap_or(0);
        let mut sum = 0.75 * self.position(t, v);
        for i in [first, last] {
            let [a, b] = self.tiers[t].edges[ring.edges[i] as usize].ends;
            sum += 0.125 * self.position(t, if a == v { b } else { a });
        }
        sum
    }
}
