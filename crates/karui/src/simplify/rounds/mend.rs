//! Cures for a triangle that opposes the input where no collapse of an edge
//! is one: swapping an edge, or moving a corner.

use super::block::{Block, Kind, others, range, root_of};
use super::fan::THIN;
use super::repair::{Guard, Patient};
use super::star::Star;
use crate::simplify::blend::Mix;
use glam::{Vec3, Vec4};
use smallvec::{SmallVec, smallvec};

/// What may be done.
#[derive(Debug, Clone, Copy)]
enum Cure {
    /// The edge between the first two corners of both triangles, of which
    /// these are the other two, is replaced by that between these two.
    Swap {
        triangles: [u32; 2],
        edge: [u32; 2],
        thirds: [u32; 2],
    },
    /// The point goes there.
    Move { point: u32, place: Vec3 },
}

/// Triangles and what they are to be.
type Changes = SmallVec<[(u32, [Vec3; 3]); 12]>;

impl Block {
    /// Does what leaves the fewest triangles around `t` that oppose the input,
    /// if those are fewer than now; returns the triangles that have changed.
    pub(super) fn mend(&mut self, t: u32, patient: &Patient<'_>) -> Vec<u32> {
        let mut best: Option<(i32, Cure)> = None;
        for cure in self.cures(t, patient.guard) {
            let changes = self.changes(cure);
            if !self.keeps_shapes(&changes, patient) {
                continue;
            }
            let gain = self.gain(&changes, patient);
            if gain > best.map_or(0, |b| b.0) && self.is_allowed(cure) {
                best = Some((gain, cure));
            }
        }
        best.map_or_else(Vec::new, |(_, cure)| self.cure(cure))
    }

    fn cures(&self, t: u32, guard: Guard<'_>) -> Vec<Cure> {
        let points = self.triangle[t as usize];
        let mut cures: Vec<Cure> = (0..3)
            .filter_map(|k| self.swap_of(t, points[k], points[(k + 1) % 3]))
            .collect();
        for k in 0..3 {
            let (point, q, r) = (points[k], points[(k + 1) % 3], points[(k + 2) % 3]);
            let moves = self.kind[point as usize] == Kind::Interior && !self.is_hub(point);
            if moves && !self.rules.subset {
                let places = self.places(point, [q, r], guard);
                cures.extend(places.into_iter().map(|place| Cure::Move { point, place }));
            }
        }
        cures
    }

    /// The swap of the edge from `a` to `b` of triangle `t`: none if it is a
    /// feature or if the other diagonal is an edge already.
    fn swap_of(&self, t: u32, a: u32, b: u32) -> Option<Cure> {
        let at_edge = |&&other: &&u32| self.triangle[other as usize].contains(&b);
        let pair: SmallVec<[u32; 4]> = self
            .triangles_at(a)
            .iter()
            .filter(at_edge)
            .copied()
            .collect();
        let [one, two] = pair[..] else {
            return None;
        };
        let other = if one == t { two } else { one };
        // Turned the same way, the other has the edge the other way around.
        let (next, c) = others(self.triangle[t as usize], a);
        let (d, last) = others(self.triangle[other as usize], a);
        let alike = |p: u32| self.aspect(t, p) == self.aspect(other, p);
        let free = next == b && last == b && alike(a) && alike(b) && c != d;
        (free && self.shared_triangles(c, d) == 0).then_some(Cure::Swap {
            triangles: [t, other],
            edge: [a, b],
            thirds: [c, d],
        })
    }

    /// Where a corner might go: over the opposite edge, to the middle of its
    /// neighbours, and to what the input has next to these places.
    fn places(&self, p: u32, [q, r]: [u32; 2], guard: Guard<'_>) -> SmallVec<[Vec3; 12]> {
        let at = |p: u32| self.position[p as usize];
        let here = at(p);
        let triangles = self.triangles_at(p);
        let next = triangles
            .iter()
            .map(|&t| at(others(self.triangle[t as usize], p).0));
        let middle = next.sum::<Vec3>() / triangles.len().max(1) as f32;
        let edge = at(r) - at(q);
        let way = at(q) - here;
        let way = way - edge * (way.dot(edge) / edge.length_squared().max(f32::MIN_POSITIVE));
        let free: [Vec3; 5] = [
            here.lerp(middle, 0.5),
            middle,
            here + way * 1.2,
            here + way * 2.0,
            here,
        ];
        let mut places: SmallVec<[Vec3; 12]> = smallvec![];
        for place in free {
            places.push(guard.nearest(place));
            places.push(place);
        }
        places.retain(|place| place.is_finite() && *place != here);
        places
    }

    /// The triangles that a cure changes, and their new corners.
    fn changes(&self, cure: Cure) -> Changes {
        let at = |p: u32| self.position[p as usize];
        match cure {
            Cure::Swap {
                triangles: [s, t],
                edge: [a, b],
                thirds: [c, d],
            } => smallvec![(s, [c, d, b].map(at)), (t, [d, c, a].map(at))],
            Cure::Move { point, place } => {
                let moved = |p: u32| if p == point { place } else { at(p) };
                let triangles = self.triangles_at(point).iter();
                triangles
                    .map(|&t| (t, self.triangle[t as usize].map(moved)))
                    .collect()
            }
        }
    }

    /// Whether none becomes thin that was not, nor turns far that faces as the
    /// input does.
    fn keeps_shapes(&self, changes: &Changes, patient: &Patient<'_>) -> bool {
        let before = changes.iter().map(|c| shape(self.corners(c.0)));
        let thinnest = before.fold(THIN, f32::min);
        let thin = |corners: [Vec3; 3]| {
            shape(corners)
                .partial_cmp(&thinnest)
                .is_none_or(|o| o.is_le())
        };
        changes.iter().all(|&(t, corners)| {
            let (old, new) = (normal(self.corners(t)), normal(corners));
            let turn = old.dot(new);
            let steady = turn >= self.rules.least_turn * old.length() * new.length();
            !thin(corners) && (steady || patient.opposes(t))
        })
    }

    /// How many triangles fewer would oppose the input.
    fn gain(&self, changes: &Changes, patient: &Patient<'_>) -> i32 {
        let gain = |&(t, corners): &(u32, [Vec3; 3])| {
            i32::from(patient.opposes(t)) - i32::from(patient.would_oppose(self, t, corners))
        };
        changes.iter().map(gain).sum()
    }

    /// Whether the error bound and the UVs allow it.
    fn is_allowed(&self, cure: Cure) -> bool {
        match cure {
            Cure::Swap { .. } => self.paint.is_none() || self.keeps_uvs_swapped(cure),
            Cure::Move { point, place } => {
                let by = place - self.position[point as usize];
                let memory = self.memory[point as usize].moved(by);
                memory.distance() <= self.rules.max_error && self.keeps_uvs_moved(point, place)
            }
        }
    }

    fn keeps_uvs_swapped(&self, cure: Cure) -> bool {
        let (Some(paint), Some(wedges)) = (&self.paint, self.wedges_swapped(cure)) else {
            return true;
        };
        let Cure::Swap { triangles, .. } = cure else {
            return true;
        };
        paint.uvs.iter().all(|&set| {
            let old = triangles.map(|t| paint.uv_area(set, paint.wedge[t as usize]));
            let new = wedges.map(|w| paint.uv_area(set, w));
            old[0] * old[1] > 0.0 && new.iter().all(|area| area * old[0] > 0.0)
        })
    }

    fn keeps_uvs_moved(&self, p: u32, place: Vec3) -> bool {
        let (Some(paint), Some((wedge, mix))) = (&self.paint, self.mix_at(p, place)) else {
            return true;
        };
        paint.uvs.iter().all(|&set| {
            self.triangles_at(p).iter().all(|&t| {
                let wedges = paint.wedge[t as usize];
                let at = |w: u32| match w == wedge {
                    true => paint.mixed_uv(set, &mix),
                    false => paint.uv(set, w),
                };
                let [a, b, c] = wedges.map(at);
                let before = paint.uv_area(set, wedges);
                before == 0.0 || before.signum() * (b - a).perp_dot(c - a) > 0.0
            })
        })
    }

    /// The one wedge of an interior point, and what the surface around it
    /// shows nearest to a place.
    fn mix_at(&self, p: u32, place: Vec3) -> Option<(u32, Mix)> {
        let mix = self.nearest_mix(place, self.triangles_at(p).iter().copied())?;
        let first = *self.triangles_at(p).first()?;
        Some((self.wedge_at(first, p), mix))
    }

    /// Wedges of both triangles after a swap.
    fn wedges_swapped(&self, cure: Cure) -> Option<[[u32; 3]; 2]> {
        let Cure::Swap {
            triangles: [s, t],
            edge: [a, b],
            thirds: [c, d],
        } = cure
        else {
            return None;
        };
        self.paint.as_ref()?;
        let (at_c, at_d) = (self.wedge_at(s, c), self.wedge_at(t, d));
        Some([
            [at_c, at_d, self.wedge_at(s, b)],
            [at_d, at_c, self.wedge_at(s, a)],
        ])
    }

    fn cure(&mut self, cure: Cure) -> Vec<u32> {
        let changes = self.changes(cure);
        let triangles: Vec<u32> = changes.iter().map(|c| c.0).collect();
        self.add_stars(&triangles, -1.0);
        match cure {
            Cure::Move { point, place } => {
                if let Some((wedge, mix)) = self.mix_at(point, place)
                    && let Some(paint) = &mut self.paint
                {
                    paint.blend(wedge, &mix);
                }
                let by = place - self.position[point as usize];
                let memory = self.memory[point as usize].moved(by);
                self.memory[point as usize] = memory;
                self.error = self.error.max(memory.distance());
                self.position[point as usize] = place;
                self.star[point as usize].set_place(place);
            }
            Cure::Swap {
                triangles: [s, t],
                edge: [a, b],
                thirds: [c, d],
            } => {
                let wedges = self.wedges_swapped(cure);
                if let (Some(paint), Some([at_s, at_t])) = (&mut self.paint, wedges) {
                    paint.wedge[s as usize] = at_s;
                    paint.wedge[t as usize] = at_t;
                }
                self.triangle[s as usize] = [c, d, b];
                self.triangle[t as usize] = [d, c, a];
                self.take_from(a, s);
                self.take_from(b, t);
                self.give_to(c, t);
                self.give_to(d, s);
            }
        }
        for &(t, corners) in &changes {
            let cross = normal(corners);
            self.root[t as usize] = root_of(cross, cross.length());
        }
        self.add_stars(&triangles, 1.0);
        triangles
    }

    /// Adds triangles to the stars of their corners, or takes them out.
    fn add_stars(&mut self, triangles: &[u32], sign: f32) {
        for &t in triangles {
            let part = Star::of(self.root[t as usize]);
            for p in self.triangle[t as usize] {
                let star = &mut self.star[p as usize];
                if sign > 0.0 {
                    *star += part;
                } else {
                    *star -= part;
                }
            }
        }
    }

    fn give_to(&mut self, p: u32, t: u32) {
        let span = &mut self.span[p as usize];
        let own = range(*span);
        span.start = self.list.len() as u32;
        span.len += 1;
        self.list.extend_from_within(own);
        self.list.push(t);
    }
}

pub(super) fn normal([a, b, c]: [Vec3; 3]) -> Vec3 {
    (b - a).cross(c - a)
}

/// 1 for a right angle with equal sides, 0 for no area.
pub(super) fn shape([a, b, c]: [Vec3; 3]) -> f32 {
    let sides = Vec4::new(
        a.distance_squared(b),
        b.distance_squared(c),
        c.distance_squared(a),
        f32::MIN_POSITIVE,
    );
    normal([a, b, c]).length() / sides.max_element()
}

#[cfg(test)]
mod tests {
    use super::super::block::Rules;
    use super::super::level::Level;
    use super::super::partition::Cut;
    use super::*;
    use crate::mesh::{TriMesh, shapes};
    use crate::spatial::{Bvh, Facings};

    /// The mesh as a block; every triangle of its own material if asked.
    fn block(mesh: &TriMesh, materials: bool) -> Block {
        let mut level = Level {
            position: mesh.positions.clone().into(),
            scale: 1.0,
            triangle: mesh.triangles.clone().into(),
            ..Level::default()
        };
        if materials {
            level.wedge = mesh.triangles.clone();
            level.range = (0..mesh.triangles.len() as u32).collect();
        }
        let rules = Rules {
            max_error: f32::INFINITY,
            ..Rules::default()
        };
        let mut blocks = Cut::whole(&level).into_blocks(&level, rules);
        assert_eq!(blocks.len(), 1);
        blocks.remove(0)
    }

    fn guard<'a>(index: &'a Bvh, facings: &'a Facings) -> Guard<'a> {
        Guard {
            index,
            facings,
            scale: 1.0,
            all: true,
        }
    }

    fn bad(block: &Block, guard: Guard<'_>) -> Vec<u32> {
        let all = 0..block.triangle.len() as u32;
        all.filter(|&t| guard.opposes(block.corners(t))).collect()
    }

    /// Points of the block by the triangles that its list has for them.
    fn listed(block: &Block) -> Vec<[u32; 3]> {
        let mut found = vec![Vec::new(); block.triangle.len()];
        for p in 0..block.position.len() as u32 {
            for &t in block.triangles_at(p) {
                found[t as usize].push(p);
            }
        }
        found.iter().map(|f| [f[0], f[1], f[2]]).collect()
    }

    /// A dart, cut along the diagonal inside or along that outside.
    fn dart(inside: bool) -> TriMesh {
        let p = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let points = vec![p(0., 1.), p(-1., -1.), p(0., 0.), p(1., -1.)];
        let triangles = match inside {
            true => vec![[0, 1, 2], [0, 2, 3]],
            false => vec![[0, 1, 3], [1, 2, 3]],
        };
        TriMesh::new(points, triangles)
    }

    #[test]
    fn an_edge_outside_is_swapped_for_the_one_inside() {
        let index = Bvh::build(&dart(true)).unwrap();
        let facings = Facings::of(&index);
        let guard = guard(&index, &facings);
        let mut block = block(&dart(false), false);
        assert_eq!(bad(&block, guard), [1]);
        let patient = Patient::new(&block, guard, &[1]);
        assert_eq!(block.mend(1, &patient).len(), 2);
        assert!(bad(&block, guard).is_empty());
        let mut sorted = block.triangle.clone();
        sorted.iter_mut().for_each(|t| t.sort_unstable());
        assert_eq!(listed(&block), sorted);
        let mut of_mesh = sorted;
        for t in &mut of_mesh {
            *t = t.map(|p| block.global[p as usize]);
            t.sort_unstable();
        }
        of_mesh.sort_unstable();
        assert_eq!(of_mesh, [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn an_edge_between_materials_stays() {
        let index = Bvh::build(&dart(true)).unwrap();
        let facings = Facings::of(&index);
        let guard = guard(&index, &facings);
        let mut block = block(&dart(false), true);
        assert_eq!(bad(&block, guard), [1]);
        let patient = Patient::new(&block, guard, &[1]);
        assert!(block.mend(1, &patient).is_empty());
    }

    #[test]
    fn a_point_behind_its_neighbours_comes_back() {
        let mesh = shapes::terrain(6, 6, 1);
        let index = Bvh::build(&mesh).unwrap();
        let facings = Facings::of(&index);
        let guard = guard(&index, &facings);
        let mut moved = mesh.clone();
        // The middle of seven by seven points, over two cells.
        let cell = mesh.bounds().size().x / 6.0;
        moved.positions[24] += Vec3::new(1.7, 0.0, 1.3) * cell;
        let mut block = block(&moved, false);
        let before = bad(&block, guard);
        assert!(!before.is_empty());
        let mut patient = Patient::new(&block, guard, &before);
        for &t in before.iter().chain(&before) {
            if patient.opposes(t) {
                let changed = block.mend(t, &patient);
                patient.look_again(&block, &changed);
            }
        }
        assert!(bad(&block, guard).is_empty());
        assert_eq!(block.alive, mesh.triangles.len());
    }
}
