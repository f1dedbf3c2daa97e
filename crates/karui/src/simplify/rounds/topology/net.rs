//! Which triangles meet at which edges.

/// The mate of a border's half-edge.
pub(super) const BORDER: u32 = u32::MAX;
/// The mate of a half-edge of more than two triangles, or of two that are not
/// oriented alike.
pub(super) const ODD: u32 = u32::MAX - 1;

/// The end of a chain.
const NONE: u32 = u32::MAX;

/// Triangles and, of every half-edge (three times the triangle, and the corner
/// where it begins), the one that runs the other way.
pub(super) struct Net {
    pub triangle: Vec<[u32; 3]>,
    pub mate: Vec<u32>,
}

impl Net {
    pub fn of(triangle: &[[u32; 3]]) -> Self {
        let points = triangle
            .iter()
            .flatten()
            .max()
            .map_or(0, |&p| p as usize + 1);
        // The edges from a point to those of higher numbers are a chain, each by
        // its first half-edge.
        let mut first = vec![NONE; points];
        let mut after = vec![NONE; 3 * triangle.len()];
        let mut mate = vec![BORDER; 3 * triangle.len()];
        for h in 0..mate.len() as u32 {
            let [p, q] = ends(triangle, h);
            let low = p.min(q) as usize;
            let mut g = first[low];
            while g != NONE && !ends(triangle, g).contains(&p.max(q)) {
                g = after[g as usize];
            }
            if g == NONE {
                after[h as usize] = std::mem::replace(&mut first[low], h);
            } else if mate[g as usize] == BORDER && ends(triangle, g)[0] == q {
                mate[h as usize] = g;
                mate[g as usize] = h;
            } else {
                let known = mate[g as usize];
                for odd in [h, g].into_iter().chain((known < ODD).then_some(known)) {
                    mate[odd as usize] = ODD;
                }
            }
        }
        Self {
            triangle: triangle.to_vec(),
            mate,
        }
    }

    /// Where a half-edge begins and ends.
    pub fn ends(&self, h: u32) -> [u32; 2] {
        ends(&self.triangle, h)
    }

    /// The mate of a half-edge that has one.
    pub fn mate(&self, h: u32) -> Option<u32> {
        let mate = self.mate[h as usize];
        (mate != BORDER && mate != ODD).then_some(mate)
    }

    /// Whether one of the triangles of an edge has this point besides.
    pub fn is_side(&self, h: u32, p: u32) -> bool {
        let third = |h: u32| self.ends(previous(h))[0];
        third(h) == p || self.mate(h).is_some_and(|mate| third(mate) == p)
    }
}

fn ends(triangle: &[[u32; 3]], h: u32) -> [u32; 2] {
    let points = triangle[h as usize / 3];
    [points[h as usize % 3], points[next(h) as usize % 3]]
}

/// The half-edge after this one in its triangle.
pub(super) fn next(h: u32) -> u32 {
    h - h % 3 + (h + 1) % 3
}

/// The half-edge before this one in its triangle.
pub(super) fn previous(h: u32) -> u32 {
    h - h % 3 + (h + 2) % 3
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mates_run_the_other_way() {
        let net = Net::of(&[[0, 1, 2], [2, 1, 3]]);
        assert_eq!(net.mate, [BORDER, 3, BORDER, 1, BORDER, BORDER]);
    }

    #[test]
    fn edges_of_three_triangles_or_not_oriented_alike_are_odd() {
        let fan = Net::of(&[[0, 1, 2], [1, 0, 3], [0, 1, 4], [1, 0, 5]]);
        for h in 0..12 {
            let odd = h % 3 == 0;
            assert_eq!(fan.mate[h], if odd { ODD } else { BORDER }, "{h}");
        }
        let twisted = Net::of(&[[0, 1, 2], [0, 1, 3]]);
        assert_eq!(twisted.mate[0], ODD);
        assert_eq!(twisted.mate[3], ODD);
    }
}
