//! The surface while it is being simplified: triangles over points, and for
//! every point the list of its corners.
//!
//! A *point* is a place of the surface, a *wedge* one set of attributes there
//! (H. Hoppe: Efficient Implementation of Progressive Meshes, 1998). Points on
//! a UV seam have several wedges. Points have one fan of triangles each.

use glam::DVec3;

/// End of a corner list.
const END: u32 = u32::MAX;
/// First corner of a triangle that is gone.
const DEAD: u32 = u32::MAX;

/// Triangles over points and wedges with point-to-corner lists.
#[derive(Debug, Clone)]
pub(crate) struct Surface {
    /// Place of every point.
    pub position: Vec<DVec3>,
    /// Points of every triangle.
    pub points: Vec<[u32; 3]>,
    /// Wedges (vertices of the source mesh) of every triangle.
    pub wedges: Vec<[u32; 3]>,
    /// Triangles that are still there.
    pub alive: usize,
    first: Vec<u32>,
    next: Vec<u32>,
}

impl Surface {
    /// Links the corners of all triangles. A triangle that names a point twice
    /// is left out.
    pub fn new(position: Vec<DVec3>, mut points: Vec<[u32; 3]>, wedges: Vec<[u32; 3]>) -> Self {
        let mut first = vec![END; position.len()];
        let mut next = vec![END; points.len() * 3];
        let mut alive = 0;
        for t in (0..points.len()).rev() {
            let [a, b, c] = points[t];
            if a == b || b == c || c == a {
                points[t][0] = DEAD;
                continue;
            }
            alive += 1;
            for k in (0..3).rev() {
                let p = points[t][k] as usize;
                next[3 * t + k] = first[p];
                first[p] = (3 * t + k) as u32;
            }
        }
        Self {
            position,
            points,
            wedges,
            alive,
            first,
            next,
        }
    }

    /// Whether triangle `t` is still there.
    pub fn is_alive(&self, t: usize) -> bool {
        self.points[t][0] != DEAD
    }

    /// The corners at point `p`; corner `c` belongs to triangle `c / 3`.
    pub fn corners(&self, p: u32) -> impl Iterator<Item = u32> + '_ {
        let mut at = self.first[p as usize];
        std::iter::from_fn(move || {
            let corner = at;
            if corner == END {
                return None;
            }
            at = self.next[corner as usize];
            Some(corner)
        })
    }

    /// The triangle of a corner, turned so that the corner comes first.
    pub fn turned(&self, corner: u32) -> [u32; 3] {
        turn(self.points[corner as usize / 3], corner)
    }

    /// Wedges of the triangle of a corner, turned like [`Surface::turned`].
    pub fn turned_wedges(&self, corner: u32) -> [u32; 3] {
        turn(self.wedges[corner as usize / 3], corner)
    }

    /// Places of the three points of triangle `t`.
    pub fn places(&self, t: usize) -> [DVec3; 3] {
        self.points[t].map(|p| self.position[p as usize])
    }

    /// Joins `removed` into `kept`: triangles with both vanish, corners at
    /// `removed` move over and take the wedge that `wedge_of` gives.
    pub fn merge(&mut self, kept: u32, removed: u32, wedge_of: impl Fn(u32) -> u32) {
        let mut corner = self.first[removed as usize];
        self.first[removed as usize] = END;
        let mut tail = END;
        let mut moved = END;
        let mut opposite = smallvec::SmallVec::<[u32; 4]>::new();
        while corner != END {
            let following = self.next[corner as usize];
            let (t, k) = (corner as usize / 3, corner as usize % 3);
            if self.points[t].contains(&kept) {
                opposite.extend(
                    self.points[t]
                        .into_iter()
                        .filter(|&p| p != kept && p != removed),
                );
                self.points[t][0] = DEAD;
                self.alive -= 1;
            } else {
                self.points[t][k] = kept;
                self.wedges[t][k] = wedge_of(self.wedges[t][k]);
                if tail == END {
                    tail = corner;
                }
                self.next[corner as usize] = moved;
                moved = corner;
            }
            corner = following;
        }
        self.unlink_dead(kept);
        for p in opposite {
            self.unlink_dead(p);
        }
        if moved != END {
            self.next[tail as usize] = self.first[kept as usize];
            self.first[kept as usize] = moved;
        }
    }

    fn unlink_dead(&mut self, p: u32) {
        let mut previous = END;
        let mut corner = self.first[p as usize];
        while corner != END {
            let following = self.next[corner as usize];
            if self.is_alive(corner as usize / 3) {
                previous = corner;
            } else if previous == END {
                self.first[p as usize] = following;
            } else {
                self.next[previous as usize] = following;
            }
            corner = following;
        }
    }

    /// Points that share a triangle with `p`, each once, in corner order.
    pub fn neighbours(&self, p: u32, marks: &mut Marks, found: &mut Vec<u32>) {
        found.clear();
        marks.clear();
        marks.set(p);
        for corner in self.corners(p) {
            let [_, q, r] = self.turned(corner);
            found.extend([q, r].into_iter().filter(|&n| marks.set(n)));
        }
    }
}

/// A set of points that is emptied in constant time.
#[derive(Debug, Clone)]
pub(crate) struct Marks {
    stamp: Vec<u32>,
    now: u32,
}

impl Marks {
    /// An empty set over `points` points.
    pub fn new(points: usize) -> Self {
        Self {
            stamp: vec![0; points],
            now: 1,
        }
    }

    /// Empties the set.
    pub fn clear(&mut self) {
        if self.now == u32::MAX {
            self.stamp.fill(0);
            self.now = 0;
        }
        self.now += 1;
    }

    /// Adds `p`; whether it was new.
    pub fn set(&mut self, p: u32) -> bool {
        std::mem::replace(&mut self.stamp[p as usize], self.now) != self.now
    }

    /// Whether `p` is in the set.
    pub fn has(&self, p: u32) -> bool {
        self.stamp[p as usize] == self.now
    }
}

fn turn(triangle: [u32; 3], corner: u32) -> [u32; 3] {
    let [a, b, c] = triangle;
    match corner % 3 {
        0 => [a, b, c],
        1 => [b, c, a],
        _ => [c, a, b],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of four triangles around point 4.
    fn pyramid() -> Surface {
        let points = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        Surface::new(vec![DVec3::ZERO; 5], points.clone(), points)
    }

    #[test]
    fn merge_removes_the_edge_s_triangles_and_moves_the_rest() {
        let mut surface = pyramid();
        surface.merge(0, 4, |w| if w == 4 { 0 } else { w });
        assert_eq!(surface.alive, 2);
        let left: Vec<_> = (0..4).filter(|&t| surface.is_alive(t)).collect();
        assert_eq!(left, [1, 2]);
        assert_eq!(surface.points[1], [1, 2, 0]);
        assert_eq!(surface.wedges[1], [1, 2, 0]);
        let mut ring = Vec::new();
        surface.neighbours(0, &mut Marks::new(5), &mut ring);
        ring.sort_unstable();
        assert_eq!(ring, [1, 2, 3]);
        assert_eq!(surface.corners(4).count(), 0);
        assert_eq!(surface.corners(1).count(), 1);
    }

    #[test]
    fn triangle_with_a_repeated_point_is_left_out() {
        let surface = Surface::new(vec![DVec3::ZERO; 2], vec![[0, 1, 1]], vec![[0, 1, 1]]);
        assert_eq!(surface.alive, 0);
        assert_eq!(surface.corners(1).count(), 0);
    }
}
