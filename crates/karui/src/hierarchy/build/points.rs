//! What a build knows of every vertex before the first collapse.
//!
//! A point is a vertex of the topology: all vertices at one position whose
//! triangles form one fan. Vertices of one point differ where a seam runs.

use crate::hierarchy::options::BuildCounts;
use crate::hierarchy::surface::{Half, Moves, NONE, Sides, Surface, next, prev};
use crate::simplify::Quadric;
use glam::{DVec3, Vec3};

/// The input as a build sees it.
pub(super) struct Points {
    /// Faces between points.
    pub surface: Surface,
    /// Vertex of the input at every corner.
    pub vertex: Vec<u32>,
    /// Triangle of the input that every face is.
    pub triangle_of_face: Vec<u32>,
    /// Material range of every face.
    pub range: Vec<u32>,
    pub points: Vec<Point>,
    /// The planes of the faces at every point.
    pub planes: Vec<Quadric>,
    /// Unit normal of every vertex of the input.
    pub normal: Vec<DVec3>,
    /// Planes through the borders and seams at every point, upright on their
    /// faces; empty if there are none at all.
    pub edges: Vec<Quadric>,
    /// By which single precision is fit for the cross products of short edges.
    pub scale: f64,
    pub counts: BuildCounts,
}

/// What is asked of the neighbours of a point that is priced, side by side: most
/// of a build's time goes by waiting for it.
#[derive(Debug, Clone, Copy)]
#[repr(align(32))]
pub(super) struct Point {
    pub place: Vec3,
    /// A corner there; [`NONE`] if the point has gone or never had one.
    pub corner: u32,
    /// Number of faces.
    pub degree: u32,
    /// Factor to the cost.
    pub weight: f32,
    pub border: bool,
    /// Whether a border or seam ends there or runs through.
    pub on_edge: bool,
    pub locked: bool,
}

impl Point {
    pub const NEW: Self = Self {
        place: Vec3::ZERO,
        corner: NONE,
        degree: 0,
        weight: 1.0,
        border: false,
        on_edge: false,
        locked: false,
    };

    /// In double precision.
    #[inline]
    pub fn position(&self) -> DVec3 {
        self.place.as_dvec3()
    }
}

impl Points {
    /// The point at a corner.
    #[inline]
    pub fn at(&self, corner: u32) -> &Point {
        &self.points[self.surface.start(corner) as usize]
    }

    /// Whether neither a border nor a seam of vertices or materials runs along
    /// a half-edge.
    pub fn is_inner(&self, h: u32) -> bool {
        let other = self.surface.opposite(h);
        let vertex = |h: u32| self.vertex[h as usize];
        other != NONE
            && vertex(h) == vertex(next(other))
            && vertex(next(h)) == vertex(other)
            && self.range[h as usize / 3] == self.range[other as usize / 3]
    }

    /// The corners at a point in order, and whether they go all around. Faces
    /// that are hidden are not among them if `first` is in one that is not.
    pub fn around(&self, first: u32, corners: &mut Vec<u32>) -> bool {
        let opposite = |h: u32| self.surface.opposite(h);
        let mut start = first;
        if self.at(first).border {
            // To where the fan begins.
            while opposite(start) != NONE {
                start = next(opposite(start));
            }
        }
        corners.clear();
        let mut at = start;
        loop {
            corners.push(at);
            at = opposite(prev(at));
            if at == NONE {
                return false;
            }
            if at == start {
                return true;
            }
        }
    }
}

impl Points {
    /// Collapses `point` and returns the point that stays.
    pub fn collapse(&mut self, point: u32, half_edge: u32) -> u32 {
        let sides = self.surface.sides(half_edge);
        let kept = self.surface.moves(sides).left[1];
        let moves = Moves::new(sides, |h| self.vertex[h as usize]);
        self.move_anchors(sides, kept);
        let (vertex, anchor) = (&mut self.vertex, &mut self.points[kept as usize].corner);
        self.surface.collapse(half_edge, |c, _| {
            let v = &mut vertex[c as usize];
            *v = moves.kept(*v);
            *anchor = c;
        });
        let hidden = sides.faces().count() as u32;
        let (p, k) = (point as usize, kept as usize);
        self.points[p].corner = NONE;
        self.points[k].degree = self.points[k].degree + self.points[p].degree - 2 * hidden;
        let planes = self.planes[p];
        self.planes[k] += planes;
        if let Some(&edges) = self.edges.get(p) {
            self.edges[k] += edges;
        }
        kept
    }

    /// Gives the points of the faces to be hidden corners elsewhere.
    fn move_anchors(&mut self, sides: Sides, kept: u32) {
        for (h, is_left) in [(sides.left, true), (sides.right, false)] {
            if h == NONE {
                continue;
            }
            let apex = self.surface.start(prev(h)) as usize;
            let [after, before] = [next(h), prev(h)].map(|k| self.surface.opposite(k));
            // Left: `after` runs from the apex to the kept point. Right: it runs
            // from the apex to the removed one, `before` from kept to apex.
            let at_apex = match (after, before) {
                (NONE, before) => next(before),
                (after, _) => after,
            };
            self.points[apex].degree -= 1;
            self.points[apex].corner = at_apex;
            let at_kept = if is_left { after } else { before };
            if at_kept != NONE {
                let corner = if is_left { next(at_kept) } else { at_kept };
                self.points[kept as usize].corner = corner;
            }
        }
    }

    /// The faces with the vertices of the input, before any collapse.
    pub fn drawn(&self) -> Surface {
        let halves = self.surface.halves.iter().zip(&self.vertex);
        let drawn = halves.map(|(half, &start)| Half { start, ..*half });
        Surface {
            halves: drawn.collect(),
        }
    }
}
