//! Performs a collapse that has been checked.

use super::blend::blend;
use super::candidate::Candidate;
use super::check::Mixes;
use super::options::Cost;
use super::state::{State, facet};

impl State<'_> {
    /// Joins the candidate's points at the new place.
    pub fn collapse(&mut self, c: &Candidate, mixes: &Mixes) {
        let (kept, removed) = (c.kept as usize, c.removed as usize);
        for (group, mix) in c.groups.iter().zip(mixes) {
            if let Some(wedge) = group.kept.or(group.removed) {
                blend(&mut self.attributes, wedge, mix);
                self.signal.blend(wedge, mix);
            }
        }
        self.surface.merge(c.kept, c.removed, |wedge| {
            let group = c.groups.iter().find(|g| g.removed == Some(wedge));
            group.and_then(|g| g.kept).unwrap_or(wedge)
        });
        self.surface.position[kept] = c.place;
        let (quadric, facing) = (self.quadric[removed], self.facing[removed]);
        self.quadric[kept] += quadric;
        if self.options.cost == Cost::Averaged {
            self.quadric[kept] = self.quadric[kept] * 0.5;
        }
        self.facing[kept] += facing;
        if !self.weight.is_empty() {
            self.weight[kept] = 0.5 * (self.weight[kept] + self.weight[removed]);
        }
        for corner in self.surface.corners(c.kept) {
            let t = corner as usize / 3;
            self.facets[t] = facet(self.surface.places(t));
        }
    }

    /// Root mean square distance of the candidate's place to the input's
    /// planes that its points stand for, model units.
    pub fn plane_error(&self, c: &Candidate) -> f64 {
        let mut sum = self.quadric[c.kept as usize].relative_to(c.place);
        sum += self.quadric[c.removed as usize].relative_to(c.place);
        sum.mean(glam::DVec3::ZERO).sqrt()
    }
}
