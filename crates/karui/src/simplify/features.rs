//! Edges along which the surface may be simplified but not across: borders,
//! attribute seams, material borders and edges of more than two triangles.

use super::surface::Surface;
use smallvec::SmallVec;

/// What makes an edge a feature.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Feature {
    /// One triangle.
    Border,
    /// Two triangles with different wedges or materials.
    Seam,
    /// More than two triangles.
    Complex,
}

/// How many features meet at a point, which decides how it may move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PointClass {
    /// None: it may vanish into any neighbour.
    Interior,
    /// Two of one kind: it may vanish along them.
    Line(Feature),
    /// Anything else: it stays where it is.
    Corner {
        /// Whether a seam is among them.
        seam: bool,
    },
}

/// The triangles of an edge and how wedges pair up across its ends.
#[derive(Debug, Clone)]
pub(crate) struct EdgeInfo {
    /// Number of triangles.
    pub triangles: usize,
    /// Wedges at the first and the second end, one pair a triangle, each once.
    pub pairs: SmallVec<[(u32, u32); 2]>,
    /// Whether its triangles are of different materials.
    mixed: bool,
}

impl EdgeInfo {
    /// What the edge is, seen from the first (0) or second (1) end. A seam
    /// that ends at a point is a seam for the other end only.
    pub fn feature(&self, end: usize) -> Option<Feature> {
        let wedge = |pair: &(u32, u32)| if end == 0 { pair.0 } else { pair.1 };
        match self.triangles {
            0 => None,
            1 => Some(Feature::Border),
            2 => {
                let split = self.pairs.iter().any(|p| wedge(p) != wedge(&self.pairs[0]));
                (self.mixed || split).then_some(Feature::Seam)
            }
            _ => Some(Feature::Complex),
        }
    }
}

/// Looks at the edge from `a` to `b`; `range_of` gives a triangle's material.
pub(crate) fn edge_info(surface: &Surface, range_of: &[u32], a: u32, b: u32) -> EdgeInfo {
    let mut info = EdgeInfo {
        triangles: 0,
        pairs: SmallVec::new(),
        mixed: false,
    };
    let mut first_range = None;
    for corner in surface.corners(a) {
        let [_, q, r] = surface.turned(corner);
        if q != b && r != b {
            continue;
        }
        let [wa, wq, wr] = surface.turned_wedges(corner);
        let pair = (wa, if q == b { wq } else { wr });
        if !info.pairs.contains(&pair) {
            info.pairs.push(pair);
        }
        let range = range_of[corner as usize / 3];
        info.mixed |= *first_range.get_or_insert(range) != range;
        info.triangles += 1;
    }
    info
}

/// Class of point `p` whose neighbours are `ring`.
pub(crate) fn classify(surface: &Surface, range_of: &[u32], p: u32, ring: &[u32]) -> PointClass {
    let mut found: SmallVec<[Feature; 4]> = SmallVec::new();
    for &n in ring {
        found.extend(edge_info(surface, range_of, p, n).feature(0));
        if found.len() > 2 {
            break;
        }
    }
    match found[..] {
        [] => PointClass::Interior,
        [one, other] if one == other => PointClass::Line(one),
        _ => PointClass::Corner {
            seam: found.contains(&Feature::Seam),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::super::surface::Marks;
    use super::super::wedges::prepare;
    use super::*;
    use crate::mesh::{TriMesh, shapes};

    fn count(mesh: &TriMesh) -> [usize; 5] {
        let surface = prepare(mesh).surface;
        let range_of = vec![0; surface.points.len()];
        let mut marks = Marks::new(surface.position.len());
        let mut ring = Vec::new();
        let mut counts = [0; 5];
        for p in 0..surface.position.len() as u32 {
            surface.neighbours(p, &mut marks, &mut ring);
            counts[match classify(&surface, &range_of, p, &ring) {
                PointClass::Interior => 0,
                PointClass::Line(Feature::Border) => 1,
                PointClass::Line(Feature::Seam) => 2,
                PointClass::Line(Feature::Complex) => 3,
                PointClass::Corner { .. } => 4,
            }] += 1;
        }
        counts
    }

    #[test]
    fn grid_has_a_border_and_an_interior() {
        assert_eq!(count(&shapes::grid(4, 3)), [6, 14, 0, 0, 0]);
    }

    #[test]
    fn seams_of_a_textured_sphere_end_at_its_poles() {
        let [interior, border, seam, complex, corners] = count(&shapes::textured_sphere(8, 12));
        assert!(interior > 0 && seam > 0);
        assert_eq!([border, complex], [0, 0]);
        assert_eq!(corners, 2);
    }

    #[test]
    fn wings_meet_at_a_complex_edge() {
        let counts = count(&shapes::book(3));
        assert_eq!(counts[4], 2, "{counts:?}");
    }
}
